#include "site_node/refine/photo_refinement.hpp"

#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::refine {
namespace {

constexpr std::size_t kFewestPictures = 2;

// What lies outside of a picture, or behind the camera, is not outside its mask.
bool is_outside_mask(const PictureView& view, const Eigen::Vector3d& point_site) {
    if (view.mask == nullptr || view.picture.y.data == nullptr) return false;
    const geometry::CalibratedCamera& camera = *view.camera;
    const Eigen::Vector3d at =
        camera.camera_from_site.rotation * point_site + camera.camera_from_site.translation;
    if (!(at.z() > kNearest_m)) return false;
    const Eigen::Vector2d px = camera.intrinsics.distort(camera.intrinsics.project(at));
    if (!(px.x() > -0.5 && px.y() > -0.5 && px.x() < view.mask->width - 0.5 &&
          px.y() < view.mask->height - 0.5))
        return false;
    return view.mask->at(static_cast<int>(px.x() + 0.5), static_cast<int>(px.y() + 0.5)) == 0;
}

}  // namespace

void PhotoRefinement::find_moves(const geometry::TriangleMesh& mesh, Executor& executor) {
    const std::size_t size = mesh.vertices.size();
    normals_.assign(size, Eigen::Vector3f::Zero());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3d& origin = mesh.vertices[a];
        const Eigen::Vector3f doubled =
            (mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin).cast<float>();
        for (const std::uint32_t v : {a, b, c}) normals_[v] += doubled;
    }
    moves_.resize(size);
    phantoms_.resize(size);
    const auto work = [&](std::size_t chunk, std::size_t worker) {
        for (std::size_t v = chunk * kChunk; v < std::min(size, (chunk + 1) * kChunk); ++v) {
            normals_[v].normalize();
            const InwardSweep::Move move =
                sweep_.move_at(mesh.vertices[v].cast<float>(), normals_[v], near_[worker]);
            moves_[v] = move.by_m;
            phantoms_[v] = move.phantom;
        }
    };
    executor.parallel_for(num_chunks(size), work);
}

// The vertices of a camera's faces lie on its outlines. Of those that one part of an outline shows,
// the one that would move least is held: surfels alone hold the surface too coarsely. Only a mesh
// with divided edges has vertices where the person touches a long viewing ray.
void PhotoRefinement::hold_outlines(const geometry::TriangleMesh& mesh,
                                    std::span<const PictureView> views) {
    on_outlines_.clear();
    outlines_of_.assign(mesh.vertices.size(), 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (face_owners_[t] == hull::kNoOwner) continue;
        const auto view = static_cast<std::size_t>(face_owners_[t]);
        const std::uint64_t bit = std::uint64_t{1} << view;
        for (const std::uint32_t v : mesh.triangles[t]) {
            if ((outlines_of_[v] & bit) != 0) continue;
            outlines_of_[v] |= bit;
            const auto bin =
                outline_bin(*views[view].camera, view, mesh.vertices[v], options_.outline_bin_px);
            if (bin) on_outlines_.push_back({*bin, moves_[v].norm(), v});
        }
    }
    keep_least(on_outlines_);
    const float between_m = options_.free_move_m - options_.firm_move_m;
    for (const auto& [bin, move_m, vertex] : on_outlines_)
        moves_[vertex] *= std::clamp((move_m - options_.firm_move_m) / between_m, 0.0F, 1.0F);
}

