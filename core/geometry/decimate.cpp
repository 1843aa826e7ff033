#include "core/geometry/decimate.hpp"

#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/collapse_map.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

namespace atrium::geometry {
namespace {

using Eigen::Vector3d;
using Edge = ClosedMesh::Edge;

constexpr double kMaxCoordinate_m = 1e6;

// Cosine of the largest angle between a new triangle and the one that it replaces (78 degrees):
// prevents flips.
constexpr double kMinCosine = 0.2;

// Flatness (`Shape`) below which a triangle is thin. Only triangles as thin may produce thin ones.
constexpr double kThin = 0.02;

// Below this flatness the normal may be only rounding error.
constexpr double kUnreliable = 1e-6;

// No vertex is merged into one with this many edges: each step visits all of them.
constexpr std::uint32_t kMaxDegree = 64;
static_assert(kMaxDegree > CollapseMap::kMaxRing);

// Orders steps without error by length, shorter first: 1 cm counts as 10 um.
constexpr double kLengthWeight = 1e-6;

/// Area-weighted sum of squared distances to planes: p -> p' A p + 2 b' p + c, relative to the
/// centre of the mesh's bounds.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    double x = 0, y = 0, z = 0, one = 0;
    double weight = 0;

    void add_plane(const Vector3d& n, double d, double w) {
        xx += w * n.x() * n.x();
        xy += w * n.x() * n.y();
        xz += w * n.x() * n.z();
        yy += w * n.y() * n.y();
        yz += w * n.y() * n.z();
        zz += w * n.z() * n.z();
        x += w * n.x() * d;
        y += w * n.y() * d;
        z += w * n.z() * d;
        one += w * d * d;
        weight += w;
    }
    void add(const Quadric& o) {
        xx += o.xx;
        xy += o.xy;
        xz += o.xz;
        yy += o.yy;
        yz += o.yz;
        zz += o.zz;
        x += o.x;
        y += o.y;
        z += o.z;
        one += o.one;
        weight += o.weight;
    }
    double at(const Vector3d& p) const {
        return p.x() * (xx * p.x() + 2.0 * (xy * p.y() + xz * p.z() + x)) +
               p.y() * (yy * p.y() + 2.0 * (yz * p.z() + y)) + p.z() * (zz * p.z() + 2.0 * z) + one;
    }
};

/// The cheapest step of one vertex at its last evaluation.
struct Candidate {
    double cost = 0.0;
    std::uint32_t vertex = 0;
    std::uint32_t version = 0;

    // reversed: the heap has the cheapest on top
    bool operator<(const Candidate& o) const {
        return cost != o.cost ? cost > o.cost : vertex > o.vertex;
    }
};

struct Step {
    double cost = 0.0;
    Edge edge = 0;

    bool operator<(const Step& o) const { return cost != o.cost ? cost < o.cost : edge < o.edge; }
};

struct Shape {
    Vector3d normal = Vector3d::Zero();  // its length is twice the area
    double flatness = 0.0;               // height over the longest side, divided by that side
};

Shape shape_of(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    Shape shape;
    shape.normal = (b - a).cross(c - a);
    const double longest_sq =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    shape.flatness = longest_sq > 0.0 ? shape.normal.norm() / longest_sq : 0.0;
    return shape;
}

}  // namespace

struct DecimateScratch::Data {
    ClosedMesh mesh;
    CollapseMap map;
    std::vector<Quadric> quadrics;        // per vertex
    std::vector<DisplacementBox> moved;   // per triangle
    std::vector<std::uint32_t> versions;  // per vertex, of its candidate
    std::vector<Candidate> queue;
    std::vector<Step> steps;
    // around the vertex to remove, starting at the one that it merges into:
    std::vector<std::uint32_t> ring;       // neighbours
    std::vector<Vector3d> ring_m;          // positions of the neighbours
    std::vector<std::uint32_t> triangles;  // between each neighbour and the next
    std::vector<DisplacementBox> before;   // boxes of these triangles
};

