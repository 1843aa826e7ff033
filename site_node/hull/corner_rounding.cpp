#include "site_node/hull/corner_rounding.hpp"

#include "site_node/hull/face_owner.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace atrium::hull {
namespace {

constexpr double kAlongRay = 2e-4;       // sine between a viewing edge and its ray
constexpr double kRounding_m = 1e-6;     // of vertices
constexpr double kShortest_m = 1e-4;     // shorter edges have no direction
constexpr double kPlane_m = 1e-5;        // thickness of a planar face
constexpr double kLeastGain_m = 1e-4;    // for the exchange of a diagonal
constexpr double kLeastArea_m2 = 1e-12;  // of a triangle, twice
constexpr double kMostOfReach = 0.95;    // a thin wedge keeps a tip
constexpr double kLeastInwards = 0.05;   // cosine between a move and each face's inside
constexpr double kSmoothCosine = 0.999;  // faces that bend less form no concave corner
constexpr int kGuesses = 4;              // turns in which unknown reaches spread
constexpr int kHalvings = 3;
constexpr int kSmoothings = 2;
constexpr int kExchanges = 4;  // turns; a strip has few ends

}  // namespace

CornerRounding::Meeting* CornerRounding::Corner::of(std::int32_t camera) {
    for (std::uint32_t i = 0; i < num; ++i)
        if (meetings[i].camera == camera) return &meetings[i];
    return nullptr;
}

// Lists the edges by their lower vertex. False unless each has two triangles in opposite
// directions.
bool CornerRounding::join_edges(const geometry::TriangleMesh& mesh) {
    const auto num_vertices = static_cast<std::uint32_t>(mesh.vertices.size());
    const auto num_faces = static_cast<std::uint32_t>(mesh.triangles.size());
    first_half_.assign(num_vertices + 1, 0);
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t low = std::min(triangle[k], triangle[(k + 1) % 3]);
            if (triangle[k] >= num_vertices || triangle[k] == triangle[(k + 1) % 3]) return false;
            ++first_half_[low + 1];
        }
    }
    for (std::uint32_t v = 0; v < num_vertices; ++v) first_half_[v + 1] += first_half_[v];
    half_edges_.resize(3 * std::size_t{num_faces});
    first_edge_.assign(first_half_.begin(), first_half_.end());
    for (std::uint32_t f = 0; f < num_faces; ++f) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t from = mesh.triangles[f][k];
            const std::uint32_t to = mesh.triangles[f][(k + 1) % 3];
            half_edges_[first_edge_[std::min(from, to)]++] = {std::max(from, to), f, k, from < to};
        }
    }
    edges_.clear();
    edges_of_face_.resize(num_faces);
    for (std::uint32_t v = 0; v < num_vertices; ++v) {
        first_edge_[v] = static_cast<std::uint32_t>(edges_.size());
        for (std::uint32_t h = first_half_[v]; h < first_half_[v + 1]; ++h) {
            const HalfEdge& half = half_edges_[h];
            std::uint32_t e = first_edge_[v];
            while (e < edges_.size() && edges_[e].b != half.other) ++e;
            if (e == edges_.size()) {
                edges_.push_back({v, half.other, {half.face, kNone}, half.leaves_low});
            } else {
                Edge& edge = edges_[e];
                if (edge.faces[1] != kNone || edge.first_leaves_a == half.leaves_low) return false;
                edge.faces[1] = half.face;
            }
            edges_of_face_[half.face][half.side] = e;
        }
    }
    first_edge_[num_vertices] = static_cast<std::uint32_t>(edges_.size());
    return std::ranges::none_of(edges_, [](const Edge& edge) { return edge.faces[1] == kNone; });
}

// The plane of a face goes through the camera whose outline made it.
void CornerRounding::find_owners(const geometry::TriangleMesh& mesh) {
    faces_.resize(mesh.triangles.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        const auto& [a, b, c] = mesh.triangles[f];
        const Eigen::Vector3d& corner = mesh.vertices[a];
        const Eigen::Vector3d cross = (mesh.vertices[b] - corner).cross(mesh.vertices[c] - corner);
        const double area = cross.norm();
        Face& face = faces_[f];
        face = {
            area > 0.0 ? Eigen::Vector3d(cross / area) : Eigen::Vector3d::Zero(), area, kNobody};
        if (!(area > kLeastArea_m2)) continue;
        face.owner = face_owner(corner, face.normal, centres_site_);
    }
}

