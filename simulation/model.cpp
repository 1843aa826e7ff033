#include "simulation/model.hpp"

#include "core/geometry/aabb.hpp"
#include "simulation/model_nodes.hpp"
#include "simulation/model_stand.hpp"

#include <assimp/Importer.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::simulation {
namespace {

constexpr int kNumLoopSamples = 24;  // of the animation, to find the volume that it covers

geometry::Aabb box_of(const std::vector<Eigen::Vector3f>& positions, const Eigen::Matrix3d& turn) {
    geometry::Aabb box;
    for (const Eigen::Vector3f& p : positions) box.add(turn * p.cast<double>());
    return box;
}

Eigen::Vector3d centroid_of(const std::vector<Eigen::Vector3f>& positions) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& p : positions) sum += p.cast<double>();
    return sum / static_cast<double>(std::max<std::size_t>(1, positions.size()));
}

double farthest(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b) {
    double distance = 0.0;
    for (std::size_t v = 0; v < a.size(); ++v)
        distance = std::max(distance, static_cast<double>((a[v] - b[v]).norm()));
    return distance;
}

}  // namespace

struct Model::Impl {
    ModelParts parts;
    ModelReport report;
    double loop_s = 0.0;                              // of the room
    double file_s_per_s = 0.0;                        // speed of the animation
    Eigen::Vector3d drift = Eigen::Vector3d::Zero();  // per animation, taken back; file's frame
    Eigen::Affine3f site_from_file = Eigen::Affine3f::Identity();

    void pose(double time_s, std::vector<Eigen::Affine3f>& scratch, PosedSkin& out) const {
        const double in_loop_s = std::fmod(time_s, loop_s);
        const double duration_s = parts.rig.duration_s;
        const double in_file_s =
            duration_s > 0.0 ? std::fmod(in_loop_s * file_s_per_s, duration_s) : 0.0;
        pose_rig(parts.rig, in_file_s, scratch, out);
        if (drift.isZero()) return;
        const Eigen::Vector3f back = (-in_file_s / duration_s * drift).cast<float>();
        for (Eigen::Vector3f& p : out.positions) p += back;
    }

    void find_drift(const Standing& standing);
    Expected<void> stand(const RoomOptions& options);
    void fill_report();
};

// A walk that leaves is walked on the spot: the room's loop would jump back, and the cameras see
// only its middle.
void Model::Impl::find_drift(const Standing& standing) {
    constexpr double kMostHeights = 0.25;
    if (parts.rig.duration_s <= 0.0) return;
    std::vector<Eigen::Affine3f> scratch;
    PosedSkin skin;
    pose_rig(parts.rig, 0.0, scratch, skin);
    const Eigen::Vector3d begin = centroid_of(skin.positions);
    pose_rig(parts.rig, parts.rig.duration_s, scratch, skin);
    Eigen::Vector3d moved = standing.upright * (centroid_of(skin.positions) - begin);
    moved.z() = 0.0;
    if (!(moved.norm() > kMostHeights * standing.height)) return;
    drift = standing.upright.transpose() * moved;
}

// Derives scale and position from the standing height and the volume that the animation covers.
Expected<void> Model::Impl::stand(const RoomOptions& options) {
    const Standing standing = find_standing(parts.rig);
    parts.warnings.insert(parts.warnings.end(), standing.warnings.begin(), standing.warnings.end());
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(options.heading_rad + options.model_turn_rad, Eigen::Vector3d::UnitZ()) *
        standing.upright;
    find_drift(standing);
    std::vector<Eigen::Affine3f> scratch;
    PosedSkin first;
    PosedSkin skin;
    geometry::Aabb all;
    double farthest_moved = 0.0;
    for (int i = 0; i < kNumLoopSamples; ++i) {
        pose(loop_s * i / kNumLoopSamples, scratch, skin);
        if (i == 0) first = skin;
        farthest_moved = std::max(farthest_moved, farthest(skin.positions, first.positions));
        const geometry::Aabb box = box_of(skin.positions, turn);
        all.add(box.min);
        all.add(box.max);
    }
    if (!(standing.height > 0.0) || !std::isfinite(standing.height) || !all.size().allFinite()) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: the model has no height", options.model.string()));
    }
    const double scale = options.model_height_m > 0.0
                             ? options.model_height_m / standing.height
                             : metres_per_unit(parts.rig, standing.height, parts.warnings);
    const Eigen::Vector3d foot(
        0.5 * (all.min.x() + all.max.x()), 0.5 * (all.min.y() + all.max.y()), all.min.z());
    site_from_file.linear() = (scale * turn).cast<float>();
    site_from_file.translation() = (options.position_m - scale * foot).cast<float>();
    report.height_m = scale * standing.height;
    if (parts.rig.duration_s <= 0.0) {
        parts.warnings.emplace_back(
            "the model has no animation and stands still. Give one with simulation.motion_file");
    } else if (farthest_moved < 1e-3 * standing.height) {
        parts.warnings.emplace_back(
            parts.rig.num_skin_bones == 0
                ? "the animation moves bones, but the mesh has no bone weights and stands still. "
                  "Export the model with its skin"
                : "the animation moves no part of the mesh. Give a motion of the model's bones "
                  "with "
                  "simulation.motion_file");
    }
    return {};
}

