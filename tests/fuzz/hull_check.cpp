#include "tests/fuzz/hull_check.hpp"

#include "core/base/thread_pool.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <algorithm>
#include <cstring>

namespace atrium::test {
namespace {

std::string check_status(const hull::VisualHull& hull) {
    if (hull.status != hull::HullStatus::kOk) {
        const bool is_empty = hull.mesh.vertices.empty() && hull.mesh.triangles.empty();
        return is_empty ? "" : std::string("a mesh with status ") + to_string(hull.status);
    }
    if (hull.mesh.empty()) return "no mesh with status ok";
    const auto& vertices = hull.mesh.vertices;
    if (!std::all_of(vertices.begin(), vertices.end(), [](const auto& p) { return p.allFinite(); }))
        return "a vertex is not finite";
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    if (!report.closed) return "the mesh is not closed";
    if (!report.manifold) return "the mesh is not a manifold";
    if (report.num_components != hull.num_components) return "miscounted components";
    return "";
}

bool same_bits(const hull::VisualHull& a, const hull::VisualHull& b) {
    const auto& p = a.mesh.vertices;
    const auto& q = b.mesh.vertices;
    return a.status == b.status && a.mesh.triangles == b.mesh.triangles && p.size() == q.size() &&
           (p.empty() || std::memcmp(p.data(), q.data(), p.size() * sizeof(p[0])) == 0);
}

}  // namespace

std::string check_hull(const HullInput& input) {
    static ThreadPool pool(2);  // creating threads would take longer than most hulls
    SerialExecutor serial;
    hull::HullScratch scratch;
    hull::VisualHull first;
    compute_visual_hull(input.views, input.options, scratch, serial, first);
    const std::string wrong = check_status(first);
    if (!wrong.empty()) return wrong;

    // another input in between, to expose leftovers
    hull::VisualHull again;
    const auto fewer = std::span(input.views).first(input.views.size() - 1);
    compute_visual_hull(fewer, input.options, scratch, serial, again);
    const std::string wrong_with_fewer = check_status(again);
    if (!wrong_with_fewer.empty()) return wrong_with_fewer + ", without the last view";
    compute_visual_hull(input.views, input.options, scratch, serial, again);
    if (!same_bits(first, again)) return "another hull on a used scratch";

    compute_visual_hull(input.views, input.options, scratch, pool, again);
    return same_bits(first, again) ? "" : "another hull with two workers";
}

}  // namespace atrium::test
