#include "viewer/renderer/person/camera_blend.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#if defined(__x86_64__)
#define ATRIUM_AVX2 __attribute__((target("avx2")))
#endif
#define ATRIUM_INLINE inline __attribute__((always_inline))

namespace atrium::renderer {
namespace {

constexpr float kMaxPenalty = 40.0f;  // that of a camera opposite to the viewer with quality 0.08
constexpr float kFullWeight = 9e-4f;  // sum of weights above which the fallback colour has no share
constexpr float kLeastShare = 0.05f;  // share of all weights; smaller ones go to the other cameras
constexpr float kAngleFloor = 0.06f;  // [rad] keeps the weight of an aligned camera finite
constexpr float kStretchPenalty = 0.4f;  // [rad] for a camera that sees half of what the eye sees
constexpr float kLeastCos = 0.2f;        // stretch is limited below this cosine

// Cameras of one triangle, in order of appearance.
struct TriangleCameras {
    std::array<BlendSlot, 3 * kCamerasPerVertex> slots;
    std::array<float, 3 * kCamerasPerVertex> total;
    std::size_t count = 0;

    void add(std::uint8_t camera, std::size_t corner, float weight) {
        std::size_t i = 0;
        while (i < count && slots[i].camera != camera) ++i;
        if (i == count) {
            slots[i] = {{}, camera};
            total[i] = 0.0f;
            ++count;
        }
        slots[i].weights[corner] = weight;
        total[i] += weight;
    }
    void drop_least() {
        const auto least = static_cast<std::size_t>(
            std::min_element(total.begin(), total.begin() + static_cast<std::ptrdiff_t>(count)) -
            total.begin());
        --count;
        slots[least] = slots[count];
        total[least] = total[count];
    }
};

// The compiler vectorises these loops for each instruction set.

ATRIUM_INLINE void look_from(const Eigen::Vector3f& eye, std::size_t size, BlendScratch& out) {
    const float ex = eye.x(), ey = eye.y(), ez = eye.z();
    const float *px = out.points.x.data(), *py = out.points.y.data(), *pz = out.points.z.data();
    const float *nx = out.normals.x.data(), *ny = out.normals.y.data(), *nz = out.normals.z.data();
    float *to_x = out.to_eye.x.data(), *to_y = out.to_eye.y.data(), *to_z = out.to_eye.z.data();
    float* cos_eye = out.cos_eye.data();
    // the arrays do not overlap
#pragma GCC ivdep
    for (std::size_t v = 0; v < size; ++v) {
        const float x = ex - px[v], y = ey - py[v], z = ez - pz[v];
        const float per_distance = 1.0f / std::sqrt(x * x + y * y + z * z + 1e-12f);
        to_x[v] = x * per_distance;
        to_y[v] = y * per_distance;
        to_z[v] = z * per_distance;
        cos_eye[v] = to_x[v] * nx[v] + to_y[v] * ny[v] + to_z[v] * nz[v];
    }
}

// Each point has an eye of its own, far away on its normal.
void look_along_normals(BlendScratch& out) {
    out.to_eye = out.normals;
    std::ranges::fill(out.cos_eye, 1.0f);
}

// Inserts the camera into the sorted lists of smallest penalties.
ATRIUM_INLINE void consider(const PersonModel::Camera& camera,
                            std::int32_t index,
                            std::size_t size,
                            BlendScratch& out) {
    static_assert(kCamerasPerVertex == 3);
    const float cx = camera.centre_site.x();
    const float cy = camera.centre_site.y();
    const float cz = camera.centre_site.z();
    const float* quality = camera.quality.data();
    const float *px = out.points.x.data(), *py = out.points.y.data(), *pz = out.points.z.data();
    const float *nx = out.normals.x.data(), *ny = out.normals.y.data(), *nz = out.normals.z.data();
    const float* to_x = out.to_eye.x.data();
    const float* to_y = out.to_eye.y.data();
    const float* to_z = out.to_eye.z.data();
    const float* cos_eye = out.cos_eye.data();
    float* first = out.penalties[0].data();
    float* second = out.penalties[1].data();
    float* third = out.penalties[2].data();
    float* fourth = out.penalties[3].data();
    std::int32_t* first_camera = out.candidates[0].data();
    std::int32_t* second_camera = out.candidates[1].data();
    std::int32_t* third_camera = out.candidates[2].data();
#pragma GCC ivdep
    for (std::size_t v = 0; v < size; ++v) {
        const float x = cx - px[v], y = cy - py[v], z = cz - pz[v];
        const float per_distance = 1.0f / std::sqrt(x * x + y * y + z * z + 1e-12f);
        const float cos_angle = (x * to_x[v] + y * to_y[v] + z * to_z[v]) * per_distance;
        const float cos_camera =
            std::max(kLeastCos, (x * nx[v] + y * ny[v] + z * nz[v]) * per_distance);
        const float stretch = std::max(0.0f, cos_eye[v] / cos_camera - 1.0f);
        // chord of the unit circle: within 11 % of the angle up to 90 degrees, without acos
        const float angle = std::sqrt(std::max(0.0f, 2.0f - 2.0f * cos_angle));
        const float own =
            (angle + kAngleFloor) / std::max(quality[v], 1e-9f) + kStretchPenalty * stretch;
        const float penalty = quality[v] > 0.0f ? own : kMaxPenalty;
        const float p0 = first[v], p1 = second[v], p2 = third[v], p3 = fourth[v];
        const std::int32_t c0 = first_camera[v], c1 = second_camera[v], c2 = third_camera[v];
        first[v] = penalty < p0 ? penalty : p0;
        first_camera[v] = penalty < p0 ? index : c0;
        second[v] = penalty < p0 ? p0 : penalty < p1 ? penalty : p1;
        second_camera[v] = penalty < p0 ? c0 : penalty < p1 ? index : c1;
        third[v] = penalty < p1 ? p1 : penalty < p2 ? penalty : p2;
        third_camera[v] = penalty < p1 ? c1 : penalty < p2 ? index : c2;
        fourth[v] = penalty < p2 ? p2 : penalty < p3 ? penalty : p3;
    }
}

ATRIUM_INLINE void weigh(std::size_t size, BlendScratch& out) {
    const float* penalties[] = {
        out.penalties[0].data(), out.penalties[1].data(), out.penalties[2].data()};
    const float* threshold = out.penalties[3].data();
    float* weights[] = {out.weights[0].data(), out.weights[1].data(), out.weights[2].data()};
#pragma GCC ivdep
    for (std::size_t v = 0; v < size; ++v) {
        // squared: the best camera dominates, which suppresses ghosts of the others
        const auto of = [&](float penalty) {
            const float root =
                (1.0f - std::min(penalty / threshold[v], 1.0f)) / std::max(penalty, 1e-9f);
            return root * root;
        };
        const float w0 = of(penalties[0][v]), w1 = of(penalties[1][v]), w2 = of(penalties[2][v]);
        const float sum = w0 + w1 + w2;
        const float least = kLeastShare * sum;
        const float s0 = std::max(0.0f, w0 - least);
        const float s1 = std::max(0.0f, w1 - least);
        const float s2 = std::max(0.0f, w2 - least);
        // less than 1 where the last camera fades out; the fallback colour takes over
        const float scale = sum / std::max(sum, kFullWeight) / std::max(s0 + s1 + s2, 1e-12f);
        weights[0][v] = s0 * scale;
        weights[1][v] = s1 * scale;
        weights[2][v] = s2 * scale;
    }
}

// Without an eye: from the normals.
ATRIUM_INLINE void choose(const PersonModel& model,
                          const Eigen::Vector3f* eye_site,
                          BlendScratch& out) {
    const std::size_t size = model.vertices_site.size();
    if (eye_site != nullptr) look_from(*eye_site, size, out);
    for (std::size_t c = 0; c < model.cameras.size(); ++c)
        consider(model.cameras[c], static_cast<std::int32_t>(c), size, out);
    weigh(size, out);
}

#ifdef ATRIUM_AVX2
ATRIUM_AVX2 void choose_avx2(const PersonModel& model,
                             const Eigen::Vector3f* eye_site,
                             BlendScratch& out) {
    choose(model, eye_site, out);
}
#endif

void prepare(const PersonModel& model, BlendScratch& out) {
    const std::size_t size = model.vertices_site.size();
    for (Axes* axes : {&out.points, &out.normals, &out.to_eye}) axes->resize(size);
    for (std::size_t v = 0; v < size; ++v) {
        set(out.points, v, model.vertices_site[v]);
        set(out.normals, v, model.normals[v]);
    }
    out.cos_eye.resize(size);
    for (auto& penalties : out.penalties) penalties.assign(size, kMaxPenalty);
    for (auto& candidates : out.candidates) candidates.assign(size, 0);
    for (auto& weights : out.weights) weights.resize(size);
    out.vertices.resize(size);
}

template <std::size_t kNumSlots>
void lay_out_group(const PersonModel& model, const BlendGroup& group, float* out) {
    std::array<const Eigen::Vector3f*, 255> coordinates;
    for (std::size_t c = 0; c < model.cameras.size(); ++c)
        coordinates[c] = model.cameras[c].layer_coordinates.data();
    const bool has_pictures = !model.cameras.empty();
    const BlendSlot* slots = group.slots.data();
    for (const std::uint32_t t : group.triangles) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = model.triangles[t][corner];
            std::copy_n(model.vertices_site[vertex].data(), 3, out);
            std::copy_n(model.fallback[vertex].data(), 3, out + 3);
            float* layers = out + 6;
            float* pictures = layers + kNumSlots;
            for (std::size_t i = 0; i < kNumSlots; ++i, pictures += 4) {
                layers[i] = static_cast<float>(slots[i].camera);
                const Eigen::Vector3f st =
                    has_pictures ? coordinates[slots[i].camera][vertex] : Eigen::Vector3f::UnitZ();
                std::copy_n(st.data(), 3, pictures);
                pictures[3] = slots[i].weights[corner];
            }
            out += floats_per_vertex(kNumSlots);
        }
        slots += kNumSlots;
    }
}

