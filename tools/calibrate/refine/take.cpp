#include "tools/calibrate/refine/take.hpp"

#include "site_node/capture/recording_source.hpp"
#include "site_node/rig_check/agreement.hpp"
#include "site_node/silhouette/undistort_polygon.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"
#include "tools/calibrate/refine/take_polygons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace atrium::calibrate {
namespace {

using Contours = std::vector<std::vector<Eigen::Vector2d>>;

class TakeReader {
public:
    TakeReader(capture::RecordingSource& source,
               std::span<const geometry::CalibratedCamera> rig,
               const TakeOptions& options)
        : source_(source), rig_(rig), options_(options) {}

    Expected<Take> read() {
        if (auto found = find_cameras(); !found) return tl::unexpected(found.error());
        if (auto made = make_stages(); !made) return tl::unexpected(made.error());
        Take take;
        take.num_instants = source_.num_frames();
        take.rate_hz = source_.rig().rate_hz;
        // the instant before each is read, too
        const std::size_t first = take.num_instants > 1 ? 1 : 0;
        const std::size_t num_choices = take.num_instants - first;
        const std::size_t count = std::min(options_.most_sights, num_choices);
        std::size_t last_read = take.num_instants;  // none
        std::vector<Contours> last;
        for (std::size_t i = 0; i < count; ++i) {
            if (options_.report)
                options_.report(fmt::format("reading instant {} of {}", i + 1, count));
            const std::size_t instant = first + i * num_choices / count;
            coherence::Sight sight;
            if (instant > 0) {
                if (last_read != instant - 1) last = see(instant - 1);
                sight.before = hulls_of(last);
            }
            last = see(instant);
            last_read = instant;
            sight.now = hulls_of(last);
            take.sights.push_back(std::move(sight));
            auto& views = take.views.emplace_back();
            for (std::size_t c = 0; c < rig_.size(); ++c) {
                if (has_picture_[c] == 0) continue;
                views.push_back(
                    {rig_[c].name, {rig_[c].intrinsics, rig_[c].camera_from_site, last[c], {}}});
            }
        }
        if (!failure_.message.empty() && !has_any_) return tl::unexpected(failure_);
        return take;
    }

private:
    Expected<void> find_cameras() {
        const auto& recorded = source_.rig().cameras;
        for (const geometry::CalibratedCamera& camera : rig_) {
            const auto found =
                std::ranges::find(recorded, camera.name, &geometry::CalibratedCamera::name);
            if (found == recorded.end())
                return make_error(
                    ErrorKind::kConfiguration,
                    fmt::format("the recording has no camera '{}', which the rig names: give a "
                                "recording of these cameras, with the same names",
                                camera.name));
            if (found->intrinsics.width != camera.intrinsics.width ||
                found->intrinsics.height != camera.intrinsics.height)
                return make_error(
                    ErrorKind::kConfiguration,
                    fmt::format(
                        "camera '{}' has pictures of {}x{} px in the recording, of {}x{} px "
                        "in the rig: record at the size of the calibration",
                        camera.name,
                        found->intrinsics.width,
                        found->intrinsics.height,
                        camera.intrinsics.width,
                        camera.intrinsics.height));
            recorded_.push_back(static_cast<std::size_t>(found - recorded.begin()));
        }
        if (source_.num_frames() == 0)
            return make_error(ErrorKind::kInvalidData, "the recording has no pictures");
        return {};
    }

    Expected<void> make_stages() {
        const site_node::SilhouetteStageOptions options;
        if (source_.has_silhouettes()) {
            for (const geometry::CalibratedCamera& camera : rig_)
                stages_.emplace_back(camera, options);
            return {};
        }
        if (options_.report) options_.report("learning the empty room");
        auto made = site_node::make_silhouette_stages(source_, recorded_, options, {});
        for (auto& stage : made) {
            if (!stage) return tl::unexpected(stage.error());
            stages_.push_back(std::move(*stage));
        }
        return {};
    }

    // The silhouettes of all cameras, undistorted by the rig's lenses. Cameras without a picture
    // have none, and say so in has_picture_.
    std::vector<Contours> see(std::size_t instant) {
        std::vector<Contours> seen(rig_.size());
        has_picture_.assign(rig_.size(), 0);
        for (std::size_t c = 0; c < rig_.size(); ++c) {
            const auto frame = source_.read_picture(recorded_[c], instant);
            const auto found = frame ? stages_[c].find(*frame, {}, picture_)
                                     : Expected<void>(tl::unexpected(frame.error()));
            if (!found) {
                failure_ = found.error();  // a lost picture; the others go on
                continue;
            }
            has_picture_[c] = has_any_ = 1;
            for (std::size_t i = 0; i < picture_.dropped.size(); ++i) {
                std::vector<Eigen::Vector2d> contour;
                std::vector<std::uint32_t> edges;
                if (picture_.dropped[i] == 0 &&
                    silhouette::undistort_polygon(
                        picture_.outlines[i].vertices_px, rig_[c].intrinsics, contour, edges))
                    seen[c].push_back(std::move(contour));
            }
        }
        return seen;
    }

    std::vector<coherence::SilhouetteHull> hulls_of(const std::vector<Contours>& seen) const {
        std::vector<coherence::SilhouetteHull> hulls;
        for (std::size_t c = 0; c < rig_.size(); ++c) {
            hulls.push_back(coherence::hull_of(seen[c], rig_[c].intrinsics));
            hulls.back().has_picture = has_picture_[c] != 0;
        }
        return hulls;
    }

    capture::RecordingSource& source_;
    std::span<const geometry::CalibratedCamera> rig_;
    const TakeOptions& options_;
    std::vector<std::size_t> recorded_;  // of each camera of the rig
    std::vector<site_node::SilhouetteStage> stages_;
    site_node::PictureSilhouette picture_;
    std::vector<std::uint8_t> has_picture_;
    std::uint8_t has_any_ = 0;
    Error failure_;
};

}  // namespace

Expected<Take> read_take(const std::filesystem::path& recording,
                         std::span<const geometry::CalibratedCamera> rig,
                         const TakeOptions& options) {
    if (has_polygons(recording)) return read_polygons(recording, rig, options);
    capture::RecordingOptions how;
    how.folder = recording;
    auto source = capture::RecordingSource::open(how);
    if (!source) return tl::unexpected(source.error());
    auto take = TakeReader(**source, rig, options).read();
    if (take) return take;
    return make_error(take.error().kind,
                      fmt::format("{}: {}", recording.string(), take.error().message));
}

double coverage_of(const Take& take,
                   std::span<const std::size_t> sights,
                   std::span<const geometry::CalibratedCamera> cameras) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const std::size_t s : sights) {
        std::vector<views::NamedView> views = take.views[s];
        for (views::NamedView& view : views) {
            const auto camera =
                std::ranges::find(cameras, view.name, &geometry::CalibratedCamera::name);
            view.view.intrinsics = camera->intrinsics;
            view.view.camera_from_site = camera->camera_from_site;
        }
        const rig_check::Agreement agreement = rig_check::measure_agreement(views, {});
        if (agreement.num_rays() == 0) continue;
        sum += agreement.share();
        ++count;
    }
    return count == 0 ? 1.0 : sum / static_cast<double>(count);
}

}  // namespace atrium::calibrate
