#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::capture {

struct PictureSize {
    int width = 0;
    int height = 0;
};

/// Reads pictures in every form that a recording may use: one image, a numbered sequence, a video.
class PictureFile {
public:
    PictureFile();
    PictureFile(PictureFile&&) noexcept;
    PictureFile& operator=(PictureFile&&) noexcept;
    ~PictureFile();

    /// Looks for `stem` in `folder`: `stem.avi|mp4|mkv`, `stem/%06d.png|jpg` or `stem.png|jpg`, in
    /// this order. Error kNotFound lists the names tried.
    static Expected<PictureFile> find(const std::filesystem::path& folder, const std::string& stem);

    /// One picture, number 0, whatever its name.
    static PictureFile of(const std::filesystem::path& picture);

    const std::filesystem::path& path() const;
    bool is_video() const;
    /// Highest number + 1 of a sequence; for a video the number in its header, or the number of
    /// whole pictures if the file is truncated.
    std::size_t num_pictures() const;

    /// Right after `find`: that a video is truncated, with the file, both numbers and the cure, or
    /// which pictures its camera lost; else empty.
    std::string what_is_missing() const;
    /// Whether the camera lost this picture of a video (lost_pictures.hpp). `read` does not find
    /// it.
    bool has_lost(std::size_t index) const;

    /// Size of the first picture, as its file says; nullopt if it cannot be read.
    std::optional<PictureSize> size();

    /// Errors: kNotFound if this number is missing, kInvalidData if it cannot be decoded, or if a
    /// video ends early because pictures inside it cannot be decoded.
    Expected<void> read(std::size_t index, image::YuvImage& out);

    /// Size in its file of the picture that was read last. `read` loses an odd last row or column.
    PictureSize size_read() const;

    /// Lowest number of a sequence; 0 for a video.
    std::size_t first_picture() const;

    /// Like `read`, for masks (mask_values.hpp).
    Expected<void> read_mask(std::size_t index, image::Mask& out);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::capture