DecimateScratch::DecimateScratch() : data_(std::make_unique<Data>()) {}
DecimateScratch::~DecimateScratch() = default;
DecimateScratch::DecimateScratch(DecimateScratch&&) noexcept = default;
DecimateScratch& DecimateScratch::operator=(DecimateScratch&&) noexcept = default;

namespace {

class Decimator {
public:
    Decimator(const TriangleMesh& in, const DecimateOptions& options, DecimateScratch::Data& data)
        : in_(in),
          options_(options),
          d_(data),
          middle_(in.empty() ? Vector3d::Zero() : bounds(in).centre()) {}

    DecimateReport run() {
        prepare();
        DecimateReport report;
        while (d_.mesh.num_triangles() > options_.target_triangles && !d_.queue.empty()) {
            std::pop_heap(d_.queue.begin(), d_.queue.end());
            const Candidate candidate = d_.queue.back();
            d_.queue.pop_back();
            if (candidate.version != d_.versions[candidate.vertex]) continue;
            report.num_collapses += try_vertex(candidate.vertex) ? 1 : 0;
        }
        report.reached_target = d_.mesh.num_triangles() <= options_.target_triangles;
        for (std::uint32_t t = 0; t < d_.moved.size(); ++t) {
            if (!d_.mesh.has_triangle(t)) continue;
            report.distance_bound_m = std::max(report.distance_bound_m, d_.moved[t].longest_m());
        }
        return report;
    }

private:
    const Vector3d& at(std::uint32_t v) const { return in_.vertices[v]; }

    void prepare() {
        double largest = 0.0;
        for (const Vector3d& p : in_.vertices) largest = std::max(largest, p.cwiseAbs().maxCoeff());
        // a displacement is the difference of two points, each made of a few sums and products
        rounding_m_ = 16.0 * std::numeric_limits<double>::epsilon() * largest;
        d_.moved.assign(in_.triangles.size(), DisplacementBox{});
        d_.quadrics.assign(in_.vertices.size(), Quadric{});
        for (const auto& [a, b, c] : in_.triangles) {
            const Vector3d normal = (at(b) - at(a)).cross(at(c) - at(a));
            const double twice_area = normal.norm();
            if (!(twice_area > 0.0)) continue;
            const Vector3d unit = normal / twice_area;
            Quadric plane;
            plane.add_plane(unit, -unit.dot(at(a) - middle_), twice_area);
            for (const std::uint32_t v : {a, b, c}) d_.quadrics[v].add(plane);
        }
        d_.versions.assign(in_.vertices.size(), 0);
        d_.queue.clear();
        for (std::uint32_t v = 0; v < in_.vertices.size(); ++v) look_at(v);
        std::make_heap(d_.queue.begin(), d_.queue.end());
    }

    double cost_of(Edge e) const {
        const Vector3d p = at(d_.mesh.to(e)) - middle_;
        const Quadric& from = d_.quadrics[d_.mesh.from(e)];
        const Quadric& to = d_.quadrics[d_.mesh.to(e)];
        const double length_sq = (at(d_.mesh.to(e)) - at(d_.mesh.from(e))).squaredNorm();
        return std::max(from.at(p) + to.at(p), 0.0) +
               kLengthWeight * (from.weight + to.weight) * length_sq;
    }

    // Appends the cheapest step of `v` to the queue and invalidates its earlier entries. Returns
    // false if `v` has too many neighbours to be removed.
    bool look_at(std::uint32_t v) {
        ++d_.versions[v];
        if (!find_steps(v)) return false;
        const double cheapest = std::min_element(d_.steps.begin(), d_.steps.end())->cost;
        d_.queue.push_back({cheapest, v, d_.versions[v]});
        return true;
    }

    bool find_steps(std::uint32_t v) {
        d_.steps.clear();
        const Edge begin = d_.mesh.edge_at(v);
        Edge e = begin;
        do {
            if (d_.steps.size() == CollapseMap::kMaxRing) return false;
            d_.steps.push_back({cost_of(e), e});
            e = d_.mesh.turned(e);
        } while (e != begin);
        return true;
    }

