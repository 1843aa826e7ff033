#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::geometry {

/// Checks that each triangle has three different vertices of the mesh. Fails with kInvalidData,
/// naming the triangle.
Expected<void> check_triangles(const TriangleMesh& mesh);

/// Groups the half-edges of a mesh by the two vertices that they join, to tell whether the surface
/// is closed. Each triangle has three half-edges: 3 * triangle + k goes from corner k to the next
/// one. Reuse one object: it allocates only while it grows.
class EdgeGroups {
public:
    struct Entry {
        std::uint32_t larger = 0;  // vertex
        std::uint32_t edge = 0;
        bool is_upwards = false;  // from the smaller to the larger vertex
    };

    /// Groups the edges of `mesh`. Fails as check_triangles does.
    Expected<void> assign(const TriangleMesh& mesh);

    /// Calls `visit(smaller, group)` for each pair of vertices with the edges that join them
    /// (`std::span<const Entry>`), ordered by the smaller vertex, then the larger. Stops if `visit`
    /// returns false.
    template <typename Visit>
    void for_each(const Visit& visit) const {
        std::uint32_t begin = 0;
        for (std::uint32_t smaller = 0; begin < by_smaller_.size(); ++smaller) {
            while (begin < end_[smaller]) {
                std::uint32_t end = begin + 1;
                while (end < end_[smaller] && by_smaller_[end].larger == by_smaller_[begin].larger)
                    ++end;
                const std::span<const Entry> all(by_smaller_);
                if (!visit(smaller, all.subspan(begin, end - begin))) return;
                begin = end;
            }
        }
    }

    /// True for two edges in opposite directions, as everywhere on a closed, oriented surface.
    static bool is_pair(std::span<const Entry> group) {
        return group.size() == 2 && group[0].is_upwards != group[1].is_upwards;
    }

private:
    std::vector<std::uint32_t> end_;  // per vertex: one past its groups in `by_smaller_`
    std::vector<Entry> by_smaller_;
};

}  // namespace atrium::geometry
