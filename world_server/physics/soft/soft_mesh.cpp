#include "world_server/physics/soft/soft_mesh.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace atrium::physics {
namespace {

using Index = std::uint32_t;
using Triangle = std::array<Index, 3>;

constexpr double kUneven_m = 0.0001;

Index num_cuts(double extent_m, double spacing_m) {
    return static_cast<Index>(std::max(1L, std::lround(extent_m / spacing_m)));
}

// Subdivisions of an icosahedron's edge for nodes about `spacing_m` apart. An edge is 1.05 radii
// long and grows by 1.1 when projected onto the sphere.
Index ball_cuts(const SoftObject& object) {
    const double radius_m = object.size_m.mean() / 2.0;
    return static_cast<Index>(std::max(2L, std::lround(1.15 * radius_m / object.spacing_m)));
}

Eigen::Array<Index, 3, 1> box_cuts(const SoftObject& object) {
    Eigen::Array<Index, 3, 1> cuts;
    for (int i = 0; i < 3; ++i) {
        cuts[i] = std::max<Index>(2, num_cuts(object.size_m[i], object.spacing_m));
    }
    return cuts;
}

// Length of a parabola with end points `span_m` apart.
double parabola_length(double span_m, double sag_m) {
    const int steps = 200;
    double length_m = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double slope = 8.0 * sag_m / span_m * ((i + 0.5) / steps - 0.5);
        length_m += span_m / steps * std::sqrt(1.0 + slope * slope);
    }
    return length_m;
}

// Places every `length_m / num_parts` along a parabola of this length between two points `span_m`
// apart, on which a rope or cloth hangs: [m] along x from the middle, and along y or z. Bisection
// finds its sag.
std::vector<Eigen::Vector2d> hang(double length_m, double span_m, Index num_parts) {
    double low = 0.0, high = length_m;
    for (int i = 0; i < 50; ++i) {
        const double sag = 0.5 * (low + high);
        (parabola_length(span_m, sag) < length_m ? low : high) = sag;
    }
    // walk along a fine polyline
    const int steps = 100 * static_cast<int>(num_parts);
    const auto at = [&](double t) {
        return Eigen::Vector2d(span_m * (t - 0.5), -4.0 * low * t * (1.0 - t));
    };
    std::vector<Eigen::Vector2d> places{at(0.0)};
    double walked_m = 0.0;
    for (int i = 1; i <= steps && places.size() < num_parts; ++i) {
        walked_m += (at(double(i) / steps) - at(double(i - 1) / steps)).norm();
        if (walked_m >= static_cast<double>(places.size()) * length_m / num_parts)
            places.push_back(at(double(i) / steps));
    }
    places.push_back(at(1.0));
    return places;
}

// Waves that repeat nowhere on the cloth, so that folds of any size find a beginning [m].
double unevenness_m(double u, double v) {
    return kUneven_m * (std::sin(7.1 * u + 0.4) + std::sin(11.3 * v - 3.7 * u + 1.1));
}

// Columns of nodes are where the width hangs.
void start_cloth(const SoftObject& object, Index nx, SoftMesh& mesh) {
    std::vector<Eigen::Vector2d> columns;
    if (object.span_m) columns = hang(object.size_m.x(), *object.span_m, nx);
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        Eigen::Vector3d place_m = mesh.nodes[i];
        const double u = place_m.x() / object.size_m.x(), v = place_m.z() / object.size_m.y();
        if (object.span_m) place_m.head<2>() = columns[i % columns.size()];
        place_m.y() += unevenness_m(u, v);
        mesh.starts.push_back(place_m);
    }
}