    bool try_vertex(std::uint32_t v) {
        if (!find_steps(v)) return false;
        std::sort(d_.steps.begin(), d_.steps.end());
        return std::any_of(d_.steps.begin(), d_.steps.end(), [&](const Step& step) {
            if (!d_.mesh.can_collapse(step.edge, kMaxDegree)) return false;
            collect_ring(step.edge);
            if (!keeps_shape(at(v))) return false;
            if (!d_.map.bound(at(v), d_.ring_m, d_.before, options_.max_distance_m, rounding_m_))
                return false;
            collapse(step.edge);
            return true;
        });
    }

    void collect_ring(Edge e) {
        d_.ring.clear();
        d_.ring_m.clear();
        d_.triangles.clear();
        d_.before.clear();
        Edge spoke = e;
        do {
            d_.ring.push_back(d_.mesh.to(spoke));
            d_.ring_m.push_back(at(d_.ring.back()));
            d_.triangles.push_back(ClosedMesh::triangle_of(spoke));
            d_.before.push_back(d_.moved[d_.triangles.back()]);
            spoke = d_.mesh.turned(spoke);
        } while (spoke != e);
    }

    // True if no new triangle is flipped or thinner than the old ones.
    bool keeps_shape(const Vector3d& u) const {
        const std::vector<Vector3d>& w = d_.ring_m;
        Vector3d sum = Vector3d::Zero();
        double flattest = kThin;
        for (std::size_t i = 0; i < w.size(); ++i) {
            const Shape old = shape_of(u, w[i], w[(i + 1) % w.size()]);
            sum += old.normal;
            flattest = std::min(flattest, old.flatness);
        }
        for (std::size_t i = 1; i + 1 < w.size(); ++i) {
            const Shape now = shape_of(w[0], w[i], w[i + 1]);
            if (!(now.flatness >= flattest) || now.flatness == 0.0) return false;
            const Shape old = shape_of(u, w[i], w[i + 1]);
            const Vector3d& reference = old.flatness > kUnreliable ? old.normal : sum;
            if (!(now.normal.dot(reference) >= kMinCosine * now.normal.norm() * reference.norm()))
                return false;
        }
        return true;
    }

    void collapse(Edge e) {
        const std::uint32_t gone = d_.mesh.from(e);
        const std::uint32_t kept = d_.mesh.to(e);
        d_.mesh.collapse(e);
        for (std::size_t i = 1; i + 1 < d_.ring.size(); ++i)
            d_.moved[d_.triangles[i]] = d_.map.after()[i - 1];
        d_.quadrics[kept].add(d_.quadrics[gone]);
        for (const std::uint32_t v : d_.ring) {
            if (look_at(v)) std::push_heap(d_.queue.begin(), d_.queue.end());
        }
    }

    const TriangleMesh& in_;
    const DecimateOptions& options_;
    DecimateScratch::Data& d_;
    Vector3d middle_;
    double rounding_m_ = 0.0;
};

Expected<void> check_positions(const TriangleMesh& mesh) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (mesh.vertices[v].cwiseAbs().maxCoeff() <= kMaxCoordinate_m &&
            mesh.vertices[v].allFinite())
            continue;
        return make_error(
            ErrorKind::kInvalidData,
            "mesh: vertex " + std::to_string(v) + " needs finite coordinates below 1000 km");
    }
    return {};
}

}  // namespace

Expected<DecimateReport> decimate(const TriangleMesh& in,
                                  const DecimateOptions& options,
                                  DecimateScratch& scratch,
                                  TriangleMesh& out) {
    assert(&in != &out);
    out.clear();
    if (!(options.max_distance_m >= 0.0 && std::isfinite(options.max_distance_m))) {
        return make_error(ErrorKind::kConfiguration,
                          "max_distance_m: must be finite and not negative");
    }
    if (auto checked = check_positions(in); !checked) return tl::unexpected(checked.error());
    DecimateScratch::Data& data = scratch.data();
    if (auto assigned = data.mesh.assign(in); !assigned) return tl::unexpected(assigned.error());
    const DecimateReport report = Decimator(in, options, data).run();
    data.mesh.extract(in.vertices, out);
    return report;
}

}  // namespace atrium::geometry
