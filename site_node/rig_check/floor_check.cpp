#include "site_node/rig_check/floor_check.hpp"

#include "site_node/rig_check/agreeing_depths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::rig_check {
namespace {

constexpr double kLevel_m = 0.01;
constexpr double kHalfSole_m2 = 0.01;
// Soles of smaller hulls are smaller by the square: of children, and of adults in a rig whose
// lengths are too short, whose calves would else be the first section with half a sole.
constexpr double kWholeSole_m = 1.5;
constexpr double kLowest_m = 0.2;
constexpr double kTallest_m = 3.5;
// A hull as high as a whole person who sits or stands. Lower ones may be the upper half of a person
// behind a table, higher ones hold ghosts or several people above each other.
constexpr double kLeastHeight_m = 1.0;
constexpr double kMostHeight_m = 2.4;
// Measured feet of people on the floor: +0.00 m from 8 and 20 cameras, -0.07 and -0.11 m from 4
// cameras, because the cones of cameras that look down meet below the feet. Steeper cameras reach
// deeper. Above, silhouettes miss dark shoes, up to the ankles.
constexpr double kBelow_m = -0.25;
constexpr double kAbove_m = 0.2;
// Of a lower end that cameras agree on. Silhouettes may reach as far below the middle of the feet,
// in vertical metres: a foot nearer to a camera that looks down appears lower. Something that hides
// as much of one silhouette would look like feet at this height, so they must be higher.
constexpr double kLowerEnd_m = 0.4;
constexpr double kHigh_m = 0.45;
constexpr double kBesideFeet_m = 0.5;  // farther aside are other people
constexpr double kLowerPart_m = 0.5;   // above the feet; what a border cuts there counts
constexpr double kNearBorder_px = 3.0;
constexpr std::size_t kCamerasPerCut = 8;   // one of so many may be cut
constexpr std::size_t kMostInstants = 600;  // these have decided it
constexpr double kMostlyOff = 0.8;

struct Section {
    double area_m2 = 0.0;
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();  // area times middle
};

// Sections of a mesh by levels kLevel_m apart, by Green's theorem. `origin`: of all coordinates.
std::vector<Section> cut_levels(const geometry::TriangleMesh& mesh,
                                const Eigen::Vector3d& origin,
                                std::size_t num_levels) {
    std::vector<Section> sections(num_levels);
    for (const auto& triangle : mesh.triangles) {
        const std::array<Eigen::Vector3d, 3> corners{mesh.vertices[triangle[0]] - origin,
                                                     mesh.vertices[triangle[1]] - origin,
                                                     mesh.vertices[triangle[2]] - origin};
        const auto [low, high] = std::minmax({corners[0].z(), corners[1].z(), corners[2].z()});
        const auto first = static_cast<std::size_t>(std::max(0.0, std::ceil(low / kLevel_m)));
        for (std::size_t i = first; i < num_levels; ++i) {
            const double z = static_cast<double>(i) * kLevel_m;
            if (z >= high) break;
            Eigen::Vector2d from = Eigen::Vector2d::Zero();
            Eigen::Vector2d to = Eigen::Vector2d::Zero();
            for (std::size_t k = 0; k < 3; ++k) {
                const Eigen::Vector3d& a = corners[k];
                const Eigen::Vector3d& b = corners[(k + 1) % 3];
                if ((a.z() > z) == (b.z() > z)) continue;
                const Eigen::Vector3d p = a + (z - a.z()) / (b.z() - a.z()) * (b - a);
                (a.z() > z ? from : to) = p.head<2>();  // the inside is on the left
            }
            const double twice_m2 = from.x() * to.y() - from.y() * to.x();
            sections[i].area_m2 += 0.5 * twice_m2;
            sections[i].moment += twice_m2 / 6.0 * (from + to);
        }
    }
    return sections;
}

struct LowerEnd {
    bool is_known = false;
    bool is_cut = false;      // by the picture's border
    bool is_at_feet = false;  // does not go on far below them
};

LowerEnd lower_end_of(const hull::SilhouetteView& view, const Eigen::Vector3d& feet_site) {
    constexpr double kStep_m = 0.1;
    const auto& k = view.intrinsics;
    const Eigen::Vector3d at = view.camera_from_site * feet_site;
    const Eigen::Vector3d below =
        view.camera_from_site * Eigen::Vector3d(feet_site - kStep_m * Eigen::Vector3d::UnitZ());
    if (!(at.z() > kStep_m) || !(below.z() > 0.0) || view.contours.empty()) return {};
    const Eigen::Vector2d feet_px = k.project(at);
    const Eigen::Vector2d down = (k.project(below) - feet_px) / kStep_m;  // pixels per metre
    if (!(down.norm() > 1.0)) return {};
    LowerEnd result{true, false, true};
    for (const auto& contour : view.contours) {
        for (const Eigen::Vector2d& p : contour) {
            const Eigen::Vector2d off = p - feet_px;
            const double down_m = off.dot(down) / down.squaredNorm();
            const double aside_m = (off.x() * down.y() - off.y() * down.x()) / down.squaredNorm();
            if (std::abs(aside_m) < kBesideFeet_m && down_m > kLowerEnd_m)
                result.is_at_feet = false;
            if (down_m < -kLowerPart_m || result.is_cut) continue;
            const Eigen::Vector2d in_picture = k.distort(p);
            result.is_cut = !(in_picture.x() > kNearBorder_px && in_picture.y() > kNearBorder_px &&
                              in_picture.x() < k.width - 1.0 - kNearBorder_px &&
                              in_picture.y() < k.height - 1.0 - kNearBorder_px);
        }
    }
    return result;
}

}  // namespace

