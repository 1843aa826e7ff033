#include "site_node/capture/recording_track.hpp"

#include "site_node/capture/mask_file.hpp"
#include "site_node/capture/mask_values.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> wrong_size(const fs::path& file,
                                 const std::string& what_has,
                                 const PictureSize& size,
                                 const geometry::PinholeCamera& expected) {
    return make_error(ErrorKind::kInvalidData,
                      fmt::format("{}: {} {}x{} px, but rig.toml says {}x{}: correct width and "
                                  "height, and scale fx, fy, cx and cy if the calibration is of "
                                  "the other size",
                                  file.string(),
                                  what_has,
                                  size.width,
                                  size.height,
                                  expected.width,
                                  expected.height));
}

std::string missing_in(const RawFile& raw) {
    const std::size_t num_missing = raw.num_pictures() - raw.num_stored();
    std::string text = raw.damage();
    if (num_missing > 0) {
        text += fmt::format(
            "{}{} of {} pictures are not in the recording (dropped while it was "
            "written, or lost by the camera: recording.toml has the counts)",
            text.empty() ? "" : "; ",
            num_missing,
            raw.num_pictures());
    }
    return text;
}

}  // namespace

bool fits(const PictureSize& size, const geometry::PinholeCamera& expected) {
    return (size.width & ~1) == (expected.width & ~1) &&
           (size.height & ~1) == (expected.height & ~1);
}

Expected<std::unique_ptr<RecordingTrack>> RecordingTrack::open(
    const fs::path& folder, const geometry::PinholeCamera& expected, bool ignore_masks) {
    auto track = std::make_unique<RecordingTrack>();
    track->expected_ = expected;
    if (auto opened = track->open_raw(folder); !opened) return tl::unexpected(opened.error());
    if (!track->is_raw_) {
        auto pictures = PictureFile::find(folder, "frames");
        if (!pictures) return tl::unexpected(pictures.error());
        track->pictures_ = std::move(*pictures);
        if (const auto size = track->pictures_.size(); size && !fits(*size, expected))
            return wrong_size(track->pictures_.path(), "the pictures have", *size, expected);
    }
    if (!ignore_masks && fs::is_directory(folder / "silhouettes")) {
        if (auto opened = track->open_masks(folder); !opened) return tl::unexpected(opened.error());
    }
    return track;
}

Expected<void> RecordingTrack::open_raw(const fs::path& folder) {
    const fs::path file = folder / kRawFileName;
    std::error_code failure;
    if (!fs::exists(file, failure)) {
        is_raw_ = fs::is_directory(folder, failure) && fs::is_empty(folder, failure) &&
                  fs::exists(folder.parent_path() / kSummaryName, failure);
        return {};
    }
    auto raw = RawFile::open(file);
    if (!raw) return tl::unexpected(raw.error());
    const PictureSize size{raw->head().layout.width, raw->head().layout.height};
    if (!fits(size, expected_)) return wrong_size(file, "the pictures have", size, expected_);
    is_raw_ = true;
    raw_ = std::move(*raw);
    return {};
}

Expected<void> RecordingTrack::open_masks(const fs::path& folder) {
    auto masks = PictureFile::find(folder, "silhouettes");
    if (!masks) return tl::unexpected(masks.error());
    masks_ = std::move(*masks);
    image::Mask mask;
    const std::size_t first = masks_->first_picture();
    if (auto read = masks_->read_mask(first, mask); !read) return read;
    if (auto fits = check_mask(mask, first); !fits) return fits;
    has_inverted_masks_ = looks_inverted(mask);
    return {};
}

std::size_t RecordingTrack::num_frames() const {
    if (is_raw_) return raw_ ? raw_->num_pictures() : 0;
    return pictures_.num_pictures();
}

std::string RecordingTrack::what_is_missing() const {
    if (is_raw_) {
        if (!raw_) return "delivered no picture while the recording was made";
        const std::string reason = missing_in(*raw_);
        return reason.empty() ? reason : raw_->path().string() + ": " + reason;
    }
    const std::string reason = pictures_.what_is_missing();
    return reason.empty() && masks_ ? masks_->what_is_missing() : reason;
}

std::optional<Timestamp> RecordingTrack::capture_time(std::size_t index) const {
    return raw_ ? raw_->capture_time(index) : std::nullopt;
}

Expected<image::RawImage> RecordingTrack::read_picture(std::size_t index) {
    if (is_raw_) {
        if (raw_) return raw_->read(index);
        return make_error(ErrorKind::kNotFound, fmt::format("there is no picture {}", index));
    }
    auto picture = std::make_shared<image::YuvImage>();
    if (auto read = pictures_.read(index, *picture); !read) return tl::unexpected(read.error());
    const PictureSize size = pictures_.size_read();
    if (!fits(size, expected_))
        return wrong_size(pictures_.path(), fmt::format("frame {} has", index), size, expected_);
    return image::RawImage(std::move(picture));
}

Expected<CameraFrame> RecordingTrack::read(std::size_t index) {
    CameraFrame frame;
    auto picture = read_picture(index);
    if (!picture) return tl::unexpected(picture.error());
    frame.image = std::move(*picture);
    if (masks_) {
        auto mask = std::make_shared<image::Mask>();
        if (auto read = masks_->read_mask(index, *mask); !read) return tl::unexpected(read.error());
        if (auto fits = check_mask(*mask, index); !fits) return tl::unexpected(fits.error());
        frame.silhouette = std::move(mask);
    }
    return frame;
}

Expected<void> RecordingTrack::check_mask(const image::Mask& mask, std::size_t index) const {
    if (mask.width == (expected_.width & ~1) && mask.height == (expected_.height & ~1)) return {};
    return make_error(ErrorKind::kInvalidData,
                      fmt::format("{}: mask {} has {}x{} px, but the pictures of this camera have "
                                  "{}x{} (rig.toml): scale the masks without smoothing, for "
                                  "example with mogrify -filter point -resize '{}x{}!' {}/*.png",
                                  masks_->path().string(),
                                  index,
                                  mask.width,
                                  mask.height,
                                  expected_.width,
                                  expected_.height,
                                  expected_.width,
                                  expected_.height,
                                  masks_->path().string()));
}

}  // namespace atrium::capture
