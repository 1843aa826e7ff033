#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "site_node/capture/raw_file.hpp"
#include "site_node/record/file_calls.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace atrium::record {

/// Writes the frames.raw of one camera (site_node/capture/raw_file.hpp). After a failure the file
/// ends with its last whole picture. Not thread-safe.
class CameraFile {
public:
    /// Creates a new file. Errors name it.
    static Expected<CameraFile> create(const std::filesystem::path& file,
                                       const capture::RawLayout& layout,
                                       capture::RawCodec codec,
                                       const FileCalls& calls);

    const capture::RawLayout& layout() const { return layout_; }

    /// Appends packed bytes of the layout. Numbers must grow. Returns the bytes written.
    Expected<std::uint64_t> append(std::uint64_t number,
                                   Timestamp capture_time,
                                   std::span<const std::uint8_t> packed);

private:
    CameraFile(std::filesystem::path file, Descriptor descriptor, const FileCalls& calls);
    Expected<void> write(std::span<const std::uint8_t> head, std::span<const std::uint8_t> body);
    void flush();

    std::filesystem::path file_;
    Descriptor descriptor_;
    FileCalls calls_;
    capture::RawLayout layout_;
    std::optional<capture::SheetEncoder> encoder_;  // empty: pictures are stored as they are
    std::vector<std::uint8_t> sheet_, coded_;
    std::uint64_t end_ = 0;      // of the whole pictures
    std::uint64_t flushed_ = 0;  // what the disk was asked to write
};

}  // namespace atrium::record
