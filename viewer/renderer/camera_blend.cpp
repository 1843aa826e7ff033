#include "viewer/renderer/camera_blend.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::renderer {
namespace {

constexpr float kMaxPenalty = 40.0f;     // as of a camera opposite to the viewer of quality 0.08
constexpr float kFullWeight = 9e-4f;     // sum of the weights from which on cameras alone colour
constexpr float kAngleFloor = 0.06f;     // [rad] keeps the weight of an aligned camera finite
constexpr float kStretchPenalty = 0.4f;  // [rad] of a camera that sees half of what the eye sees
constexpr float kLeastCos = 0.2f;        // beyond it, stretch grows no more

// Cameras that colour one triangle, in the order of their appearance.
struct TriangleCameras {
    std::array<std::uint8_t, 3 * kCamerasPerVertex> cameras{};
    std::array<float, 3 * kCamerasPerVertex> facing{};  // of the triangle to each
    std::array<float, 3 * kCamerasPerVertex> total{};
    std::size_t count = 0;

    void add(std::uint8_t camera, float triangle_facing, float weight) {
        for (std::size_t i = 0; i < count; ++i) {
            if (cameras[i] == camera) {
                total[i] += triangle_facing * weight;
                return;
            }
        }
        cameras[count] = camera;
        facing[count] = triangle_facing;
        total[count] = triangle_facing * weight;
        ++count;
    }
    void drop_least() {
        const auto least = static_cast<std::size_t>(
            std::min_element(total.begin(), total.begin() + static_cast<std::ptrdiff_t>(count)) -
            total.begin());
        --count;
        cameras[least] = cameras[count];
        facing[least] = facing[count];
        total[least] = total[count];
    }
};

void insert_penalty(std::uint8_t camera,
                    float penalty,
                    VertexBlend& blend,
                    std::array<float, kCamerasPerVertex + 1>& penalties) {
    if (penalty >= penalties[kCamerasPerVertex]) return;
    std::size_t at = kCamerasPerVertex;
    while (at > 0 && penalties[at - 1] > penalty) {
        penalties[at] = penalties[at - 1];
        if (at < kCamerasPerVertex) blend.cameras[at] = blend.cameras[at - 1];
        --at;
    }
    penalties[at] = penalty;
    if (at < kCamerasPerVertex) blend.cameras[at] = camera;
}

void weights_from_penalties(const std::array<float, kCamerasPerVertex + 1>& penalties,
                            VertexBlend& blend) {
    const float threshold = penalties[kCamerasPerVertex];
    float sum = 0.0f;
    for (std::size_t i = 0; i < kCamerasPerVertex; ++i) {
        const float root =
            penalties[i] < threshold ? (1.0f - penalties[i] / threshold) / penalties[i] : 0.0f;
        // squared: the best camera prevails, so that what the others show elsewhere is no ghost
        blend.weights[i] = root * root;
        sum += blend.weights[i];
    }
    // not all of it where the last camera fades out: the fallback colour takes over there
    const float scale = 1.0f / std::max(sum, kFullWeight);
    for (float& weight : blend.weights) weight *= scale;
}

void emit_vertex(const PersonModel& model,
                 const VertexBlend& blend,
                 std::uint32_t vertex,
                 const TriangleCameras& used,
                 std::size_t num_slots,
                 float* out) {
    const Eigen::Vector3f& position = model.vertices_site[vertex];
    const Eigen::Vector3f& fallback = model.fallback[vertex];
    std::copy_n(position.data(), 3, out);
    std::copy_n(fallback.data(), 3, out + 3);
    float* layers = out + 6;
    float* slots = layers + num_slots;
    for (std::size_t i = 0; i < num_slots; ++i, slots += 4) {
        const std::uint8_t camera = i < used.count ? used.cameras[i] : std::uint8_t{0};
        layers[i] = static_cast<float>(camera);
        if (i >= used.count) {
            slots[0] = slots[1] = slots[3] = 0.0f;
            slots[2] = 1.0f;
            continue;
        }
        const Eigen::Vector3f& st = model.cameras[camera].layer_coordinates[vertex];
        std::copy_n(st.data(), 3, slots);
        slots[3] = 0.0f;
        for (std::size_t k = 0; k < kCamerasPerVertex; ++k)
            if (blend.cameras[k] == camera && blend.weights[k] > 0.0f)
                slots[3] = blend.weights[k] * used.facing[i];
    }
}

}  // namespace

