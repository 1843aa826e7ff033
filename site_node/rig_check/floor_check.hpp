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

/// Finds the lowest horizontal section of a closed mesh with at least 100 cm2, to a centimetre.
/// Thin spikes below feet, which the hull of few cameras has, do not count. nullopt without such a
/// section, and for meshes that are too tall for people.
std::optional<Footing> find_footing(const geometry::TriangleMesh& hull);

/// True if the cameras see the place below or above the feet at z = 0: all of them, or two if what
/// lies outside a picture is unknown. Else feet above it may be out of the pictures.
bool sees_floor(std::span<const views::NamedView> views,
                const Eigen::Vector3d& feet_site,
                bool knows_outside);

/// Judges from the hulls of many instants whether z = 0 is the floor: people who walk, sit or jump
/// have a foot on it most of the time. The instants should be about a second apart.
class FloorCheck {
public:
    static constexpr std::size_t kLeastInstants = 10;

    /// `is_floor_seen`: see sees_floor.
    void add(const Footing& footing, bool is_floor_seen);

    /// [m] Height of the feet above z = 0 (negative: below), the median. nullopt if z = 0 may be
    /// the floor: at more than every fifth instant the feet are near it, or on the other side.
    std::optional<double> feet_off_floor_m() const;

private:
    std::vector<double> feet_m_;
};

/// Says what is wrong about a floor from which feet are `feet_m` away, with the cure.
/// `lens_z_m`: z of the camera `camera` in the rig.
std::string explain_floor(double feet_m, const std::string& camera, double lens_z_m);

}  // namespace atrium::rig_check
