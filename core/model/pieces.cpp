#include "core/model/pieces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <numeric>

namespace atrium::model {
namespace {

// The connected surfaces of a mesh, in the order of their first vertices. Vertices at one place are
// one: an STL file repeats them for each triangle.
std::vector<Piece> shells_of(const geometry::TriangleMesh& mesh) {
    std::vector<std::size_t> up(mesh.vertices.size());
    std::iota(up.begin(), up.end(), std::size_t{0});
    const auto root = [&up](std::size_t i) {
        while (up[i] != i) i = up[i] = up[up[i]];
        return i;
    };
    const auto join = [&](std::size_t a, std::size_t b) {
        const auto [low, high] = std::minmax({root(a), root(b)});
        up[high] = low;
    };
    std::map<std::array<double, 3>, std::size_t> first_at;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Eigen::Vector3d& v = mesh.vertices[i];
        join(i, first_at.try_emplace({v.x(), v.y(), v.z()}, i).first->second);
    }
    std::vector<bool> is_used(mesh.vertices.size(), false);
    for (const auto& triangle : mesh.triangles) {
        join(triangle[0], triangle[1]);
        join(triangle[0], triangle[2]);
        for (const auto vertex : triangle) is_used[vertex] = true;
    }
    std::map<std::size_t, std::size_t> shell_of_root;
    std::vector<Piece> shells;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (!is_used[i]) continue;
        const auto [shell, is_new] = shell_of_root.try_emplace(root(i), shells.size());
        if (is_new) shells.push_back({fmt::format("{}", shells.size() + 1), {}});
        shells[shell->second].points.push_back(mesh.vertices[i]);
    }
    return shells;
}

bool is_without_parts(const std::filesystem::path& file) {
    const std::string ending = ending_of(file);
    return ending == ".stl" || ending == ".ply" || ending == ".off";
}

}  // namespace

std::vector<Piece> pieces_of(const std::vector<ModelPart>& parts,
                             const std::filesystem::path& file) {
    std::vector<Piece> pieces;
    for (const ModelPart& part : parts) {
        if (is_without_parts(file))
            std::ranges::move(shells_of(part.mesh), std::back_inserter(pieces));
        else
            pieces.push_back({part.name, part.mesh.vertices});
    }
    return pieces;
}

}  // namespace atrium::model