// Judges the edges of vertices from `first_new` on; the others have been judged. False if none
// bends.
bool PhotoRefinement::split_bent_edges(geometry::TriangleMesh& mesh,
                                       std::size_t first_new,
                                       Executor& executor) {
    const double most_sq = double{options_.most_edge_m} * double{options_.most_edge_m};
    long_edges_.clear();
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            // each edge of a closed mesh has one triangle on each side, in opposite directions
            const std::uint32_t a = triangle[k];
            const std::uint32_t b = triangle[(k + 1) % 3];
            if (a < b && b >= first_new &&
                (mesh.vertices[a] - mesh.vertices[b]).squaredNorm() > most_sq)
                long_edges_.emplace_back().edge = {a, b, 0};
        }
    }
    const auto look = [&](std::size_t chunk, std::size_t worker) {
        const std::size_t end = std::min(long_edges_.size(), (chunk + 1) * kChunk);
        for (std::size_t i = chunk * kChunk; i < end; ++i) {
            LongEdge& at = long_edges_[i];
            const auto [a, b, middle] = at.edge;
            at.normal = (normals_[a] + normals_[b]).normalized();
            const Eigen::Vector3d place = 0.5 * (mesh.vertices[a] + mesh.vertices[b]);
            at.move = sweep_.move_at(place.cast<float>(), at.normal, near_[worker]);
            at.bends =
                (at.move.by_m - 0.5F * (moves_[a] + moves_[b])).norm() > options_.least_bend_m;
        }
    };
    executor.parallel_for(num_chunks(long_edges_.size()), look);
    splits_.clear();
    for (const LongEdge& at : long_edges_) {
        if (!at.bends) continue;
        splits_.push_back(at.edge);
        splits_.back().middle = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.emplace_back(0.5 *
                                   (mesh.vertices[at.edge.low] + mesh.vertices[at.edge.high]));
        normals_.push_back(at.normal);
        moves_.push_back(at.move.by_m);
        phantoms_.push_back(at.move.phantom);
    }
    std::ranges::sort(splits_, [](const SplitEdge& a, const SplitEdge& b) {
        return a.low != b.low ? a.low < b.low : a.high < b.high;
    });
    split_edges(splits_, mesh, face_owners_);
    return !splits_.empty();
}

void PhotoRefinement::shrink_phantoms(const geometry::TriangleMesh& mesh) {
    // a vertex with a phantom on one side only stays
    for (float& phantom : phantoms_) phantom = std::clamp(2.0F * phantom - 0.5F, 0.0F, 1.0F);
    if (std::ranges::none_of(phantoms_, [](float phantom) { return phantom > 0.0F; })) return;
    places_.clear();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        places_.push_back(mesh.vertices[v].cast<float>() + moves_[v]);
    membrane_.shrink(mesh.triangles, phantoms_, places_);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (phantoms_[v] > 0.0F) moves_[v] = places_[v] - mesh.vertices[v].cast<float>();
}

// Where a part is thinner than the surfels say, its surface moves less far.
void PhotoRefinement::apply_moves(geometry::TriangleMesh& mesh,
                                  std::span<const PictureView> views,
                                  Executor& executor) const {
    const std::size_t size = mesh.vertices.size();
    const auto work = [&](std::size_t chunk, std::size_t) {
        for (std::size_t v = chunk * kChunk; v < std::min(size, (chunk + 1) * kChunk); ++v) {
            Eigen::Vector3d move = moves_[v].cast<double>();
            Eigen::Vector3d& vertex = mesh.vertices[v];
            const auto leaves = [&](const PictureView& view) {
                return is_outside_mask(view, vertex + move);
            };
            while (move.norm() > double{options_.safe_move_m} && std::ranges::any_of(views, leaves))
                move *= 0.5;
            vertex += move;
        }
    };
    executor.parallel_for(num_chunks(size), work);
}

bool PhotoRefinement::refine(geometry::TriangleMesh& mesh,
                             std::span<const PictureView> views,
                             Executor& executor) {
    assert(views.size() <= hull::kMaxViews);
    const auto num_pictures =
        static_cast<std::size_t>(std::ranges::count_if(views, [](const PictureView& view) {
            return view.picture.y.data != nullptr && view.mask != nullptr && !view.subject.empty();
        }));
    if (num_pictures < kFewestPictures || !geometry::inspect(mesh).manifold) {
        forget();
        return false;
    }
    near_.resize(std::max(near_.size(), executor.num_workers()));
    sweep_.find(mesh, views, executor);
    const std::span<const std::int32_t> owners = sweep_.surfels().face_owners();
    face_owners_.assign(owners.begin(), owners.end());
    find_moves(mesh, executor);
    constexpr int kMostPasses = 4;
    std::size_t first_new = 0;
    for (int pass = 0; pass < kMostPasses; ++pass) {
        const std::size_t num_before = mesh.vertices.size();
        if (!split_bent_edges(mesh, first_new, executor)) break;
        first_new = num_before;
    }
    hold_outlines(mesh, views);
    shrink_phantoms(mesh);
    apply_moves(mesh, views, executor);
    return true;
}

}  // namespace atrium::refine