void make_cloth(const SoftObject& object, SoftMesh& mesh) {
    const Index nx = num_cuts(object.size_m.x(), object.spacing_m);
    const Index nz = num_cuts(object.size_m.y(), object.spacing_m);
    const auto node = [&](Index x, Index z) { return z * (nx + 1) + x; };
    for (Index z = 0; z <= nz; ++z) {
        for (Index x = 0; x <= nx; ++x) {
            mesh.nodes.emplace_back(object.size_m.x() * (double(x) / nx - 0.5),
                                    0.0,
                                    object.size_m.y() * (0.5 - double(z) / nz));
        }
    }
    start_cloth(object, nx, mesh);
    // from the top down: one pass over the links carries a pull at the top to the hem
    for (Index z = 0; z <= nz; ++z) {
        for (Index x = 0; x <= nx; ++x) {
            if (x < nx) mesh.links.push_back({{node(x, z), node(x + 1, z)}});
            if (z == nz) continue;
            mesh.links.push_back({{node(x, z), node(x, z + 1)}});
            if (x == nx) continue;
            const bool falls = (x + z) % 2 == 0;  // direction of this square's diagonal
            const Index a = node(x, z), b = node(x + 1, z), c = node(x, z + 1),
                        d = node(x + 1, z + 1);
            if (falls) {
                mesh.topology.triangles.push_back({a, d, b});
                mesh.topology.triangles.push_back({a, c, d});
                mesh.links.push_back({{a, d}});
            } else {
                mesh.topology.triangles.push_back({a, c, b});
                mesh.topology.triangles.push_back({b, c, d});
                mesh.links.push_back({{b, c}});
            }
        }
    }
    for (Index z = 0; z <= nz; ++z) {
        for (Index x = 0; x <= nx; ++x) {
            if (x + 2 <= nx) mesh.links.push_back({{node(x, z), node(x + 2, z)}, true});
            if (z + 2 <= nz) mesh.links.push_back({{node(x, z), node(x, z + 2)}, true});
        }
    }
}

void make_rope(const SoftObject& object, SoftMesh& mesh) {
    const double length_m = object.size_m.x();
    const Index n = std::max<Index>(2, num_cuts(length_m, object.spacing_m));
    for (const Eigen::Vector2d& place : hang(length_m, object.size_m.z(), n))
        mesh.nodes.emplace_back(place.x(), 0.0, place.y());
    for (Index i = 0; i + 1 < mesh.nodes.size(); ++i) {
        mesh.links.push_back({{i, i + 1}});
        mesh.topology.segments.push_back({i, i + 1});
    }
    for (Index i = 0; i + 2 < mesh.nodes.size(); ++i) mesh.links.push_back({{i, i + 2}, true});
    mesh.topology.radius_m = object.size_m.y() / 2.0;
}

// Unit icosahedron, faces counter-clockwise from outside.
struct Icosahedron {
    std::array<Eigen::Vector3d, 12> corners;
    std::vector<Triangle> faces;
};

Icosahedron make_icosahedron() {
    Icosahedron ico;
    const double g = std::numbers::phi;
    std::size_t i = 0;
    for (const double a : {-1.0, 1.0}) {
        for (const double b : {-g, g}) {
            ico.corners[i++] = Eigen::Vector3d(0, a, b).normalized();
            ico.corners[i++] = Eigen::Vector3d(a, b, 0).normalized();
            ico.corners[i++] = Eigen::Vector3d(b, 0, a).normalized();
        }
    }
    // three mutually nearest corners form a face
    const double edge_sq = 2.0 * 2.0 / (g * g + 1.0) * 1.0;
    const auto is_edge = [&](Index a, Index b) {
        return (ico.corners[a] - ico.corners[b]).squaredNorm() < edge_sq * 1.01;
    };
    for (Index a = 0; a < 12; ++a) {
        for (Index b = a + 1; b < 12; ++b) {
            for (Index c = b + 1; c < 12; ++c) {
                if (!is_edge(a, b) || !is_edge(b, c) || !is_edge(a, c)) continue;
                const Eigen::Vector3d n =
                    (ico.corners[b] - ico.corners[a]).cross(ico.corners[c] - ico.corners[a]);
                if (n.dot(ico.corners[a]) > 0.0) {
                    ico.faces.push_back({a, b, c});
                } else {
                    ico.faces.push_back({a, c, b});
                }
            }
        }
    }
    assert(ico.faces.size() == 20);
    return ico;
}

