#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::refine {

/// Shrinks parts of a closed mesh to a membrane across the place where they grow out of the rest.
/// Keeps its memory.
class Membrane {
public:
    /// Moves the places of vertices with `shares` above 0 towards the mean of their neighbours,
    /// again and again (successive over-relaxation), until a part of a dozen edges rests. Then goes
    /// back by what their shares lack to 1. All other places stay. One place and share per vertex
    /// of the triangles, which are those of a closed 2-manifold.
    void shrink(std::span<const std::array<std::uint32_t, 3>> triangles,
                std::span<const float> shares,
                std::vector<Eigen::Vector3f>& places);

private:
    using Link = std::array<std::uint32_t, 2>;  // from a vertex that moves to a neighbour

    std::vector<Link> links_;
    std::vector<Eigen::Vector3f> before_;
};

}  // namespace atrium::refine
