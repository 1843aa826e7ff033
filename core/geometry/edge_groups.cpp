#include "core/geometry/edge_groups.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace atrium::geometry {
namespace {

constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();

}  // namespace

Expected<void> check_triangles(const TriangleMesh& mesh) {
    if (mesh.triangles.size() >= kMost / 3 || mesh.vertices.size() >= kMost)
        return make_error(ErrorKind::kInvalidData, "mesh: more than 1.4 G triangles");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        if (std::max({a, b, c}) < mesh.vertices.size() && a != b && b != c && c != a) continue;
        return make_error(ErrorKind::kInvalidData,
                          "mesh: triangle " + std::to_string(t) +
                              " needs three different vertices below " +
                              std::to_string(mesh.vertices.size()));
    }
    return {};
}

// Counting sort by the smaller vertex; then only short lists have to be sorted.
Expected<void> EdgeGroups::assign(const TriangleMesh& mesh) {
    end_.clear();
    by_smaller_.clear();
    if (auto checked = check_triangles(mesh); !checked) return checked;
    end_.resize(mesh.vertices.size() + 1, 0);
    by_smaller_.resize(3 * mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        ++end_[std::min(a, b) + 1];
        ++end_[std::min(b, c) + 1];
        ++end_[std::min(c, a) + 1];
    }
    for (std::size_t v = 1; v < end_.size(); ++v) end_[v] += end_[v - 1];
    std::uint32_t edge = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const auto add = [&](std::uint32_t from, std::uint32_t to) {
            // filling moves the start of the list to its end
            by_smaller_[end_[std::min(from, to)]++] = {std::max(from, to), edge++, from < to};
        };
        add(a, b);
        add(b, c);
        add(c, a);
    }
    std::uint32_t begin = 0;
    for (const std::uint32_t end : end_) {
        const auto first = by_smaller_.begin();
        std::sort(first + begin, first + end, [](const Entry& l, const Entry& r) {
            return l.larger != r.larger ? l.larger < r.larger : l.edge < r.edge;
        });
        begin = end;
    }
    return {};
}

}  // namespace atrium::geometry