bool CornerRounding::is_viewing_edge(std::uint32_t a,
                                     std::uint32_t b,
                                     std::int32_t camera,
                                     const geometry::TriangleMesh& mesh) const {
    if (camera == kNobody) return false;
    const Eigen::Vector3d along = mesh.vertices[b] - mesh.vertices[a];
    const double length = along.norm();
    const Eigen::Vector3d ray =
        (mesh.vertices[a] - centres_site_[static_cast<std::size_t>(camera)]).normalized();
    return length > kShortest_m && along.cross(ray).norm() < kAlongRay * length + kRounding_m;
}

// Finds which cameras meet at each vertex, and how far the middles of their viewing edges are.
void CornerRounding::find_corners(const geometry::TriangleMesh& mesh) {
    corners_.assign(mesh.vertices.size(), {});
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        const Face& face = faces_[f];
        for (const std::uint32_t v : mesh.triangles[f]) {
            Corner& corner = corners_[v];
            // too thin to tell whose it is; its neighbours know
            if (!(face.doubled_area_m2 > kLeastArea_m2)) continue;
            Meeting* meeting = corner.of(face.owner);
            if (face.owner == kNobody || (meeting == nullptr && corner.num == 4)) {
                corner.stays = true;
                continue;
            }
            if (meeting == nullptr) {
                meeting = &corner.meetings[corner.num++];
                meeting->camera = face.owner;
            }
            meeting->normal += face.doubled_area_m2 * face.normal;
        }
    }
    is_viewing_.assign(edges_.size(), 0);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const Edge& edge = edges_[e];
        const std::array<std::int32_t, 2> owners{faces_[edge.faces[0]].owner,
                                                 faces_[edge.faces[1]].owner};
        for (const std::int32_t camera : owners) {
            if (!is_viewing_edge(edge.a, edge.b, camera, mesh)) continue;
            is_viewing_[e] = 1;
            const double half_m = 0.5 * (mesh.vertices[edge.b] - mesh.vertices[edge.a]).norm();
            for (const std::uint32_t v : {edge.a, edge.b})
                if (Meeting* meeting = corners_[v].of(camera))
                    meeting->reach_m = std::max(meeting->reach_m, half_m);
            break;
        }
        if (owners[0] == owners[1]) continue;
        const Face& face = faces_[edge.faces[0]];
        if (face.normal.dot(faces_[edge.faces[1]].normal) > kSmoothCosine) continue;
        for (const std::uint32_t v : mesh.triangles[edge.faces[1]]) {
            const double above_m = face.normal.dot(mesh.vertices[v] - mesh.vertices[edge.a]);
            if (v == edge.a || v == edge.b || !(above_m > kRounding_m)) continue;
            corners_[edge.a].stays = corners_[edge.b].stays = true;
        }
    }
}

// Viewing edges of a camera end at corners only on one of the two faces: the other corners between
// the same cameras tell.
void CornerRounding::guess_reaches() {
    for (int turn = 0; turn < kGuesses; ++turn) {
        reach_sums_.assign(corners_.size(), {});
        reach_counts_.assign(corners_.size(), {});
        for (const Edge& edge : edges_) {
            if (faces_[edge.faces[0]].owner == faces_[edge.faces[1]].owner) continue;
            for (const auto& [to, from] : {std::pair{edge.a, edge.b}, {edge.b, edge.a}}) {
                for (std::uint32_t i = 0; i < corners_[to].num; ++i) {
                    if (corners_[to].meetings[i].reach_m >= 0.0) continue;
                    const Meeting* known = corners_[from].of(corners_[to].meetings[i].camera);
                    if (known == nullptr || known->reach_m < 0.0) continue;
                    reach_sums_[to][i] += known->reach_m;
                    ++reach_counts_[to][i];
                }
            }
        }
        for (std::size_t v = 0; v < corners_.size(); ++v)
            for (std::uint32_t i = 0; i < corners_[v].num; ++i)
                if (reach_counts_[v][i] > 0)
                    corners_[v].meetings[i].reach_m = reach_sums_[v][i] / reach_counts_[v][i];
    }
}

