#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "site_node/capture/metaframe.hpp"
#include "site_node/capture/picture_file.hpp"
#include "site_node/capture/raw_file.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace atrium::capture {

/// The file of a recorded camera's pictures as it delivered them.
inline constexpr const char* kRawFileName = "frames.raw";
/// What a recorder says of its recording, in the folder of the recording.
inline constexpr const char* kSummaryName = "recording.toml";
/// Folder of the rooms that the site had learned, in the folder of the recording.
inline constexpr const char* kRoomsName = "backgrounds";

/// Whether pictures of this size are those of the camera: they lose an odd last row or column.
bool fits(const PictureSize& size, const geometry::PinholeCamera& expected);

/// The recorded pictures of one camera, and optional masks beside them.
class RecordingTrack {
public:
    /// `folder`: of the camera. A camera that delivered nothing while a site recorded has no
    /// pictures. Errors name the file.
    static Expected<std::unique_ptr<RecordingTrack>> open(const std::filesystem::path& folder,
                                                          const geometry::PinholeCamera& expected,
                                                          bool ignore_masks);

    std::size_t num_frames() const;
    /// Which pictures are missing, and why; else empty.
    std::string what_is_missing() const;
    /// True if a missing picture is nothing to report one by one.
    bool is_video() const { return is_raw_ || pictures_.is_video(); }
    bool has_masks() const { return masks_.has_value(); }
    bool has_inverted_masks() const { return has_inverted_masks_; }
    /// Recorded with the picture; nullopt: the pictures have no times.
    std::optional<Timestamp> capture_time(std::size_t index) const;

    /// Its time is not set.
    Expected<CameraFrame> read(std::size_t index);

private:
    Expected<image::RawImage> read_picture(std::size_t index);
    Expected<void> open_raw(const std::filesystem::path& folder);
    Expected<void> open_masks(const std::filesystem::path& folder);
    Expected<void> check_mask(const image::Mask& mask, std::size_t index) const;

    geometry::PinholeCamera expected_;
    PictureFile pictures_;
    bool is_raw_ = false;
    std::optional<RawFile> raw_;  // instead of `pictures_`; empty: no picture was recorded
    std::optional<PictureFile> masks_;
    bool has_inverted_masks_ = false;
};

}  // namespace atrium::capture