// Returns one node per place, for all faces that share it.
class NodeAt {
public:
    explicit NodeAt(SoftMesh& mesh) : mesh_(mesh) {}
    Index operator()(const Eigen::Vector3d& p) {
        const Eigen::Vector3d rounded = (p * 1e6).array().round();
        const auto [it, is_new] =
            index_.try_emplace({rounded.x(), rounded.y(), rounded.z()}, Index(mesh_.nodes.size()));
        if (is_new) mesh_.nodes.push_back(p);
        return it->second;
    }

private:
    SoftMesh& mesh_;
    std::map<std::array<double, 3>, Index> index_;
};

void make_ball(const SoftObject& object, SoftMesh& mesh) {
    const Index n = ball_cuts(object);
    const Icosahedron ico = make_icosahedron();
    NodeAt node_at(mesh);
    for (const Triangle& face : ico.faces) {
        const auto corner = [&](Index i, Index j) {
            const Eigen::Vector3d flat =
                (double(n - i - j) * ico.corners[face[0]] + double(i) * ico.corners[face[1]] +
                 double(j) * ico.corners[face[2]]) /
                n;
            return node_at(0.5 * flat.normalized().cwiseProduct(object.size_m));
        };
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; i + j < n; ++j) {
                mesh.topology.triangles.push_back(
                    {corner(i, j), corner(i + 1, j), corner(i, j + 1)});
                if (i + j + 2 > n) continue;
                mesh.topology.triangles.push_back(
                    {corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
            }
        }
    }
}

void make_box(const SoftObject& object, SoftMesh& mesh) {
    const auto cuts = box_cuts(object);
    NodeAt node_at(mesh);
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const double side : {-0.5, 0.5}) {
            const auto at = [&](Index i, Index j) {
                Eigen::Vector3d p;
                p[axis] = side;
                p[u] = double(i) / cuts[u] - 0.5;
                p[v] = double(j) / cuts[v] - 0.5;
                return node_at(p.cwiseProduct(object.size_m));
            };
            for (Index i = 0; i < cuts[u]; ++i) {
                for (Index j = 0; j < cuts[v]; ++j) {
                    const Index a = at(i, j), b = at(i + 1, j), c = at(i, j + 1),
                                d = at(i + 1, j + 1);
                    if (side > 0.0) {
                        mesh.topology.triangles.push_back({a, b, d});
                        mesh.topology.triangles.push_back({a, d, c});
                    } else {
                        mesh.topology.triangles.push_back({a, d, b});
                        mesh.topology.triangles.push_back({a, c, d});
                    }
                }
            }
        }
    }
}

void link_edges(SoftMesh& mesh) {
    std::set<std::array<Index, 2>> edges;
    for (const Triangle& t : mesh.topology.triangles) {
        for (int i = 0; i < 3; ++i) {
            const Index a = t[static_cast<std::size_t>(i)];
            const Index b = t[static_cast<std::size_t>((i + 1) % 3)];
            edges.insert({std::min(a, b), std::max(a, b)});
        }
    }
    for (const auto& edge : edges) mesh.links.push_back({edge});
}

// Distributes the mass by the area or length around each node.
void share_mass(SoftMesh& mesh) {
    mesh.shares.assign(mesh.nodes.size(), 0.0);
    const auto& p = mesh.nodes;
    for (const Triangle& t : mesh.topology.triangles) {
        const double area = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm();
        for (const Index i : t) mesh.shares[i] += area;
    }
    for (const auto& s : mesh.topology.segments) {
        for (const Index i : s) mesh.shares[i] += (p[s[1]] - p[s[0]]).norm();
    }
    double sum = 0.0;
    for (const double share : mesh.shares) sum += share;
    // very light nodes would be thrown about by contacts
    const double least = 0.2 * sum / static_cast<double>(mesh.nodes.size());
    sum = 0.0;
    for (double& share : mesh.shares) sum += share = std::max(share, least);
    for (double& share : mesh.shares) share /= sum;
}

}  // namespace