void CornerRounding::find_moves(const geometry::TriangleMesh& mesh) {
    const std::size_t num_vertices = mesh.vertices.size();
    moves_m_.assign(num_vertices, 0.0);
    inwards_.assign(num_vertices, Eigen::Vector3d::Zero());
    for (std::size_t v = 0; v < num_vertices; ++v) {
        Corner& corner = corners_[v];
        if (corner.stays || corner.num < 2) continue;
        double reach_m = options_.most_reach_m;
        double cosine = 1.0;
        Eigen::Vector3d outwards = Eigen::Vector3d::Zero();
        for (std::uint32_t i = 0; i < corner.num; ++i) {
            Meeting& meeting = corner.meetings[i];
            reach_m = std::min(reach_m, meeting.reach_m);
            meeting.normal.normalize();
            outwards += meeting.normal;
            for (std::uint32_t k = 0; k < i; ++k)
                cosine = std::min(cosine, meeting.normal.dot(corner.meetings[k].normal));
        }
        const double length = outwards.norm();
        if (reach_m <= 0.0 || !(length > 1e-3)) continue;
        const double outer_angle = std::acos(std::clamp(cosine, -1.0, 1.0));
        moves_m_[v] = reach_m * std::min(kMostOfReach, std::tan(outer_angle / 4.0));
        inwards_[v] = -outwards / length;
    }
    // at the tip of an outline, inwards for two cameras may be outwards for one of the faces
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        if (!(faces_[f].doubled_area_m2 > kLeastArea_m2)) continue;
        for (const std::uint32_t v : mesh.triangles[f])
            if (faces_[f].normal.dot(inwards_[v]) > -kLeastInwards) moves_m_[v] = 0.0;
    }
}

// Along the lines where cones meet. No corner moves farther than its own viewing edges allow.
void CornerRounding::smooth_moves() {
    for (int turn = 0; turn < kSmoothings; ++turn) {
        before_m_ = moves_m_;
        num_summed_.assign(moves_m_.size(), 1);
        for (const Edge& edge : edges_) {
            if (faces_[edge.faces[0]].owner == faces_[edge.faces[1]].owner) continue;
            moves_m_[edge.a] += before_m_[edge.b];
            moves_m_[edge.b] += before_m_[edge.a];
            ++num_summed_[edge.a];
            ++num_summed_[edge.b];
        }
        for (std::size_t v = 0; v < moves_m_.size(); ++v)
            moves_m_[v] = std::min(before_m_[v], moves_m_[v] / num_summed_[v]);
    }
    for (double& move_m : moves_m_)
        if (move_m < options_.least_m) move_m = 0.0;
}

// Gives the viewing edges whose ends move a vertex in the middle, which stays.
void CornerRounding::split_viewing_edges(geometry::TriangleMesh& mesh) {
    middles_.assign(edges_.size(), kNone);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const Edge& edge = edges_[e];
        if (is_viewing_[e] == 0 || !(std::max(moves_m_[edge.a], moves_m_[edge.b]) > 0.0)) continue;
        middles_[e] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(0.5 * (mesh.vertices[edge.a] + mesh.vertices[edge.b]));
        moves_m_.push_back(0.0);
        inwards_.push_back(Eigen::Vector3d::Zero());
    }
    triangles_.clear();
    owners_.clear();
    const auto add = [&](std::size_t face, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        triangles_.push_back({a, b, c});
        owners_.push_back(faces_[face].owner);
    };
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        const auto corner = mesh.triangles[f];
        std::array<std::uint32_t, 3> middle;
        for (std::size_t k = 0; k < 3; ++k) middle[k] = middles_[edges_of_face_[f][k]];
        const auto num = 3 - std::ranges::count(middle, kNone);
        if (num == 0) add(f, corner[0], corner[1], corner[2]);
        if (num == 3) {
            for (std::size_t k = 0; k < 3; ++k) add(f, corner[k], middle[k], middle[(k + 2) % 3]);
            add(f, middle[0], middle[1], middle[2]);
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = corner[k], b = corner[(k + 1) % 3], c = corner[(k + 2) % 3];
            const std::uint32_t ab = middle[k], bc = middle[(k + 1) % 3];
            if (num == 1 && ab != kNone) {
                add(f, a, ab, c);
                add(f, ab, b, c);
            }
            if (num == 2 && middle[(k + 2) % 3] == kNone) {
                add(f, ab, b, bc);
                add(f, a, ab, bc);
                add(f, a, bc, c);
            }
        }
    }
    mesh.triangles.swap(triangles_);
}

// Finds for each half-edge the one in the opposite direction. Half-edge 3 f + k goes from corner k
// of triangle f to the next.
void CornerRounding::find_twins(const geometry::TriangleMesh& mesh) {
    join_edges(mesh);
    twins_.resize(3 * mesh.triangles.size());
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
        std::array<std::uint32_t, 2> sides{};
        for (std::size_t i = 0; i < 2; ++i)
            while (edges_of_face_[edges_[e].faces[i]][sides[i]] != e) ++sides[i];
        const std::uint32_t one = 3 * edges_[e].faces[0] + sides[0];
        const std::uint32_t other = 3 * edges_[e].faces[1] + sides[1];
        twins_[one] = other;
        twins_[other] = one;
    }
}