template <std::size_t... kGroups>
void lay_out_any(const PersonModel& model,
                 const BlendGroup& group,
                 std::size_t index,
                 float* out,
                 std::index_sequence<kGroups...>) {
    (void)((kGroups == index &&
            (lay_out_group<kCamerasPerTriangle[kGroups]>(model, group, out), true)) ||
           ...);
}

void choose_any(const PersonModel& model,
                const Eigen::Vector3f* eye_site,
                BlendScratch& out,
                [[maybe_unused]] image::RowCode code) {
    assert(model.cameras.size() <= 255);
    prepare(model, out);
    if (eye_site == nullptr) look_along_normals(out);
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2)
        choose_avx2(model, eye_site, out);
    else
#endif
        choose(model, eye_site, out);
    for (std::size_t v = 0; v < out.vertices.size(); ++v) {
        for (std::size_t k = 0; k < kCamerasPerVertex; ++k) {
            out.vertices[v].cameras[k] = static_cast<std::uint8_t>(out.candidates[k][v]);
            out.vertices[v].weights[k] = out.weights[k][v];
        }
    }
}

bool faces(const PersonModel& model,
           const std::array<std::uint32_t, 3>& triangle,
           const Eigen::Vector3f& eye_site) {
    const Eigen::Vector3f& a = model.vertices_site[triangle[0]];
    const Eigen::Vector3f normal =
        (model.vertices_site[triangle[1]] - a).cross(model.vertices_site[triangle[2]] - a);
    return normal.dot(eye_site - a) > 0.0f;
}

