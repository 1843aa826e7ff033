#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace atrium::exporting {

/// A file that has its name only when it is whole: it is written as NAME.part and renamed. Without
/// `commit` it disappears.
class OutputFile {
public:
    /// kUnavailable as `cannot_write`. Replaces a former file of that name when it is committed.
    static Expected<OutputFile> create(const std::filesystem::path& file);
    OutputFile(OutputFile&& other) noexcept;
    OutputFile& operator=(OutputFile&& other) noexcept;
    ~OutputFile();

    Expected<void> write(std::span<const std::uint8_t> bytes);
    Expected<void> write(std::string_view text);
    Expected<void> commit();
    std::uint64_t num_bytes() const { return num_bytes_; }

private:
    OutputFile(std::filesystem::path file, Descriptor descriptor);
    void discard();

    std::filesystem::path file_;
    Descriptor descriptor_;
    std::uint64_t num_bytes_ = 0;
};

/// Writes and commits a whole file.
Expected<void> write_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

}  // namespace atrium::exporting