void Model::Impl::fill_report() {
    report.num_vertices = parts.rig.positions.size();
    report.num_bones = parts.rig.num_skin_bones;
    report.num_textures = parts.surface.textures.size();
    report.animation = parts.rig.animation;
    report.animation_s = parts.rig.duration_s;
    report.warnings = std::move(parts.warnings);
}

Model::Model(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

Expected<Model> Model::load(const RoomOptions& options) {
    if (auto valid = check(options); !valid) return tl::unexpected(valid.error());
    Assimp::Importer importer;
    const auto scene = read_scene("simulation.model", options.model, importer);
    if (!scene) return tl::unexpected(scene.error());
    auto parts = take_model(**scene, options.model);
    if (!parts) return tl::unexpected(parts.error());
    if (!options.motion_file.empty()) {
        const auto motion = read_motion(options.motion_file);
        if (!motion) return tl::unexpected(motion.error());
        if (auto applied = apply_motion(*motion, options.motion_file, parts->rig); !applied)
            return tl::unexpected(applied.error());
    }
    auto impl = std::make_unique<Impl>();
    impl->parts = std::move(*parts);
    impl->loop_s = options.num_frames() / options.rate_hz;
    const double duration_s = impl->parts.rig.duration_s;
    if (duration_s > 0.0) {
        const double num_repeats = std::max(1.0, std::round(impl->loop_s / duration_s));
        impl->file_s_per_s = num_repeats * duration_s / impl->loop_s;
    }
    if (auto stands = impl->stand(options); !stands) return tl::unexpected(stands.error());
    impl->fill_report();
    return Model(std::move(impl));
}

void Model::pose(double time_s, PosedSkin& out) const {
    std::vector<Eigen::Affine3f> scratch;
    impl_->pose(time_s, scratch, out);
    const Eigen::Matrix3f turn =
        impl_->site_from_file.linear() / std::cbrt(impl_->site_from_file.linear().determinant());
    for (Eigen::Vector3f& p : out.positions) p = impl_->site_from_file * p;
    for (Eigen::Vector3f& n : out.normals) n = turn * n;
}

const ModelSurface& Model::surface() const { return impl_->parts.surface; }
const ModelReport& Model::report() const { return impl_->report; }

Expected<ModelReport> examine_model(const RoomOptions& options) {
    const auto model = Model::load(options);
    if (!model) return tl::unexpected(model.error());
    return model->report();
}

std::string describe(const ModelReport& report) {
    const auto count = [](std::size_t num, const char* what) {
        return num == 0   ? fmt::format("no {}s", what)
               : num == 1 ? fmt::format("1 {}", what)
                          : fmt::format("{} {}s", num, what);
    };
    return fmt::format(
        "height {:.2f} m, {}, {} vertices, {}, {}",
        report.height_m,
        count(report.num_bones, "bone"),
        report.num_vertices,
        count(report.num_textures, "texture"),
        report.animation_s > 0.0
            ? fmt::format("animation '{}' of {:.1f} s", report.animation, report.animation_s)
            : std::string("no animation"));
}

}  // namespace atrium::simulation
