#include "viewer/renderer/person/person_model.hpp"

#include "core/image/inverse_depth.hpp"
#include "viewer/renderer/person/fallback_colours.hpp"
#include "viewer/renderer/person/person_rows.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::renderer {

struct PersonModelScratch::Parts {
    Axes vertices;                        // as PersonModel::vertices_site
    std::vector<Eigen::Vector4f> points;  // the same
    std::vector<Eigen::Vector4f> normal_sums;
    std::vector<Eigen::Vector4f> normals;
    Faces faces;
    std::vector<float> cosines;  // per face: between its normal and the direction to the camera
    std::vector<std::array<std::uint32_t, 3>> facing;  // triangles that face the camera
    std::size_t num_facing = 0;
    std::vector<float> most_facing;  // per vertex: cosine of its face that faces the camera most
    Projected projected;
    std::vector<Eigen::Vector4f> corners;  // vertices in `depth`
    image::InverseDepthPicture depth;
    Seen seen;
    std::vector<std::vector<std::int32_t>> texels;  // per camera and vertex: index in its layer
    FallbackScratch fallback;
};

PersonModelScratch::PersonModelScratch() : parts(std::make_unique<Parts>()) {}
PersonModelScratch::PersonModelScratch(PersonModelScratch&&) noexcept = default;
PersonModelScratch& PersonModelScratch::operator=(PersonModelScratch&&) noexcept = default;
PersonModelScratch::~PersonModelScratch() = default;

