#include "simulation/model.hpp"

#include "core/geometry/aabb.hpp"
#include "simulation/model_rig.hpp"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::simulation {
namespace {

constexpr double kMinHeight_m = 0.5;
constexpr double kMaxHeight_m = 2.5;
constexpr double kUsualHeight_m = 1.75;

// Rotates the file's axes to +Z up and +Y forwards.
Eigen::Matrix3d upright(bool is_z_up) {
    Eigen::Matrix3d turn;
    if (is_z_up) {
        turn << -1, 0, 0, 0, -1, 0, 0, 0, 1;
    } else {
        turn << -1, 0, 0, 0, 0, 1, 0, 1, 0;
    }
    return turn;
}

geometry::Aabb box_of(const std::vector<Eigen::Vector3f>& positions, const Eigen::Matrix3d& turn) {
    geometry::Aabb box;
    for (const Eigen::Vector3f& p : positions) box.add(turn * p.cast<double>());
    return box;
}

}  // namespace

struct Model::Impl {
    ModelParts parts;
    double loop_s = 0.0;        // of the room
    double file_s_per_s = 0.0;  // speed of the animation
    Eigen::Affine3f site_from_file = Eigen::Affine3f::Identity();

    void pose(double time_s, std::vector<Eigen::Affine3f>& scratch, PosedSkin& out) const {
        const double in_loop_s = std::fmod(time_s, loop_s);
        const double duration_s = parts.rig.duration_s;
        const double in_file_s =
            duration_s > 0.0 ? std::fmod(in_loop_s * file_s_per_s, duration_s) : 0.0;
        pose_rig(parts.rig, in_file_s, scratch, out);
    }

    // Derives scale and position from the volume that the animation covers.
    Expected<void> stand(const RoomOptions& options) {
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(options.heading_rad + options.model_turn_rad,
                                                       Eigen::Vector3d::UnitZ()) *
                                     upright(parts.rig.is_z_up);
        constexpr int kNumSamples = 24;
        std::vector<Eigen::Affine3f> scratch;
        PosedSkin skin;
        geometry::Aabb all;
        double height = 0.0;
        for (int i = 0; i < kNumSamples; ++i) {
            pose(loop_s * i / kNumSamples, scratch, skin);
            const geometry::Aabb box = box_of(skin.positions, turn);
            if (i == 0) height = box.size().z();
            all.add(box.min);
            all.add(box.max);
        }
        if (!(height > 0.0) || !std::isfinite(height) || !all.size().allFinite()) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}: the model has no height", options.model.string()));
        }
        const bool is_a_persons = height >= kMinHeight_m && height <= kMaxHeight_m;
        const double wanted_m = options.model_height_m > 0.0 ? options.model_height_m
                                : is_a_persons               ? height
                                                             : kUsualHeight_m;
        const double scale = wanted_m / height;
        const Eigen::Vector3d foot(
            0.5 * (all.min.x() + all.max.x()), 0.5 * (all.min.y() + all.max.y()), all.min.z());
        site_from_file.linear() = (scale * turn).cast<float>();
        site_from_file.translation() = (options.position_m - scale * foot).cast<float>();
        return {};
    }
};

Model::Model(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

Expected<Model> Model::load(const RoomOptions& options) {
    if (auto valid = check(options); !valid) return tl::unexpected(valid.error());
    if (!std::filesystem::is_regular_file(options.model)) {
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("simulation.model: '{}': no such file", options.model.string()));
    }
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(options.model.string(),
                                             aiProcess_Triangulate | aiProcess_GenSmoothNormals |
                                                 aiProcess_SortByPType | aiProcess_FlipUVs |
                                                 aiProcess_ValidateDataStructure);
    if (scene == nullptr) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format(
                "simulation.model: '{}': {}", options.model.string(), importer.GetErrorString()));
    }
    auto parts = take_model(*scene, options.model);
    if (!parts) return tl::unexpected(parts.error());
    auto impl = std::make_unique<Impl>();
    impl->parts = std::move(*parts);
    impl->loop_s = options.num_frames() / options.rate_hz;
    const double duration_s = impl->parts.rig.duration_s;
    if (duration_s > 0.0) {
        const double num_repeats = std::max(1.0, std::round(impl->loop_s / duration_s));
        impl->file_s_per_s = num_repeats * duration_s / impl->loop_s;
    }
    if (auto stands = impl->stand(options); !stands) return tl::unexpected(stands.error());
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

}  // namespace atrium::simulation
