#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/clean_views.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// Drops the components of a hull that no silhouette needs. Where several people stand between few
/// cameras, viewing cones of different people also meet where nobody is.
///
/// A component explains the pixels that it covers. It is needed in a view if a compact area there,
/// or most of what it covers, is explained by no other component that is kept. Slivers along
/// outlines, left by noise and calibration errors, do not count. A component with nine tenths of
/// the volume is always kept: others are compared with it. See docs/design/hull.md.
///
/// Reuse one object; it allocates only while it grows. Not thread-safe.
class NeededComponents {
public:
    /// Drops components from `hull.mesh` and counts them as phantoms. Keeps components that
    /// silhouettes cannot tell from each other, and those that fewer than three views see whole.
    /// The result does not depend on the order of views or the number of workers.
    void keep_only(std::span<const CleanViews::View> views, Executor& executor, VisualHull& hull);

private:
    using Set = std::uint64_t;  // of components, one bit each
    static constexpr std::size_t kMost = 64;

    struct Component {
        std::uint32_t root = 0;  // vertex
        double six_volumes = 0.0;
    };
    struct Areas {  // [cells], by component
        std::array<std::uint32_t, kMost> all{};
        std::array<std::uint32_t, kMost> inner{};  // of which all eight neighbours belong to it
    };
    struct Raster {
        int width = 0;
        int height = 0;
        std::vector<Set> cells;               // components that cover a cell
        std::vector<Set> beside;              // see measure
        std::vector<Eigen::Vector2f> points;  // vertices [cells]; NaN behind the camera
        Set seen_whole = 0;
        Areas own;
        Areas need;
    };
    enum class Kind : std::uint8_t { kOwn, kAlone, kBeyond };

    std::uint32_t find_root(std::uint32_t v);
    void find_components(const geometry::TriangleMesh& mesh);
    void draw(const SilhouetteView& view, const geometry::TriangleMesh& mesh, Raster& raster) const;
    void project(const SilhouetteView& view,
                 const geometry::TriangleMesh& mesh,
                 Raster& raster) const;
    static void measure(Raster& raster, Kind kind, Set alive, Set explaining, Areas& areas);
    Set needed(Kind kind, Set alive, Set explaining);
    Set choose(Set all);
    Set dominated(Set alive, Set sure);
    void write(Set kept, VisualHull& hull);

    std::vector<std::uint32_t> parent_;  // by vertex
    std::vector<std::uint8_t> bit_of_;   // by vertex: its component, largest first
    std::vector<Component> components_;  // largest first
    bool has_dominant_ = false;          // the first one holds nearly all volume, and is kept
    std::vector<Raster> rasters_;        // by view
    std::size_t num_views_ = 0;
    std::vector<std::uint32_t> new_index_;  // by vertex
};

}  // namespace atrium::hull