namespace {

constexpr int kBorder = 1;             // texels of alpha 0 around each picture
constexpr int kLayerGranularity = 16;  // keeps the layer size stable

bool is_usable(const CameraPicture& picture) {
    return picture.width > 0 && picture.height > 0 && !picture.crop_px.empty();
}

// Computes area-weighted normals, smoothed once over the neighbours: those of a hull jump from
// strip to strip. The fourth component is 0 and lets the compiler use vector registers.
void compute_normals(PersonModel& model, PersonModelScratch::Parts& scratch) {
    const std::size_t num_vertices = model.vertices_site.size();
    auto& points = scratch.points;
    auto& sums = scratch.normal_sums;
    points.resize(num_vertices);
    for (std::size_t v = 0; v < num_vertices; ++v) {
        const Eigen::Vector3f& p = model.vertices_site[v];
        points[v] = {p.x(), p.y(), p.z(), 0.0f};
    }
    sums.assign(num_vertices, Eigen::Vector4f::Zero());
    scratch.faces.corners.resize(model.triangles.size());
    scratch.faces.normals.resize(model.triangles.size());
    for (std::size_t t = 0; t < model.triangles.size(); ++t) {
        const auto& [a, b, c] = model.triangles[t];
        const Eigen::Vector4f p = points[a];
        const Eigen::Vector4f twice_area = (points[b] - p).cross3(points[c] - p);
        for (const std::uint32_t v : {a, b, c}) sums[v] += twice_area;
        set(scratch.faces.corners, t, p.head<3>());
        set(scratch.faces.normals, t, twice_area.head<3>());
    }
    normalize(scratch.faces.normals, image::best_row_code());
    for (auto& n : sums) n.normalize();
    auto& normals = scratch.normals;
    normals = sums;
    for (const auto& [a, b, c] : model.triangles) {
        const Eigen::Vector4f mean = (sums[a] + sums[b] + sums[c]) * 0.25f;
        for (const std::uint32_t v : {a, b, c}) normals[v] += mean;
    }
    model.normals.resize(num_vertices);
    for (std::size_t v = 0; v < num_vertices; ++v)
        model.normals[v] = normals[v].normalized().head<3>();
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

// Copies the picture with its colour multiplied by alpha. Texels outside the mask then do not
// contribute to filtered texels, and a weighted sum of texels, divided by its alpha, is a colour of
// the person alone. Texels at the outline mix in some background: they count little beside those of
// other cameras and dominate only where there are no others.
void fill_layer(const CameraPicture& picture, const PersonModel& model, std::uint8_t* layer) {
    const image::RowCode code = image::best_row_code();
    const auto* from = reinterpret_cast<const std::uint32_t*>(picture.rgba.data());
    auto* to = reinterpret_cast<std::uint32_t*>(layer);
    const auto width = static_cast<std::size_t>(picture.width);
    const auto layer_width = static_cast<std::size_t>(model.layer_width);
    std::fill_n(to, kBorder * layer_width, 0U);
    to += kBorder * layer_width;
    for (int y = 0; y < picture.height; ++y, from += width, to += layer_width) {
        std::fill_n(to, kBorder, 0U);
        multiply_by_mask(y > 0 ? from - width : nullptr,
                         {from, width},
                         y + 1 < picture.height ? from + width : nullptr,
                         to + kBorder,
                         code);
        std::fill(to + kBorder + width, to + layer_width, 0U);
    }
    const int num_below = model.layer_height - kBorder - picture.height;
    std::fill_n(to, static_cast<std::size_t>(num_below) * layer_width, 0U);
}

// Coverage of the surroundings of a vertex by the mask, in [0, 1].
float mask_near(const PersonModel& model,
                const std::uint8_t* alpha,
                const Eigen::Vector3f& layer_coordinates) {
    // vertices of a hull lie on outlines; they count if the person is within two texels
    constexpr float kReach = 1.5f;
    const auto width = static_cast<float>(model.layer_width);
    const auto height = static_cast<float>(model.layer_height);
    const float x = layer_coordinates.x() / layer_coordinates.z() * width;
    const float y = layer_coordinates.y() / layer_coordinates.z() * height;
    constexpr float kMargin = 2.0f;
    const bool is_amid =
        x >= kMargin && y >= kMargin && x < width - kMargin && y < height - kMargin;
    const auto at = [&](float px, float py) {
        if (!is_amid && !(px >= 0.0f && py >= 0.0f && px < width && py < height)) return 0;
        return int{alpha[4 * (static_cast<std::ptrdiff_t>(py) * model.layer_width +
                              static_cast<std::ptrdiff_t>(px))]};
    };
    const int sum = at(x, y) + at(x + kReach, y + kReach) + at(x - kReach, y + kReach) +
                    at(x + kReach, y - kReach) + at(x - kReach, y - kReach);
    return std::min(1.0f, static_cast<float>(sum) / 255.0f);
}

struct CameraStage {
    const CameraPicture& picture;
    std::size_t index;  // index of the camera in the model
    const PersonModelOptions& options;
};

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

Projection projection_of(const CameraPicture& picture, const PersonModel& model) {
    const geometry::PinholeCamera& lens = picture.camera.intrinsics;
    const geometry::RigidTransform& pose = picture.camera.camera_from_site;
    Projection result{};
    Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(result.rotation.data()) =
        pose.rotation.toRotationMatrix().cast<float>();
    Eigen::Map<Eigen::Vector3f>(result.translation.data()) = pose.translation.cast<float>();
    result.fx = static_cast<float>(lens.fx);
    result.fy = static_cast<float>(lens.fy);
    result.cx = static_cast<float>(lens.cx);
    result.cy = static_cast<float>(lens.cy);
    result.skew = static_cast<float>(lens.skew);
    std::transform(
        lens.distortion.begin(), lens.distortion.end(), result.distortion.begin(), [](double k) {
            return static_cast<float>(k);
        });
    const image::PixelRect& crop = picture.crop_px;
    const Eigen::Array2d texels_per_px(static_cast<double>(picture.width) / crop.width,
                                       static_cast<double>(picture.height) / crop.height);
    const Eigen::Array2d layer_size(model.layer_width, model.layer_height);
    const Eigen::Array2d crop_origin(crop.x - 0.5, crop.y - 0.5);
    Eigen::Map<Eigen::Array2f>(result.st_per_px.data()) =
        (texels_per_px / layer_size).cast<float>();
    Eigen::Map<Eigen::Array2f>(result.st_offset.data()) =
        ((kBorder - crop_origin * texels_per_px) / layer_size).cast<float>();
    result.layer_size = {model.layer_width, model.layer_height};
    return result;
}

// Computes the texture coordinates per vertex, and in `scratch.projected` undistorted pixels and
// inverse depths.
void project_vertices(const CameraStage& stage,
                      PersonModel& model,
                      PersonModelScratch::Parts& scratch) {
    project_points(projection_of(stage.picture, model),
                   scratch.vertices,
                   scratch.projected,
                   image::best_row_code());
    const std::size_t num_vertices = model.vertices_site.size();
    model.cameras[stage.index].layer_coordinates.resize(num_vertices);
    Eigen::Vector3f* coordinates = model.cameras[stage.index].layer_coordinates.data();
    const float* s = scratch.projected.in_layer.x.data();
    const float* t = scratch.projected.in_layer.y.data();
    const float* depth = scratch.projected.in_layer.z.data();
    for (std::size_t v = 0; v < num_vertices; ++v) coordinates[v] = {s[v], t[v], depth[v]};
    std::swap(scratch.projected.texels, scratch.texels[stage.index]);
}

// Judges each face by itself, and a vertex by the face that the camera sees best. The vertices of a
// hull lie on outlines: their mean normal is perpendicular to the view of the cameras that cut
// them, although these cameras may see a neighbouring face well.
Facing facing_limits(const PersonModelOptions& options) {
    return {static_cast<float>(options.cos_min), static_cast<float>(options.cos_full)};
}

void judge_faces(const CameraStage& stage, PersonModelScratch::Parts& scratch, PersonModel& model) {
    PersonModel::Camera& camera = model.cameras[stage.index];
    judge_facing(scratch.faces,
                 camera.centre_site,
                 facing_limits(stage.options),
                 scratch.cosines,
                 camera.facing,
                 image::best_row_code());
    scratch.most_facing.assign(model.vertices_site.size(), -1.0f);
    const std::size_t num_triangles = model.triangles.size();
    scratch.facing.resize(num_triangles);
    const float* cosines = scratch.cosines.data();
    const std::array<std::uint32_t, 3>* triangles = model.triangles.data();
    std::array<std::uint32_t, 3>* facing = scratch.facing.data();
    float* most_facing = scratch.most_facing.data();
    for (std::size_t t = 0; t < num_triangles; ++t) {
        const float cosine = cosines[t];
        if (!(cosine > 0.0f)) continue;
        *facing++ = triangles[t];
        for (const std::uint32_t v : triangles[t])
            most_facing[v] = std::max(most_facing[v], cosine);
    }
    scratch.num_facing = static_cast<std::size_t>(facing - scratch.facing.data());
}

void judge_vertices(const CameraStage& stage,
                    PersonModelScratch::Parts& scratch,
                    PersonModel& model) {
    PersonModel::Camera& camera = model.cameras[stage.index];
    const Seeing seeing{
        facing_limits(stage.options),
        static_cast<float>(stage.options.hidden_bias_m),
        static_cast<float>(stage.options.hidden_soft_m),
        1.0f / (scratch.depth.scale * static_cast<float>(stage.picture.camera.intrinsics.fx))};
    const std::uint8_t* alpha = model.layers.data() + stage.index * layer_bytes(model) + 3;
    const std::int32_t* texels = scratch.texels[stage.index].data();
    const float* most_facing = scratch.most_facing.data();
    const Eigen::Vector4f* corners = scratch.corners.data();
    const std::size_t num_vertices = model.vertices_site.size();
    camera.quality.assign(num_vertices, 0.0f);
    Seen& seen = scratch.seen;
    seen.reserve(num_vertices);
    seen.size = 0;
    for (std::size_t v = 0; v < num_vertices; ++v) {
        const float cosine = most_facing[v];
        const float inverse_depth = corners[v].z();
        if (!(cosine > seeing.facing.cos_min && inverse_depth > 0.0f)) continue;
        float mask = 1.0f;
        if (alpha[4 * std::ptrdiff_t{texels[v]}] != 255) {
            mask = mask_near(model, alpha, camera.layer_coordinates[v]);
            if (mask <= 0.0f) continue;
        }
        const std::size_t i = seen.size++;
        seen.vertices[i] = static_cast<std::uint32_t>(v);
        seen.cosines[i] = cosine;
        seen.inverse_depths[i] = inverse_depth;
        seen.masks[i] = mask;
        seen.nearest[i] = scratch.depth.nearest_around(static_cast<int>(corners[v].x() + 0.5f),
                                                       static_cast<int>(corners[v].y() + 0.5f));
    }
    judge_seen(seeing, seen, camera.quality, image::best_row_code());
}

}  // namespace

void build_person_model(const geometry::TriangleMesh& mesh_site,
                        std::span<const CameraPicture> pictures,
                        const PersonModelOptions& options,
                        PersonModelScratch& all_scratch,
                        PersonModel& out) {
    PersonModelScratch::Parts& scratch = *all_scratch.parts;
    out.vertices_site.resize(mesh_site.vertices.size());
    std::transform(mesh_site.vertices.begin(),
                   mesh_site.vertices.end(),
                   out.vertices_site.begin(),
                   [](const Eigen::Vector3d& p) { return Eigen::Vector3f(p.cast<float>()); });
    out.bounds_site.setEmpty();
    for (const Eigen::Vector3f& p : out.vertices_site) out.bounds_site.extend(p);
    scratch.vertices.resize(out.vertices_site.size());
    for (std::size_t v = 0; v < out.vertices_site.size(); ++v)
        set(scratch.vertices, v, out.vertices_site[v]);
    out.triangles.assign(mesh_site.triangles.begin(), mesh_site.triangles.end());
    compute_normals(out, scratch);

    choose_layer_size(pictures, out);
    const auto num_cameras =
        static_cast<std::size_t>(std::count_if(pictures.begin(), pictures.end(), is_usable));
    out.cameras.resize(num_cameras);
    scratch.texels.resize(num_cameras);
    out.layers.resize(num_cameras * layer_bytes(out));
    std::size_t index = 0;
    for (const CameraPicture& picture : pictures) {
        if (!is_usable(picture)) continue;
        assert(picture.rgba.size() == static_cast<std::size_t>(picture.width) *
                                          static_cast<std::size_t>(picture.height) * 4);
        note_place(picture, out, out.cameras[index]);
        fill_layer(picture, out, out.layers.data() + index * layer_bytes(out));
        const CameraStage stage{picture, index, options};
        project_vertices(stage, out, scratch);
        image::fit_inverse_depth(scratch.projected.undistorted,
                                 options.depth_picture_px,
                                 scratch.corners,
                                 scratch.depth);
        judge_faces(stage, scratch, out);
        image::draw_inverse_depth(
            scratch.corners, std::span(scratch.facing).first(scratch.num_facing), scratch.depth);
        judge_vertices(stage, scratch, out);
        ++index;
    }
    compensate_gains(options.gain_compensation, all_scratch.gain_compensation, out);
    find_fallback_colours(scratch.texels, scratch.fallback, out);
}

}  // namespace atrium::renderer
