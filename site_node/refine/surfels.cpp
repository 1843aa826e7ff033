#include "site_node/refine/surfels.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace atrium::refine {
namespace {

constexpr float kLeastArea_m2 = 1e-10F;
constexpr std::uint64_t kNumDirections = 6;
// faces of rounded corners still touch the silhouettes
constexpr double kMostSine = 0.05;

// The axis that a normal follows most, and its sign.
std::uint64_t direction_of(const Eigen::Vector3f& normal) {
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return 2 * static_cast<std::uint64_t>(axis) + (normal[axis] > 0.0F ? 1 : 0);
}

std::size_t hash_of(std::uint64_t key) {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 20U);
}

}  // namespace

Surfels::Sum& Surfels::sum_of(std::uint64_t key) {
    if (2 * (sums_.size() + 1) > slots_.size()) grow();
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = hash_of(key) & mask;
    while (slots_[i].key != key && slots_[i].key != kEmpty) i = (i + 1) & mask;
    if (slots_[i].key == kEmpty) {
        slots_[i] = {key, static_cast<std::uint32_t>(sums_.size())};
        sums_.emplace_back();
    }
    return sums_[slots_[i].sum];
}

void Surfels::grow() {
    constexpr std::size_t kLeast = 1U << 14U;
    std::vector<Slot> old = std::exchange(slots_, {});
    slots_.resize(std::max(kLeast, 2 * old.size()));
    const std::size_t mask = slots_.size() - 1;
    for (const Slot& slot : old) {
        if (slot.key == kEmpty) continue;
        std::size_t i = hash_of(slot.key) & mask;
        while (slots_[i].key != kEmpty) i = (i + 1) & mask;
        slots_[i] = slot;
    }
}

// Faces of a hull are long and thin: their samples lie 0.7 spacings apart along the longest edge,
// and as far across.
void Surfels::add_samples(const geometry::TriangleMesh& mesh,
                          std::span<const Eigen::Vector3d> centres_site,
                          float spacing_m) {
    std::fill(slots_.begin(), slots_.end(), Slot{});
    sums_.clear();
    const Eigen::Vector3d origin = geometry::bounds(mesh).min;
    face_owners_.assign(mesh.triangles.size(), hull::kNoOwner);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& triangle = mesh.triangles[t];
        std::array<Eigen::Vector3d, 3> p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.vertices[triangle[k]];
        const Eigen::Vector3d doubled = (p[1] - p[0]).cross(p[2] - p[0]);
        const double doubled_area = doubled.norm();
        if (!(doubled_area > 2.0 * double{kLeastArea_m2})) continue;
        const Eigen::Vector3d normal = doubled / doubled_area;
        std::size_t apex = 0;  // opposite the longest edge
        double longest = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double length = (p[(k + 2) % 3] - p[(k + 1) % 3]).norm();
            if (length > longest) apex = k;
            longest = std::max(longest, length);
        }
        const double apart_m = 0.7 * double{spacing_m};
        const int num_along = static_cast<int>(longest / apart_m) + 1;
        const int num_across = static_cast<int>(doubled_area / longest / apart_m) + 1;
        const float area = static_cast<float>(0.5 * doubled_area / num_along / num_across);
        const Eigen::Vector3f normal_f = normal.cast<float>();
        const std::uint64_t direction = direction_of(normal_f);
        const std::int32_t owner = hull::face_owner(p[0], normal, centres_site, kMostSine);
        face_owners_[t] = owner;
        const Eigen::Vector3d& a = p[apex];
        const Eigen::Vector3d b = p[(apex + 1) % 3] - a;
        const Eigen::Vector3d c = p[(apex + 2) % 3] - a;
        for (int j = 0; j < num_across; ++j) {
            const double down = std::sqrt((j + 0.5) / num_across);  // samples of equal areas
            for (int i = 0; i < num_along; ++i) {
                const double side = (i + 0.5) / num_along;
                const Eigen::Vector3d sample = a + down * ((1.0 - side) * b + side * c);
                std::uint64_t key = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    const double cell = (sample[axis] - origin[axis]) / double{spacing_m};
                    key =
                        (key << 20U) | (static_cast<std::uint64_t>(std::max(cell, 0.0)) & 0xFFFFFU);
                }
                Sum& sum = sum_of(kNumDirections * key + direction);
                sum.position += area * sample.cast<float>();
                sum.normal += area * normal_f;
                sum.area_m2 += area;
                if (sum.owner == owner) {
                    sum.lead_m2 += area;
                } else if (sum.lead_m2 < area) {
                    sum.owner = owner;
                    sum.lead_m2 = area - sum.lead_m2;
                } else {
                    sum.lead_m2 -= area;
                }
            }
        }
    }
}

// Those that are near each other in space then are so in memory.
void Surfels::sort_by_place(float cell_m) {
    grid_.assign(points_, cell_m);
    surfels_.clear();
    for (const std::uint32_t i : grid_.order()) surfels_.push_back(unsorted_[i]);
    rows_.positions_site.resize(surfels_.size() + SurfelRows::kMargin);
    rows_.normals.resize(surfels_.size() + SurfelRows::kMargin);
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        image::set(rows_.positions_site, i, surfels_[i].position_site);
        image::set(rows_.normals, i, surfels_[i].normal);
    }
}

