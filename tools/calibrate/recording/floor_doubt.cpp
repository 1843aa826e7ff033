#include "tools/calibrate/recording/floor_doubt.hpp"

#include "site_node/hull/visual_hull.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/views/named_view.hpp"
#include "tools/calibrate/recording/mask_reading.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMostCameras = 8;
constexpr std::size_t kMostInstants = 12;
constexpr std::uint64_t kMostSteps = 50'000'000;  // of a hull; a person from 8 cameras needs 2 M

template <typename Item>
std::vector<Item> spread(const std::vector<Item>& items, std::size_t most) {
    if (items.size() <= most) return items;
    std::vector<Item> chosen;
    for (std::size_t i = 0; i < most; ++i) chosen.push_back(items[i * items.size() / most]);
    return chosen;
}

class MaskHulls {
public:
    MaskHulls(const Material& material, const std::vector<geometry::CalibratedCamera>& cameras)
        : material_(material) {
        for (const auto& camera : cameras) {
            if (material.masks.contains(camera.name)) cameras_.push_back(camera);
        }
        cameras_ = spread(cameras_, kMostCameras);
    }

    // Numbers of the masks that all these cameras have.
    std::vector<std::size_t> instants() const {
        std::vector<std::size_t> numbers;
        if (cameras_.size() < 2) return numbers;
        for (const auto& [number, file] : material_.masks.at(cameras_[0].name).pictures) {
            const bool have_all = std::ranges::all_of(cameras_, [&](const auto& camera) {
                return material_.masks.at(camera.name).pictures.contains(number);
            });
            if (have_all) numbers.push_back(number);
        }
        return spread(numbers, kMostInstants);
    }

    void look(std::size_t number, rig_check::FloorCheck& check) {
        std::vector<views::NamedView> views;
        std::vector<hull::SilhouetteView> silhouettes;
        for (const auto& camera : cameras_) {
            const auto mask = read_mask(material_.masks.at(camera.name).pictures.at(number),
                                        material_.mask_reading);
            if (!mask || mask->width != camera.intrinsics.width ||
                mask->height != camera.intrinsics.height)
                return;
            hull::SilhouetteView& view = silhouettes.emplace_back();
            view.intrinsics = camera.intrinsics;
            view.camera_from_site = camera.camera_from_site;
            silhouette::extract_silhouette(
                *mask, camera.intrinsics, {}, silhouette_scratch_, polygons_);
            for (const auto& polygon : polygons_) view.contours.push_back(polygon.vertices_px);
            views.push_back({camera.name, view});
        }
        hull::HullOptions options;
        options.max_steps = kMostSteps;
        const hull::VisualHull hull =
            hull::compute_visual_hull(silhouettes, options, hull_scratch_);
        const auto footing = rig_check::find_footing(hull.mesh);
        if (!footing) return;
        check.add(*footing,
                  rig_check::sees_floor(views, footing->feet_site, true) ||
                      rig_check::shows_lower_end(views, *footing));
    }

    const geometry::CalibratedCamera& first() const { return cameras_.front(); }

private:
    const Material& material_;
    std::vector<geometry::CalibratedCamera> cameras_;
    silhouette::SilhouetteScratch silhouette_scratch_;
    std::vector<silhouette::SilhouettePolygon> polygons_;
    hull::HullScratch hull_scratch_;
};

}  // namespace

std::string doubt_of_floor(const Material& material,
                           const std::vector<geometry::CalibratedCamera>& cameras,
                           const rig_check::Measured& measured,
                           const std::string& measured_camera) {
    MaskHulls hulls(material, cameras);
    const std::vector<std::size_t> instants = hulls.instants();
    if (instants.size() < rig_check::FloorCheck::kLeastInstants) return {};
    rig_check::FloorCheck check;
    for (const std::size_t number : instants) hulls.look(number, check);
    const auto feet_m = check.feet_off_floor_m();
    if (!feet_m) return {};
    const auto given =
        std::ranges::find(cameras, measured_camera, &geometry::CalibratedCamera::name);
    const geometry::CalibratedCamera& camera = given == cameras.end() ? hulls.first() : *given;
    return "floor: " +
           rig_check::explain_floor(*feet_m, camera.name, camera.centre_site().z(), measured);
}

}  // namespace atrium::calibrate
