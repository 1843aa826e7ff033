#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "site_node/views/named_view.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::rig_check {

/// What the people of one instant stand on.
struct Footing {
    Eigen::Vector3d feet_site;  // middle of the lowest section with the area of half a sole
    double height_m = 0.0;      // from there to the highest point
};

/// Finds the lowest horizontal section of a closed mesh with at least 100 cm2, to a centimetre; of
/// a mesh below 1.5 m less, by the square of its height. Thin spikes below feet, which the hull of
/// few cameras has, do not count. nullopt without such a section, and for meshes that are too tall
/// for people or lower than 0.2 m.
std::optional<Footing> find_footing(const geometry::TriangleMesh& hull);

/// True if the cameras see a place: all of them, or two if what lies outside a picture is unknown.
bool sees_place(std::span<const views::NamedView> views,
                const Eigen::Vector3d& place_site,
                bool knows_outside);

/// True if the cameras see the place below or above the feet at z = 0 (sees_place). Else feet above
/// it may be out of the pictures.
bool sees_floor(std::span<const views::NamedView> views,
                const Eigen::Vector3d& feet_site,
                bool knows_outside);

/// True if the hull's lower end is that of a person who hangs high above z = 0, whatever the
/// cameras see of the floor: hardly any silhouette is cut by the lower part of its picture's
/// border, and none goes on below the feet, as it does beside one whose lower end a desk or a
/// border hides. Needs silhouettes that are complete (`knows_outside`).
bool shows_lower_end(std::span<const views::NamedView> views, const Footing& footing);

/// Judges from the hulls of many instants whether z = 0 is the floor: people who walk, sit or jump
/// have a foot on it most of the time. The instants should be about a second apart.
class FloorCheck {
public:
    static constexpr std::size_t kLeastInstants = 10;

    /// `is_floor_seen`: see sees_floor and shows_lower_end.
    void add(const Footing& footing, bool is_floor_seen);

    /// [m] Height of the feet above z = 0 (negative: below), the median. nullopt if z = 0 may be
    /// the floor: at more than every fifth instant the feet are near it, or on the other side.
    std::optional<double> feet_off_floor_m() const;

private:
    std::vector<double> feet_m_;
};

/// What the user measured for the import of a calibration.
struct Measured {
    std::string text;  // "cam1 to cam3 6.137 m; cam1 2.083 m high"; empty: nothing
    bool has_heights = false;
};

/// Says what is wrong about a floor from which feet are `feet_m` away, with the cure.
/// `lens_z_m`: z of the camera `camera` in the rig. `measured`: nullopt if unknown; with heights,
/// `camera` should be one of them.
std::string explain_floor(double feet_m,
                          const std::string& camera,
                          double lens_z_m,
                          const std::optional<Measured>& measured = std::nullopt);

}  // namespace atrium::rig_check