void Surfels::find_runs(const Eigen::Vector3f& centre_site,
                        float radius_m,
                        std::vector<SurfelRun>& runs) const {
    runs.clear();
    grid_.near(centre_site, radius_m, [&](std::uint32_t begin, std::uint32_t end) {
        runs.push_back({begin, end});
    });
}

void Surfels::near(const Eigen::Vector3f& centre_site, float radius_m, NearScratch& scratch) const {
    find_runs(centre_site, radius_m, scratch.runs);
    find_near(rows_, scratch.runs, centre_site, radius_m, scratch.found);
}

// Lists who is near, smooths the normals over them, and keeps those of a similar normal.
void Surfels::join_neighbours(const SurfelOptions& options, Executor& executor) {
    const std::size_t size = surfels_.size();
    const float radius_sq = options.neighbourhood_m * options.neighbourhood_m;
    smoothed_.resize(size);
    begins_.resize(size + 1);
    found_.resize(std::max(found_.size(), num_chunks(size)));
    near_.resize(std::max(near_.size(), executor.num_workers()));
    const auto look = [&](std::size_t chunk, std::size_t worker) {
        NearScratch& scratch = near_[worker];
        std::vector<Neighbour>& found = found_[chunk];
        found.clear();
        for (std::size_t i = chunk * kChunk; i < std::min(size, (chunk + 1) * kChunk); ++i) {
            const Surfel& surfel = surfels_[i];
            const std::size_t num_before = found.size();
            Eigen::Vector3f sum = surfel.normal;
            near(surfel.position_site, options.neighbourhood_m, scratch);
            for (const NearSurfel& other : scratch.found) {
                constexpr float kLeastCosine = 0.2F;
                if (other.surfel == i) continue;
                const Eigen::Vector3f& normal = surfels_[other.surfel].normal;
                const float cosine = surfel.normal.dot(normal);
                const float weight = falling_weight(other.distance_sq / radius_sq);
                if (cosine > kLeastCosine) sum += cosine * weight * normal;
                found.push_back({other.surfel, weight});
            }
            smoothed_[i] = sum.normalized();
            begins_[i + 1] = static_cast<std::uint32_t>(found.size() - num_before);
        }
    };
    executor.parallel_for(num_chunks(size), look);
    for (std::size_t i = 0; i < size; ++i) {
        surfels_[i].normal = smoothed_[i];
        image::set(rows_.normals, i, smoothed_[i]);
    }

    neighbours_.clear();
    begins_[0] = 0;
    for (std::size_t chunk = 0; chunk < num_chunks(size); ++chunk) {
        const Neighbour* near = found_[chunk].data();
        for (std::size_t i = chunk * kChunk; i < std::min(size, (chunk + 1) * kChunk); ++i) {
            const Neighbour* const end = near + begins_[i + 1];
            for (; near != end; ++near) {
                constexpr float kLeastCosine = 0.5F;
                const float cosine = surfels_[i].normal.dot(surfels_[near->surfel].normal);
                if (cosine > kLeastCosine)
                    neighbours_.push_back({near->surfel, cosine * near->weight});
            }
            begins_[i + 1] = static_cast<std::uint32_t>(neighbours_.size());
        }
    }
}

// Looks for surfels of the opposite direction along the inward normal, piece by piece.
void Surfels::find_thickness(const SurfelOptions& options, Executor& executor) {
    const std::size_t size = surfels_.size();
    const float reach = 0.8F * options.spacing_m;  // sideways
    const auto find = [&](std::size_t chunk, std::size_t worker) {
        std::vector<SurfelRun>& runs = near_[worker].runs;
        for (std::size_t i = chunk * kChunk; i < std::min(size, (chunk + 1) * kChunk); ++i) {
            Surfel& surfel = surfels_[i];
            const InwardLine line{surfel.position_site, surfel.normal, reach};
            surfel.thickness_m = options.most_thickness_m;
            for (float depth = options.spacing_m;
                 depth < options.most_thickness_m && surfel.thickness_m == options.most_thickness_m;
                 depth += 2.0F * reach) {
                find_runs(surfel.position_site - depth * surfel.normal, 1.5F * reach, runs);
                surfel.thickness_m =
                    distance_to_opposite(rows_, runs, line, options.most_thickness_m);
            }
        }
    };
    executor.parallel_for(num_chunks(size), find);
}

void Surfels::sample(const geometry::TriangleMesh& mesh,
                     std::span<const Eigen::Vector3d> centres_site,
                     const SurfelOptions& options,
                     Executor& executor) {
    add_samples(mesh, centres_site, options.spacing_m);
    unsorted_.clear();
    points_.clear();
    const float least_area = 0.25F * options.spacing_m * options.spacing_m;
    for (const Sum& sum : sums_) {
        const float length = sum.normal.norm();
        if (sum.area_m2 < least_area || !(length > 0.0F)) continue;
        unsorted_.push_back({sum.position / sum.area_m2, sum.normal / length, sum.owner, 0.0F});
        points_.push_back(unsorted_.back().position_site);
    }
    sort_by_place(options.neighbourhood_m);
    join_neighbours(options, executor);
    find_thickness(options, executor);
}

}  // namespace atrium::refine
