#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/motion/motion_picture.hpp"
#include "tests/support/pictures/surface_painter.hpp"
#include "tests/support/world/acted_person.hpp"

#include <cstdint>
#include <vector>

namespace atrium::test {

/// What the cameras of a site see of an act at one instant.
struct FilmedInstant {
    geometry::TriangleMesh truth;                 // the person and the prop
    geometry::TriangleMesh hull;                  // empty: no hull
    std::vector<motion::MotionPicture> pictures;  // one per camera
};

/// Films acts with painted people: clothes, skin and hair in the colours of their look, with the
/// stages of a site for silhouettes, hull and textures. Masks are true, with flickering borders.
class ActFilmer {
public:
    /// `cameras`: without lens distortion. `cloth`: [grey levels] weave of the clothes, with
    /// structure from 5 mm to 2.5 cm; 0: plain colours.
    ActFilmer(const Act& act,
              std::vector<geometry::CalibratedCamera> cameras,
              double cloth,
              std::uint64_t seed);

    FilmedInstant take(double time_s);
    /// Vertices in the order of those of `FilmedInstant::truth`.
    std::vector<Eigen::Vector3d> truth_at(double time_s) const;

private:
    Act act_;
    ActedPerson person_;
    std::vector<geometry::CalibratedCamera> cameras_;
    SurfacePainter::Paint paint_;
    std::vector<Eigen::Vector3d> places_at_rest_;
    std::vector<SurfacePainter> painters_;
    Random random_;
};

}  // namespace atrium::test