std::optional<Footing> find_footing(const geometry::TriangleMesh& hull) {
    const geometry::Aabb extent = geometry::bounds(hull);
    if (extent.empty() || !(extent.size().z() < kTallest_m) || extent.size().z() < kLowest_m)
        return std::nullopt;
    const double size = std::min(1.0, extent.size().z() / kWholeSole_m);
    const double least_m2 = kHalfSole_m2 * size * size;
    Eigen::Vector3d origin = extent.centre();
    origin.z() = extent.min.z();
    const auto num_levels = static_cast<std::size_t>(extent.size().z() / kLevel_m) + 1;
    const std::vector<Section> sections = cut_levels(hull, origin, num_levels);
    for (std::size_t i = 0; i < num_levels; ++i) {
        const Section& section = sections[i];
        if (section.area_m2 < least_m2) continue;
        const Eigen::Vector2d middle = section.moment / section.area_m2;
        const double above_m = static_cast<double>(i) * kLevel_m;
        return Footing{origin + Eigen::Vector3d(middle.x(), middle.y(), above_m),
                       extent.size().z() - above_m};
    }
    return std::nullopt;
}

bool sees_place(std::span<const views::NamedView> views,
                const Eigen::Vector3d& place_site,
                bool knows_outside) {
    const auto num_seeing =
        static_cast<std::size_t>(std::ranges::count_if(views, [&](const auto& view) {
            return Projector(view.view, knows_outside).is_in_picture(place_site);
        }));
    return num_seeing >= 2 && (num_seeing == views.size() || !knows_outside);
}

bool sees_floor(std::span<const views::NamedView> views,
                const Eigen::Vector3d& feet_site,
                bool knows_outside) {
    return sees_place(views, {feet_site.x(), feet_site.y(), 0.0}, knows_outside);
}

bool shows_lower_end(std::span<const views::NamedView> views, const Footing& footing) {
    if (footing.feet_site.z() < kHigh_m || views.size() < 2) return false;
    std::size_t num_cut = 0;
    for (const auto& view : views) {
        const LowerEnd end = lower_end_of(view.view, footing.feet_site);
        if (!end.is_known || !end.is_at_feet) return false;
        num_cut += end.is_cut ? 1 : 0;
    }
    return num_cut <= views.size() / kCamerasPerCut;
}

void FloorCheck::add(const Footing& footing, bool is_floor_seen) {
    const double feet_m = footing.feet_site.z();
    if (footing.height_m < kLeastHeight_m || footing.height_m > kMostHeight_m) return;
    if ((feet_m > kAbove_m && !is_floor_seen) || feet_m_.size() >= kMostInstants) return;
    feet_m_.push_back(feet_m);
}

std::optional<double> FloorCheck::feet_off_floor_m() const {
    if (feet_m_.size() < kLeastInstants) return std::nullopt;
    const auto is_most = [&](auto is_off) {
        return static_cast<double>(std::ranges::count_if(feet_m_, is_off)) >=
               kMostlyOff * static_cast<double>(feet_m_.size());
    };
    if (!is_most([](double feet_m) { return feet_m < kBelow_m; }) &&
        !is_most([](double feet_m) { return feet_m > kAbove_m; }))
        return std::nullopt;
    std::vector<double> sorted = feet_m_;
    const auto median = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, median);
    return *median;
}

std::string explain_floor(double feet_m,
                          const std::string& camera,
                          double lens_z_m,
                          const std::optional<Measured>& measured) {
    const std::string seen =
        feet_m < 0.0
            ? fmt::format("people stand {:.2f} m below the floor, z = 0 of the rig", -feet_m)
            : fmt::format("the feet of people stay {:.2f} m above the floor, z = 0 of the rig",
                          feet_m);
    const std::string if_so =
        feet_m < 0.0 ? "" : "if they do not stand on a platform and nothing hides their feet, ";
    if (measured && measured->has_heights) {
        return fmt::format(
            "{}: {}a number of --distance or --camera-height is wrong (you say: {}), or the up "
            "direction is: measure again, in metres, heights from the floor to the lens; by this "
            "{} is about {:.2f} m above the floor, if the other numbers are right",
            seen,
            if_so,
            measured->text,
            camera,
            lens_z_m - feet_m);
    }
    const bool may_have_board = !measured || measured->text.empty();
    const std::string or_measured =
        !measured ? ", or a measured height or distance that was given to the import is wrong"
        : may_have_board
            ? ""
            : fmt::format(", or a number of --distance is wrong (you say: {})", measured->text);
    return fmt::format(
        "{}: {}{} origin lies {} the floor{}, or {} up direction is wrong{}: measure how high the "
        "lens of {} is above the floor, about {:.2f} m by this, and import the calibration again: "
        "atrium calibrate import ... --camera-height {} METRES",
        seen,
        if_so,
        feet_m < 0.0 ? "its" : "the",
        feet_m < 0.0 ? "above" : "below",
        feet_m < 0.0 && may_have_board ? ", as that of a board on a table does" : "",
        feet_m < 0.0 ? "its" : "the",
        or_measured,
        camera,
        lens_z_m - feet_m,
        camera);
}

}  // namespace atrium::rig_check
