#include "viewer/renderer/person_model.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::renderer {
namespace {

constexpr int kBorder = 1;             // texels of alpha 0 around each picture
constexpr int kLayerGranularity = 64;  // so that the size of layers seldom changes

float smooth_step(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

bool is_usable(const CameraPicture& picture) {
    return picture.width > 0 && picture.height > 0 && !picture.crop_px.empty();
}

// Area-weighted normals, smoothed once over the neighbours: those of a hull jump from strip to
// strip.
void compute_normals(PersonModel& model, PersonModelScratch& scratch) {
    auto& sums = scratch.normal_sums;
    auto& normals = model.normals;
    sums.assign(model.vertices_site.size(), Eigen::Vector3f::Zero());
    scratch.face_normals.clear();
    for (const auto& [a, b, c] : model.triangles) {
        const Eigen::Vector3f& p = model.vertices_site[a];
        const Eigen::Vector3f twice_area =
            (model.vertices_site[b] - p).cross(model.vertices_site[c] - p);
        for (const std::uint32_t v : {a, b, c}) sums[v] += twice_area;
        scratch.face_normals.push_back(twice_area.normalized());
    }
    for (auto& n : sums) n.normalize();
    normals = sums;
    for (const auto& [a, b, c] : model.triangles) {
        const Eigen::Vector3f mean = (sums[a] + sums[b] + sums[c]) * 0.25f;
        for (const std::uint32_t v : {a, b, c}) normals[v] += mean;
    }
    for (auto& n : normals) n.normalize();
}

void choose_layer_size(std::span<const CameraPicture> pictures, PersonModel& out) {
    int width = 1;
    int height = 1;
    for (const CameraPicture& picture : pictures) {
        width = std::max(width, picture.width);
        height = std::max(height, picture.height);
    }
    const auto round_up = [](int size) {
        return (size + 2 * kBorder + kLayerGranularity - 1) / kLayerGranularity * kLayerGranularity;
    };
    out.layer_width = round_up(width);
    out.layer_height = round_up(height);
}

std::size_t layer_bytes(const PersonModel& model) {
    return static_cast<std::size_t>(model.layer_width) *
           static_cast<std::size_t>(model.layer_height) * 4;
}

bool is_masked(const std::uint8_t* rgba) { return rgba[3] >= 128; }

// A texel at the outline shows some of what is behind: it counts little beside those of other
// cameras, and takes over only where there are none.
constexpr int kOutlineAlpha = 48;

// Copies the picture with its colour multiplied by alpha: what lies outside the mask then has no
// part in any filtered texel, and a weighted sum of texels divides out to a colour of the person
// alone.
void fill_layer(const CameraPicture& picture, const PersonModel& model, std::uint8_t* layer) {
    const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(picture.width) * 4;
    for (int y = 0; y < picture.height; ++y) {
        const std::uint8_t* from = picture.rgba.data() + y * stride;
        std::uint8_t* to =
            layer + (static_cast<std::ptrdiff_t>(y + kBorder) * model.layer_width + kBorder) * 4;
        const bool is_border_row = y == 0 || y + 1 == picture.height;
        for (int x = 0; x < picture.width; ++x, from += 4, to += 4) {
            if (!is_masked(from)) continue;
            const bool is_inside = !is_border_row && x > 0 && x + 1 < picture.width &&
                                   is_masked(from - 4) && is_masked(from + 4) &&
                                   is_masked(from - stride) && is_masked(from + stride);
            const int alpha = is_inside ? 255 : kOutlineAlpha;
            for (int i = 0; i < 3; ++i)
                to[i] =
                    is_inside ? from[i] : static_cast<std::uint8_t>((from[i] * alpha + 127) / 255);
            to[3] = static_cast<std::uint8_t>(alpha);
        }
    }
}

const std::uint8_t* texel(const PersonModel& model, std::size_t camera, float s, float t) {
    const int x = static_cast<int>(s * static_cast<float>(model.layer_width));
    const int y = static_cast<int>(t * static_cast<float>(model.layer_height));
    if (s < 0.0f || t < 0.0f || x >= model.layer_width || y >= model.layer_height) return nullptr;
    return model.layers.data() + camera * layer_bytes(model) +
           (static_cast<std::size_t>(y) * static_cast<std::size_t>(model.layer_width) +
            static_cast<std::size_t>(x)) *
               4;
}

// How surely the mask covers the surroundings of (s, t), in [0, 1].
float mask_near(const PersonModel& model, std::size_t camera, float s, float t) {
    // vertices of a hull lie on outlines: they count when the person is within two texels
    constexpr float kReach = 1.5f;
    const float ds = kReach / static_cast<float>(model.layer_width);
    const float dt = kReach / static_cast<float>(model.layer_height);
    int sum = 0;
    for (const auto& [x, y] : {std::pair{0.0f, 0.0f}, {ds, dt}, {-ds, dt}, {ds, -dt}, {-ds, -dt}}) {
        const std::uint8_t* found = texel(model, camera, s + x, t + y);
        if (found != nullptr) sum += found[3];
    }
    return std::min(1.0f, static_cast<float>(sum) / 255.0f);
}

// Mapping of undistorted pixels to the coarse picture of the mesh.
struct DepthWindow {
    Eigen::Vector2f origin_px = Eigen::Vector2f::Zero();
    float scale = 1.0f;
};

struct CameraStage {
    const CameraPicture& picture;
    std::size_t index;  // of the camera in the model
    const PersonModelOptions& options;
};

// Of no use are pixels beyond any picture, as lenses have them that somebody made up; NaN is not
// near either.
bool is_near_pictures(const Eigen::Vector2d& px) {
    constexpr double kFar_px = 1e6;
    return std::abs(px.x()) < kFar_px && std::abs(px.y()) < kFar_px;
}

void note_place(const CameraPicture& picture,
                const PersonModel& model,
                PersonModel::Camera& camera) {
    camera.intrinsics = picture.camera.intrinsics;
    camera.camera_from_site = picture.camera.camera_from_site;
    camera.centre_site = picture.camera.centre_site().cast<float>();
    camera.crop_px = picture.crop_px;
    const Eigen::Array2f layer_size =
        Eigen::Array2i(model.layer_width, model.layer_height).cast<float>();
    const Eigen::Array2i size(picture.width, picture.height);
    camera.low_st = Eigen::Array2f(kBorder, kBorder) / layer_size;
    camera.high_st = (size + kBorder).cast<float>() / layer_size;
}

// Per vertex: texture coordinates, and in `scratch.corners` undistorted pixels and inverse depth.
void project_vertices(const CameraStage& stage, PersonModel& model, PersonModelScratch& scratch) {
    const auto& [camera, crop, width, height, rgba] = stage.picture;
    const geometry::PinholeCamera& lens = camera.intrinsics;
    const Eigen::Matrix3d rotation = camera.camera_from_site.rotation.toRotationMatrix();
    const Eigen::Vector3d& translation = camera.camera_from_site.translation;
    const Eigen::Array2d texels_per_px(static_cast<double>(width) / crop.width,
                                       static_cast<double>(height) / crop.height);
    const Eigen::Array2d layer_size(model.layer_width, model.layer_height);
    const Eigen::Array2d crop_origin(crop.x - 0.5, crop.y - 0.5);
    auto& coordinates = model.cameras[stage.index].layer_coordinates;
    coordinates.resize(model.vertices_site.size());
    scratch.corners.resize(model.vertices_site.size());
    constexpr double kNearest = 0.05;  // [m] closer than this is as good as behind the camera
    // what faces away has no part in the picture: there, straight-line coordinates will do
    constexpr float kCosFacingAway = -0.3f;
    const bool is_distorted = lens.has_distortion();
    const Eigen::Vector3f& centre = model.cameras[stage.index].centre_site;
    for (std::size_t v = 0; v < coordinates.size(); ++v) {
        coordinates[v] = Eigen::Vector3f(0.0f, 0.0f, 1.0f);
        scratch.corners[v].setZero();
        const Eigen::Vector3d p = rotation * model.vertices_site[v].cast<double>() + translation;
        if (!(p.z() > kNearest)) continue;
        const Eigen::Vector2d px = lens.project(p);
        const bool bends = is_distorted && (centre - model.vertices_site[v]).dot(model.normals[v]) >
                                               kCosFacingAway * static_cast<float>(p.z());
        const Eigen::Vector2d in_picture = bends ? lens.distort(px) : px;
        if (!is_near_pictures(px) || !is_near_pictures(in_picture)) continue;
        const Eigen::Array2d st =
            ((in_picture.array() - crop_origin) * texels_per_px + kBorder) / layer_size;
        coordinates[v] = Eigen::Vector3d(st.x() * p.z(), st.y() * p.z(), p.z()).cast<float>();
        scratch.corners[v] = Eigen::Vector3d(px.x(), px.y(), 1.0 / p.z()).cast<float>();
    }
}

DepthWindow fit_depth_window(int long_side_px, PersonModelScratch& scratch) {
    Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9f);
    Eigen::Vector2f high = Eigen::Vector2f::Constant(-1e9f);
    for (const Eigen::Vector3f& corner : scratch.corners) {
        if (corner.z() <= 0.0f) continue;
        low = low.cwiseMin(corner.head<2>());
        high = high.cwiseMax(corner.head<2>());
    }
    DepthWindow window;
    if (low.x() > high.x()) {  // nothing is before this camera
        scratch.depth.width = scratch.depth.height = 1;
        return window;
    }
    const float extent = std::max((high - low).maxCoeff(), 1.0f);
    window.origin_px = low;
    window.scale = static_cast<float>(long_side_px - 1) / extent;
    scratch.depth.width = static_cast<int>((high.x() - low.x()) * window.scale) + 1;
    scratch.depth.height = static_cast<int>((high.y() - low.y()) * window.scale) + 1;
    for (Eigen::Vector3f& corner : scratch.corners)
        corner.head<2>() = (corner.head<2>() - low) * window.scale;
    return window;
}

// The vertices of a hull lie on outlines: there the mean normal is across the view of the cameras
// that made them, though a face beside them may be seen well. So each face is judged by itself, and
// a vertex by the face of its own that the camera sees best.
void judge_faces(const CameraStage& stage, PersonModelScratch& scratch, PersonModel& model) {
    PersonModel::Camera& camera = model.cameras[stage.index];
    const auto cos_min = static_cast<float>(stage.options.cos_min);
    const auto cos_full = static_cast<float>(stage.options.cos_full);
    camera.facing.resize(model.triangles.size());
    scratch.most_facing.assign(model.vertices_site.size(), -1.0f);
    for (std::size_t t = 0; t < model.triangles.size(); ++t) {
        const auto& triangle = model.triangles[t];
        const Eigen::Vector3f to_camera = camera.centre_site - model.vertices_site[triangle[0]];
        const float along = to_camera.dot(scratch.face_normals[t]);
        camera.facing[t] = 0.0f;
        if (along <= 0.0f) continue;
        const float cos_angle = along / to_camera.norm();
        camera.facing[t] = smooth_step(cos_min, cos_full, cos_angle);
        for (const std::uint32_t v : triangle)
            scratch.most_facing[v] = std::max(scratch.most_facing[v], cos_angle);
    }
}

void judge_vertices(const CameraStage& stage,
                    const DepthWindow& window,
                    PersonModelScratch& scratch,
                    PersonModel& model) {
    PersonModel::Camera& camera = model.cameras[stage.index];
    const PersonModelOptions& options = stage.options;
    const auto cos_min = static_cast<float>(options.cos_min);
    const auto cos_full = static_cast<float>(options.cos_full);
    // width of a pixel of the depth picture at a depth of one metre
    const float pixel_tangent =
        1.0f / (window.scale * static_cast<float>(stage.picture.camera.intrinsics.fx));
    camera.quality.assign(model.vertices_site.size(), 0.0f);
    for (std::size_t v = 0; v < camera.quality.size(); ++v) {
        const Eigen::Vector3f& corner = scratch.corners[v];
        if (!(corner.z() > 0.0f)) continue;
        const float cos_angle = scratch.most_facing[v];
        const float frontal = smooth_step(cos_min, cos_full, cos_angle);
        if (frontal <= 0.0f) continue;
        const Eigen::Vector3f& st = camera.layer_coordinates[v];
        const float mask = mask_near(model, stage.index, st.x() / st.z(), st.y() / st.z());
        if (mask <= 0.0f) continue;
        // slope-scaled: over the 3 x 3 pixels looked at, a slanted surface comes nearer by itself
        const float nearest = scratch.depth.nearest_around(corner.x(), corner.y());
        const float depth = 1.0f / corner.z();
        const float slope = std::sqrt(std::max(0.0f, 1.0f - cos_angle * cos_angle)) / cos_angle;
        const float bias = static_cast<float>(options.hidden_bias_m) +
                           1.5f * depth * pixel_tangent * std::min(slope, 4.0f);
        const float behind = nearest > 0.0f ? depth - 1.0f / nearest : 0.0f;
        const float hidden =
            std::clamp((behind - bias) / static_cast<float>(options.hidden_soft_m), 0.0f, 1.0f);
        camera.quality[v] = frontal * mask * (1.0f - hidden);
    }
}

// Colours of the vertices: the mean of what the cameras see; where none does, what the nearest
// vertices along the surface have.
void colour_vertices(PersonModel& model, PersonModelScratch& scratch) {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    std::size_t num_coloured = 0;
    model.fallback.assign(model.vertices_site.size(), Eigen::Vector3f::Zero());
    scratch.is_coloured.assign(model.vertices_site.size(), 0);
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
        Eigen::Vector4f sum = Eigen::Vector4f::Zero();
        for (std::size_t c = 0; c < model.cameras.size(); ++c) {
            const float quality = model.cameras[c].quality[v];
            if (quality <= 0.02f) continue;
            const Eigen::Vector3f& st = model.cameras[c].layer_coordinates[v];
            const std::uint8_t* rgba = texel(model, c, st.x() / st.z(), st.y() / st.z());
            if (rgba == nullptr) continue;
            sum += quality * Eigen::Vector4f(rgba[0], rgba[1], rgba[2], rgba[3]);
        }
        if (sum.w() <= 1.0f) continue;
        model.fallback[v] = sum.head<3>() / sum.w();
        scratch.is_coloured[v] = 1;
        mean += model.fallback[v];
        ++num_coloured;
    }
    mean = num_coloured > 0 ? Eigen::Vector3f(mean / static_cast<float>(num_coloured))
                            : Eigen::Vector3f::Constant(0.5f);