std::size_t count_soft_nodes(const SoftObject& object) {
    const Eigen::Vector3d& s = object.size_m;
    switch (object.shape) {
        case SoftShape::kCloth:
            return (std::size_t(num_cuts(s.x(), object.spacing_m)) + 1) *
                   (std::size_t(num_cuts(s.y(), object.spacing_m)) + 1);
        case SoftShape::kRope:
            return std::size_t(std::max<Index>(2, num_cuts(s.x(), object.spacing_m))) + 1;
        case SoftShape::kBall: {
            const std::size_t n = ball_cuts(object);
            return 10 * n * n + 2;
        }
        case SoftShape::kBox: {
            const Eigen::Array<std::size_t, 3, 1> n = box_cuts(object).cast<std::size_t>();
            return (n + 1).prod() - (n - 1).prod();
        }
        case SoftShape::kModel:
            break;
    }
    return object.model.vertices.size();
}

SoftMesh make_soft_mesh(const SoftObject& object) {
    SoftMesh mesh;
    switch (object.shape) {
        case SoftShape::kCloth:
            make_cloth(object, mesh);
            break;
        case SoftShape::kRope:
            make_rope(object, mesh);
            break;
        case SoftShape::kBall:
            make_ball(object, mesh);
            break;
        case SoftShape::kBox:
            make_box(object, mesh);
            break;
        case SoftShape::kModel:
            mesh.nodes = object.model.vertices;
            mesh.topology.triangles = object.model.triangles;
            break;
    }
    if (mesh.links.empty()) link_edges(mesh);
    if (mesh.starts.empty()) mesh.starts = mesh.nodes;
    share_mass(mesh);
    return mesh;
}

Eigen::Vector3d start_of_node(const SoftObject& object, const SoftMesh& mesh, std::size_t node) {
    if (!object.start_nodes.empty()) return object.start_nodes[node].cast<double>();
    return object.world_from_object * mesh.starts[node];
}

std::vector<std::uint32_t> nodes_at(const SoftMesh& mesh,
                                    const SoftObject& object,
                                    const SoftPin& pin) {
    std::vector<std::uint32_t> found;
    if (pin.place == PinPlace::kPoint) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < mesh.nodes.size(); ++i) {
            if ((mesh.nodes[i] - pin.point).squaredNorm() <
                (mesh.nodes[best] - pin.point).squaredNorm()) {
                best = i;
            }
        }
        return {static_cast<std::uint32_t>(best)};
    }
    const bool is_rope = object.shape == SoftShape::kRope;
    const double x = (is_rope ? object.size_m.z() : object.size_m.x()) / 2.0;
    const double z = object.size_m.y() / 2.0;
    const double near_m = 0.01 * object.spacing_m;
    for (std::uint32_t i = 0; i < mesh.nodes.size(); ++i) {
        const Eigen::Vector3d& p = mesh.nodes[i];
        const bool left = p.x()<-x + near_m, right = p.x()> x - near_m;
        const bool top = p.z() > z - near_m, bottom = p.z() < -z + near_m;
        const bool holds =
            (pin.place == PinPlace::kTop && top) || (pin.place == PinPlace::kBottom && bottom) ||
            (pin.place == PinPlace::kLeft && left) || (pin.place == PinPlace::kRight && right) ||
            (pin.place == PinPlace::kTopCorners && top && (left || right)) ||
            (pin.place == PinPlace::kCorners && (top || bottom) && (left || right));
        if (holds) found.push_back(i);
    }
    // a rope may extend beyond its ends; its ends are its first and last node
    if (is_rope && pin.place == PinPlace::kLeft) found = {0};
    if (is_rope && pin.place == PinPlace::kRight) found = {std::uint32_t(mesh.nodes.size() - 1)};
    return found;
}

}  // namespace atrium::physics
