#include "site_node/silhouette_stage/learned_rooms.hpp"

#include "site_node/rig_check/agreement.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/silhouette/silhouette.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::site_node {
namespace {

constexpr std::size_t kMostCompared = 12;  // instants
constexpr double kContradicts = 0.8;       // as fit=poor of the site

// Segments pictures of one camera.
class LearnedCamera {
public:
    LearnedCamera(const geometry::CalibratedCamera& camera,
                  std::span<const image::YuvView> pictures,
                  const segmentation::BackgroundStatistics& room,
                  const segmentation::SegmentationOptions& options)
        : camera_(camera), pictures_(pictures), segmenter_(room, options) {}

    const std::string& name() const { return camera_.name; }

    bool has_picture(std::size_t instant) const {
        return instant < pictures_.size() && pictures_[instant].width() > 0;
    }

    hull::SilhouetteView view(std::size_t instant) {
        hull::SilhouetteView view;
        view.intrinsics = camera_.intrinsics;
        view.camera_from_site = camera_.camera_from_site;
        if (!segmenter_.segment(pictures_[instant], mask_) ||
            mask_.width != view.intrinsics.width || mask_.height != view.intrinsics.height)
            return view;
        silhouette::extract_silhouette(mask_, camera_.intrinsics, {}, scratch_, polygons_);
        for (const auto& polygon : polygons_) view.contours.push_back(polygon.vertices_px);
        return view;
    }

private:
    const geometry::CalibratedCamera& camera_;
    std::span<const image::YuvView> pictures_;
    segmentation::Segmenter segmenter_;
    image::Mask mask_;
    silhouette::SilhouetteScratch scratch_;
    std::vector<silhouette::SilhouettePolygon> polygons_;
};

std::vector<std::size_t> instants_of_all(const std::vector<LearnedCamera>& cameras,
                                         std::size_t num_instants) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < num_instants; ++i) {
        if (std::ranges::all_of(cameras, [i](const auto& camera) { return camera.has_picture(i); }))
            all.push_back(i);
    }
    if (all.size() <= kMostCompared) return all;
    std::vector<std::size_t> some;
    for (std::size_t i = 0; i < kMostCompared; ++i)
        some.push_back(all[i * all.size() / kMostCompared]);
    return some;
}

}  // namespace

std::optional<LearnedAgreement> compare_learned_rooms(
    const config::Rig& rig,
    std::span<const std::vector<image::YuvView>> pictures,
    std::span<const segmentation::BackgroundStatistics* const> rooms,
    const segmentation::SegmentationOptions& options,
    const std::stop_token& stop) {
    std::vector<LearnedCamera> cameras;
    std::size_t num_instants = 0;
    for (std::size_t c = 0; c < rooms.size() && c < pictures.size(); ++c) {
        if (rooms[c] == nullptr) continue;
        cameras.emplace_back(rig.cameras[c], pictures[c], *rooms[c], options);
        num_instants = std::max(num_instants, pictures[c].size());
    }
    if (cameras.size() < 3) return std::nullopt;
    rig_check::AgreementOptions agreement_options;
    agreement_options.knows_outside = false;
    agreement_options.bounds = rig.bounds_site;
    rig_check::Agreement sum;
    sum.cameras.resize(cameras.size());
    LearnedAgreement result;
    for (const std::size_t instant : instants_of_all(cameras, num_instants)) {
        if (stop.stop_requested()) return std::nullopt;
        std::vector<hull::SilhouetteView> views;
        for (LearnedCamera& camera : cameras) views.push_back(camera.view(instant));
        const auto agreement = rig_check::measure_agreement(views, agreement_options);
        if (agreement.num_rays() > 0) ++result.num_instants;
        for (std::size_t c = 0; c < cameras.size(); ++c) {
            rig_check::CameraAgreement& one = sum.cameras[c];
            one.rays += agreement.cameras[c].rays;
            one.explained += agreement.cameras[c].explained;
            one.cut += agreement.cameras[c].cut;
            one.beyond += agreement.cameras[c].beyond;
        }
    }
    if (result.num_instants == 0) return std::nullopt;
    const std::size_t worst = sum.worst();
    result.explained = sum.share();
    result.worst = cameras[worst].name();
    result.worst_explained = sum.cameras[worst].share();
    return result;
}

std::string doubt_learned_rooms(const LearnedAgreement& agreement) {
    if (agreement.explained >= kContradicts) return {};
    return fmt::format(
        "learned_rooms_contradict explained={:.2f} worst={}:{:.2f} reason=\"what the cameras show "
        "as people in the pictures from which the room was learned contradicts each other: "
        "somebody who stayed at one place all the time, or turned on the spot, became part of the "
        "room, and torso or head are missing in the silhouettes (--preview); or the calibration is "
        "wrong. Give masks of another tool (calibrate import --masks), a picture of the empty room "
        "(<camera>/background.png), or a recording in which everybody walks away from where they "
        "stood (docs/backgrounds.md)\"",
        agreement.explained,
        agreement.worst,
        agreement.worst_explained);
}

}  // namespace atrium::site_node
