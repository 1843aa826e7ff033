#include "tests/support/pictures/filmed_act.hpp"

#include "simulation/body_shape.hpp"
#include "simulation/look.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/texture/texture.hpp"
#include "tests/support/shapes/bounding_rect.hpp"
#include "tests/support/world/camera_masks.hpp"

#include <cmath>
#include <utility>

namespace atrium::test {
namespace {

constexpr double kPropAt = 10.0;  // props are painted where no person is
constexpr double kFlicker = 0.15;

double luma(const simulation::Colour& c) {
    return 255.0 * (0.299 * static_cast<double>(c[0]) + 0.587 * static_cast<double>(c[1]) +
                    0.114 * static_cast<double>(c[2]));
}

// The parts of a look that a camera can tell apart at a distance, as the simulation paints them.
double paint_person(const simulation::Look& look, const Eigen::Vector3d& p, double weave) {
    const simulation::RestJoints joints;
    const bool right = p.x() > 0.0;
    const Eigen::Vector3d q(std::abs(p.x()), p.y(), p.z());
    const double along = (q - joints.shoulder).dot(joints.arm_direction);
    const double off = (q - joints.shoulder - along * joints.arm_direction).norm();
    if (along > 0.02 && off < 0.09 && q.x() > joints.shoulder.x()) {
        const double sleeve = luma(right ? look.sleeve_right : look.sleeve_left);
        if (along > 0.515) return luma(look.skin) + 0.3 * weave;
        if (along > 0.485) return 0.62 * sleeve;
        if (right)
            return (along > 0.19 && along < 0.25 ? luma(look.emblem_colour) : sleeve) + weave;
        const double turns = along * 14.0;
        const bool striped = turns - std::floor(turns) < 0.28 && along > 0.12;
        return (striped ? 0.7 * sleeve + 0.3 * luma(look.shirt) : sleeve) + weave;
    }
    if (p.z() > 1.47) {
        const bool is_hair = p.y() >= 0.03 ? p.z() > 1.69 : true;
        return luma(is_hair ? look.hair : look.skin) + 0.3 * weave;
    }
    if (p.z() > 0.95) {
        const bool front = p.y() > 0.0;
        const double from_emblem = std::abs(std::hypot(p.x(), p.z() - 1.28) - 0.06);
        if (front && from_emblem < 0.02) return luma(look.emblem_colour) + weave;
        return luma(front ? look.shirt : look.back) + weave;
    }
    if (p.z() <= 0.12) return luma(look.shoes) + weave;
    return luma(std::abs(q.x() - 0.19) < 0.012 ? look.stripe : look.trousers) + weave;
}

double weave_at(const Eigen::Vector3d& p) {
    return noise_at(p, 40.0) + noise_at(p, 90.0) + 0.7 * noise_at(p, 200.0);
}

}  // namespace

ActFilmer::ActFilmer(const Act& act,
                     std::vector<geometry::CalibratedCamera> cameras,
                     double cloth,
                     std::uint64_t seed)
    : act_(act), person_(act), cameras_(std::move(cameras)), random_(seed) {
    simulation::Look look;
    if (!act.look.empty()) {
        look = *simulation::find_look(act.look);
        for (const Eigen::Vector3d& vertex : simulation::make_skin(look).mesh.vertices)
            places_at_rest_.push_back(vertex);
    }
    for (const Eigen::Vector3d& vertex : act.prop.vertices)
        places_at_rest_.push_back(vertex + kPropAt * Eigen::Vector3d::UnitX());
    paint_ = [look, cloth](const Eigen::Vector3d& p) {
        if (p.x() > 0.5 * kPropAt) return 150.0 + std::max(cloth, 4.0) * weave_at(p);
        return paint_person(look, p, cloth * weave_at(p));
    };
    for (const auto& camera : cameras_) painters_.emplace_back(camera);
}

std::vector<Eigen::Vector3d> ActFilmer::truth_at(double time_s) const {
    return person_.mesh_site(time_s).vertices;
}

FilmedInstant ActFilmer::take(double time_s) {
    FilmedInstant instant;
    instant.truth = person_.mesh_site(time_s);
    instant.pictures.resize(cameras_.size());
    std::vector<hull::SilhouetteView> views;
    silhouette::SilhouetteScratch silhouette_scratch;
    std::vector<silhouette::SilhouettePolygon> polygons;
    texture::TextureScratch texture_scratch;
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        painters_[i].draw(instant.truth, places_at_rest_, paint_, random_);
        MaskPainter seen(cameras_[i]);
        seen.draw(instant.truth);
        seen.flicker(kFlicker, random_);
        silhouette::extract_silhouette(
            seen.mask(), cameras_[i].intrinsics, {}, silhouette_scratch, polygons);
        hull::SilhouetteView& view = views.emplace_back(
            hull::SilhouetteView{cameras_[i].intrinsics, cameras_[i].camera_from_site, {}, {}});
        for (const auto& polygon : polygons) view.contours.push_back(polygon.vertices_px);
        codec::TextureCrop crop;
        if (texture::crop_texture(painters_[i].picture(),
                                  seen.mask(),
                                  bounding_rect(seen.mask()),
                                  {},
                                  texture_scratch,
                                  crop))
            motion::reduce(crop, instant.pictures[i]);
    }
    hull::HullScratch hull_scratch;
    hull::VisualHull hull = hull::compute_visual_hull(views, {}, hull_scratch);
    if (hull.status == hull::HullStatus::kOk) instant.hull = std::move(hull.mesh);
    return instant;
}

}  // namespace atrium::test
