#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::site_node {

/// Drops the floating pieces that appear between several people: parts of space that all cameras
/// see as people, but where the people themselves already explain the silhouettes.
///
/// A component much smaller than the largest is kept only if some camera sees a part of it that no
/// kept component covers: the silhouettes stay covered but for slivers. Looks at components in the
/// order of their volumes. Does nothing if there is only one component.
///
/// Reusable: allocates only while its memory grows. Based on the safe hulls of Miller and Hilton,
/// "Safe Hulls" (CVMP 2007), which drop every component that no silhouette needs; this drops one
/// after the other, therefore two that explain each other never vanish together.
class WeakComponents {
public:
    /// `views` may contain null. Counts the dropped ones in `hull` as phantoms.
    void drop(std::span<const hull::SilhouetteView* const> views, hull::VisualHull& hull);

private:
    struct Component {
        std::uint32_t root = 0;
        double volume_m3 = 0.0;
        std::uint32_t first = 0;  // in triangles_
        std::uint32_t num = 0;
        bool is_kept = true;
    };
    // Pixels covered by kept components, at half the resolution of the picture.
    struct Cover {
        const hull::SilhouetteView* view = nullptr;
        int width = 0;
        int height = 0;
        std::vector<std::uint8_t> pixels;
        std::vector<float> projected;  // u, v per vertex [half px]; of those behind it NaN
    };

    std::uint32_t root_of(std::uint32_t vertex);
    void find_components(const geometry::TriangleMesh& mesh);
    void project(std::span<const hull::SilhouetteView* const> views,
                 const geometry::TriangleMesh& mesh);
    template <typename Visit>
    void rasterise(const Component& component,
                   const geometry::TriangleMesh& mesh,
                   const Cover& cover,
                   Visit&& visit) const;
    bool is_needed(const Component& component, const geometry::TriangleMesh& mesh);
    void remove_dropped(hull::VisualHull& hull);

    std::vector<std::uint32_t> parent_;     // per vertex
    std::vector<std::uint32_t> triangles_;  // sorted by component
    std::vector<Component> components_;     // largest first
    std::vector<std::uint32_t> component_of_root_;
    std::vector<Cover> covers_;
    std::vector<std::uint32_t> own_;  // pixels of the component that is tested
};

}  // namespace atrium::site_node