    constexpr int kMaxSteps = 24;  // edges; what lies farther away takes the mean colour
    for (int step = 0; step < kMaxSteps && num_coloured < model.fallback.size(); ++step) {
        const std::size_t before = num_coloured;
        for (const auto& triangle : model.triangles) {
            for (int i = 0; i < 3; ++i) {
                const std::uint32_t from = triangle[static_cast<std::size_t>(i)];
                const std::uint32_t to = triangle[static_cast<std::size_t>((i + 1) % 3)];
                if (scratch.is_coloured[from] == 0 || scratch.is_coloured[to] != 0) continue;
                model.fallback[to] = model.fallback[from];
                scratch.is_coloured[to] = 1;
                ++num_coloured;
            }
        }
        if (num_coloured == before) break;
    }
    for (std::size_t v = 0; v < model.fallback.size(); ++v)
        if (scratch.is_coloured[v] == 0) model.fallback[v] = mean;
}

}  // namespace

void build_person_model(const geometry::TriangleMesh& mesh_site,
                        std::span<const CameraPicture> pictures,
                        const PersonModelOptions& options,
                        PersonModelScratch& scratch,
                        PersonModel& out) {
    out.vertices_site.resize(mesh_site.vertices.size());
    std::transform(mesh_site.vertices.begin(),
                   mesh_site.vertices.end(),
                   out.vertices_site.begin(),
                   [](const Eigen::Vector3d& p) { return Eigen::Vector3f(p.cast<float>()); });
    out.triangles.assign(mesh_site.triangles.begin(), mesh_site.triangles.end());
    compute_normals(out, scratch);

    choose_layer_size(pictures, out);
    const auto num_cameras =
        static_cast<std::size_t>(std::count_if(pictures.begin(), pictures.end(), is_usable));
    out.cameras.resize(num_cameras);
    out.layers.assign(num_cameras * layer_bytes(out), 0);
    std::size_t index = 0;
    for (const CameraPicture& picture : pictures) {
        if (!is_usable(picture)) continue;
        assert(picture.rgba.size() == static_cast<std::size_t>(picture.width) *
                                          static_cast<std::size_t>(picture.height) * 4);
        note_place(picture, out, out.cameras[index]);
        fill_layer(picture, out, out.layers.data() + index * layer_bytes(out));
        const CameraStage stage{picture, index, options};
        project_vertices(stage, out, scratch);
        const DepthWindow window = fit_depth_window(options.depth_picture_px, scratch);
        draw_inverse_depth(scratch.corners, out.triangles, scratch.depth);
        judge_faces(stage, scratch, out);
        judge_vertices(stage, window, scratch, out);
        ++index;
    }
    even_colours(options.colour_evening, scratch.colour_evening, out);
    colour_vertices(out, scratch);
}

}  // namespace atrium::renderer