void choose_cameras(const PersonModel& model, const Eigen::Vector3f& eye_site, BlendScratch& out) {
    assert(model.cameras.size() <= 255);
    const std::size_t num_vertices = model.vertices_site.size();
    out.vertices.assign(num_vertices, {});
    out.penalties.resize(num_vertices);
    for (auto& penalties : out.penalties) penalties.fill(kMaxPenalty);
    out.to_eye.resize(num_vertices);
    out.cos_eye.resize(num_vertices);
    for (std::size_t v = 0; v < num_vertices; ++v) {
        out.to_eye[v] = (eye_site - model.vertices_site[v]).normalized();
        out.cos_eye[v] = out.to_eye[v].dot(model.normals[v]);
    }
    for (std::size_t c = 0; c < model.cameras.size(); ++c) {
        const PersonModel::Camera& camera = model.cameras[c];
        for (std::size_t v = 0; v < num_vertices; ++v) {
            if (camera.quality[v] <= 0.0f) continue;
            const Eigen::Vector3f to_camera = camera.centre_site - model.vertices_site[v];
            const Eigen::Vector3f& to_eye = out.to_eye[v];
            const float per_distance = 1.0f / std::sqrt(to_camera.squaredNorm() + 1e-12f);
            const float cos_angle = to_camera.dot(to_eye) * per_distance;
            const float cos_camera =
                std::max(kLeastCos, to_camera.dot(model.normals[v]) * per_distance);
            const float stretch = std::max(0.0f, out.cos_eye[v] / cos_camera - 1.0f);
            // chord of the unit circle: within 11 % of the angle up to 90 degrees, without acos
            const float angle = std::sqrt(std::max(0.0f, 2.0f - 2.0f * cos_angle));
            insert_penalty(static_cast<std::uint8_t>(c),
                           (angle + kAngleFloor) / camera.quality[v] + kStretchPenalty * stretch,
                           out.vertices[v],
                           out.penalties[v]);
        }
    }
    for (std::size_t v = 0; v < num_vertices; ++v)
        weights_from_penalties(out.penalties[v], out.vertices[v]);
}

void blend_for_view(const PersonModel& model,
                    const Eigen::Vector3f& eye_site,
                    BlendScratch& scratch,
                    BlendedMesh& out) {
    choose_cameras(model, eye_site, scratch);
    for (BlendGroup& group : out.groups) group.num_vertices = 0;
    for (std::size_t t = 0; t < model.triangles.size(); ++t) {
        const auto& triangle = model.triangles[t];
        const Eigen::Vector3f& a = model.vertices_site[triangle[0]];
        const Eigen::Vector3f normal =
            (model.vertices_site[triangle[1]] - a).cross(model.vertices_site[triangle[2]] - a);
        if (!(normal.dot(eye_site - a) > 0.0f)) continue;
        TriangleCameras used;
        for (const std::uint32_t v : triangle) {
            const VertexBlend& blend = scratch.vertices[v];
            for (std::size_t k = 0; k < kCamerasPerVertex; ++k) {
                if (blend.weights[k] <= 0.0f) continue;
                // what a camera's own silhouette made is edge-on to it, whatever lies beside it
                const float facing = model.cameras[blend.cameras[k]].facing[t];
                if (facing > 0.0f) used.add(blend.cameras[k], facing, blend.weights[k]);
            }
        }
        while (used.count > kCamerasPerTriangle.back()) used.drop_least();
        std::size_t g = 0;
        while (kCamerasPerTriangle[g] < used.count) ++g;
        BlendGroup& group = out.groups[g];
        const std::size_t num_slots = kCamerasPerTriangle[g];
        // never shrinks: after some frames it is large enough for good
        const std::size_t needed = (group.num_vertices + 3) * floats_per_vertex(num_slots);
        if (group.data.size() < needed) group.data.resize(needed);
        for (const std::uint32_t v : triangle) {
            emit_vertex(model,
                        scratch.vertices[v],
                        v,
                        used,
                        num_slots,
                        group.data.data() + group.num_vertices * floats_per_vertex(num_slots));
            ++group.num_vertices;
        }
    }
}

}  // namespace atrium::renderer