// Whether an edge joins the half-edge's first corner to `corner`.
bool CornerRounding::is_joined(std::uint32_t half_edge,
                               std::uint32_t corner,
                               const geometry::TriangleMesh& mesh) const {
    std::uint32_t h = half_edge;
    do {
        if (mesh.triangles[h / 3][(h + 1) % 3] == corner) return true;
        h = twins_[before(h)];
    } while (h != half_edge);
    return false;
}

// Exchanges the edge if it is a diagonal of a planar face and the other one lies farther out once
// the corners have moved.
bool CornerRounding::exchange(std::uint32_t half_edge, geometry::TriangleMesh& mesh) {
    const std::uint32_t twin = twins_[half_edge];
    const std::uint32_t f = half_edge / 3, g = twin / 3;
    if (owners_[f] != owners_[g] || owners_[f] == kNobody) return false;
    const auto from = [&](std::uint32_t h) { return mesh.triangles[h / 3][h % 3]; };
    const std::uint32_t x = from(half_edge), y = from(twin);
    const std::uint32_t r = from(before(half_edge)), s = from(before(twin));
    if (!(moves_m_[x] + moves_m_[y] > moves_m_[r] + moves_m_[s] + kLeastGain_m)) return false;
    const auto& p = mesh.vertices;
    const Eigen::Vector3d normal = (p[x] - p[r]).cross(p[y] - p[r]).normalized();
    if (!(std::abs(normal.dot(p[s] - p[r])) < kPlane_m)) return false;
    const double area_x = (p[x] - p[r]).cross(p[s] - p[r]).dot(normal);
    const double area_y = (p[s] - p[r]).cross(p[y] - p[r]).dot(normal);
    if (!(area_x > kLeastArea_m2 && area_y > kLeastArea_m2)) return false;
    if (is_viewing_edge(x, y, owners_[f], mesh) || is_joined(before(half_edge), s, mesh))
        return false;
    const std::array<std::uint32_t, 6> around{twins_[before(half_edge)],
                                              twins_[after(twin)],
                                              3 * g + 2,
                                              twins_[before(twin)],
                                              twins_[after(half_edge)],
                                              3 * f + 2};
    mesh.triangles[f] = {r, x, s};
    mesh.triangles[g] = {s, y, r};
    for (std::uint32_t k = 0; k < 3; ++k) {
        twins_[3 * f + k] = around[k];
        twins_[around[k]] = 3 * f + k;
        twins_[3 * g + k] = around[3 + k];
        twins_[around[3 + k]] = 3 * g + k;
    }
    return true;
}

void CornerRounding::exchange_diagonals(geometry::TriangleMesh& mesh) {
    find_twins(mesh);
    for (int turn = 0; turn < kExchanges; ++turn) {
        bool is_done = true;
        for (std::uint32_t h = 0; h < twins_.size(); ++h)
            if (h < twins_[h] && exchange(h, mesh)) is_done = false;
        if (is_done) return;
    }
}

// Where the body is thinner than its viewing edges say, a corner would come out at the other side.
void CornerRounding::move_corners(geometry::TriangleMesh& mesh,
                                  std::span<const SilhouetteView* const> views) {
    inside_.assign(views);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        double move_m = moves_m_[v];
        // twice as far, so that half of the body is left
        for (int turn = 0; move_m > 0.0 && turn <= kHalvings; ++turn) {
            const auto is_inside_at = [&](double distance_m) {
                return inside_.contains(mesh.vertices[v] + distance_m * inwards_[v]);
            };
            if (is_inside_at(move_m) && is_inside_at(2.0 * move_m)) break;
            move_m = turn < kHalvings ? 0.5 * move_m : 0.0;
        }
        mesh.vertices[v] += move_m * inwards_[v];
    }
}

bool CornerRounding::round(geometry::TriangleMesh& mesh,
                           std::span<const SilhouetteView* const> views) {
    if (!join_edges(mesh)) return false;
    centres_site_.clear();
    for (const SilhouetteView* view : views)
        if (view != nullptr) centres_site_.push_back(view->camera_from_site.inverse().translation);
    find_owners(mesh);
    find_corners(mesh);
    guess_reaches();
    find_moves(mesh);
    smooth_moves();
    split_viewing_edges(mesh);
    exchange_diagonals(mesh);
    move_corners(mesh, views);
    return true;
}

}  // namespace atrium::hull