// Without an eye: all triangles.
void group_triangles(const PersonModel& model,
                     const Eigen::Vector3f* eye_site,
                     const BlendScratch& scratch,
                     BlendedMesh& out) {
    std::array<const float*, 255> facing_of;
    for (std::size_t c = 0; c < model.cameras.size(); ++c)
        facing_of[c] = model.cameras[c].facing.data();
    for (BlendGroup& group : out.groups) {
        group.triangles.clear();
        group.slots.clear();
    }
    for (std::uint32_t t = 0; t < model.triangles.size(); ++t) {
        const auto& triangle = model.triangles[t];
        if (eye_site != nullptr && !faces(model, triangle, *eye_site)) continue;
        TriangleCameras used;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const VertexBlend& blend = scratch.vertices[triangle[corner]];
            // weights are in descending order
            for (std::size_t k = 0; k < kCamerasPerVertex && blend.weights[k] > 0.0f; ++k) {
                // the camera sees faces that its own silhouette cut edge-on, whatever it sees
                // beside them
                const float facing = facing_of[blend.cameras[k]][t];
                if (facing > 0.0f) used.add(blend.cameras[k], corner, facing * blend.weights[k]);
            }
        }
        while (used.count > kCamerasPerTriangle.back()) used.drop_least();
        std::size_t g = 0;
        while (kCamerasPerTriangle[g] < used.count) ++g;
        while (used.count < kCamerasPerTriangle[g]) used.slots[used.count++] = {};
        BlendGroup& group = out.groups[g];
        group.triangles.push_back(t);
        group.slots.insert(group.slots.end(),
                           used.slots.begin(),
                           used.slots.begin() + static_cast<std::ptrdiff_t>(used.count));
    }
}

}  // namespace

void choose_cameras(const PersonModel& model,
                    const Eigen::Vector3f& eye_site,
                    BlendScratch& out,
                    image::RowCode code) {
    choose_any(model, &eye_site, out, code);
}

void blend_for_view(const PersonModel& model,
                    const Eigen::Vector3f& eye_site,
                    BlendScratch& scratch,
                    BlendedMesh& out) {
    choose_any(model, &eye_site, scratch, image::best_row_code());
    group_triangles(model, &eye_site, scratch, out);
}

void blend_for_texture(const PersonModel& model, BlendScratch& scratch, BlendedMesh& out) {
    choose_any(model, nullptr, scratch, image::best_row_code());
    group_triangles(model, nullptr, scratch, out);
}

void lay_out(const PersonModel& model,
             const BlendedMesh& blended,
             std::size_t group,
             std::span<float> out) {
    const BlendGroup& laid_out = blended.groups[group];
    assert(out.size() >= laid_out.num_vertices() * floats_per_vertex(kCamerasPerTriangle[group]));
    lay_out_any(
        model, laid_out, group, out.data(), std::make_index_sequence<kCamerasPerTriangle.size()>());
}

}  // namespace atrium::renderer
