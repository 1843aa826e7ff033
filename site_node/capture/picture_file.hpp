#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace atrium::capture {

/// Pictures on disk in any of the forms that a recording may have them: one image, a numbered
/// sequence, a video.
class PictureFile {
public:
    PictureFile();
    PictureFile(PictureFile&&) noexcept;
    PictureFile& operator=(PictureFile&&) noexcept;
    ~PictureFile();

    /// Looks for `stem` in `folder`: `stem.avi|mp4|mkv`, `stem/%06d.png|jpg` or `stem.png|jpg`, in
    /// that order. Error kNotFound names what was looked for.
    static Expected<PictureFile> find(const std::filesystem::path& folder, const std::string& stem);

    const std::filesystem::path& path() const;
    bool is_video() const;
    std::size_t num_pictures()
        const;  // highest number + 1 of a sequence; a video's as its header says

    /// Errors: kNotFound where this number is missing, kInvalidData where it cannot be decoded.
    Expected<void> read(std::size_t index, image::YuvImage& out);

    /// The same for 8-bit masks: anything above 127 is foreground.
    Expected<void> read_mask(std::size_t index, image::Mask& out);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::capture
