#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"

#include <filesystem>

namespace atrium::demo {

/// Keeps the results of the last demo that succeeded in `output` until another one succeeds. A demo
/// writes to `output`/running. At its end this becomes the results, or `output`/failed.
class ResultFolder {
public:
    /// Fails with kUnavailable if the folder cannot be written, its disk is full, or another demo
    /// uses it.
    static Expected<ResultFolder> create(const std::filesystem::path& output);

    std::filesystem::path running() const { return output_ / "running"; }
    std::filesystem::path failed() const { return output_ / "failed"; }

    /// Moves the files to `output`.
    Expected<void> keep() const;
    /// Moves them to `failed`, in place of those of an earlier demo. Does nothing after `keep`.
    void set_aside() const;

private:
    ResultFolder(std::filesystem::path output, Descriptor lock)
        : output_(std::move(output)), lock_(std::move(lock)) {}
    std::filesystem::path output_;
    Descriptor lock_;  // held on a file in `output`; the kernel releases it even after a kill
};

}  // namespace atrium::demo
