#include "site_node/motion/camera_evidence.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace atrium::motion {
namespace {

constexpr int kMarginPx = 4;       // of the canvas around both pictures
constexpr int kCanvasStepPx = 16;  // its size changes rarely

float quarter_at(float off_sq, float scale) {
    const float ratio = 1.0F + off_sq / (scale * scale);
    return 1.0F / (ratio * ratio);
}

int round_up(int value, int step) { return (value + step - 1) / step * step; }

// Holds both rectangles and a margin.
image::PixelRect canvas_for(const image::PixelRect& a, const image::PixelRect& b) {
    const int x0 = std::min(a.x, b.x) - kMarginPx;
    const int y0 = std::min(a.y, b.y) - kMarginPx;
    const int x1 = std::max(a.x + a.width, b.x + b.width) + kMarginPx;
    const int y1 = std::max(a.y + a.height, b.y + b.height) + kMarginPx;
    return {x0,
            y0,
            round_up(std::max(x1 - x0, flow::kMinFlowPx), kCanvasStepPx),
            round_up(std::max(y1 - y0, flow::kMinFlowPx), kCanvasStepPx)};
}

void add_equations(const Eigen::Matrix<float, 2, 3>& px_per_m,
                   const Eigen::Matrix2f& trust,
                   const Eigen::Vector2f& trusted_flow,
                   float weight,
                   PointEquations& equations) {
    equations.lhs += px_per_m.transpose() * (weight * trust * px_per_m);
    equations.rhs += px_per_m.transpose() * (weight * trusted_flow);
}

}  // namespace

CameraEvidence::CameraEvidence(const geometry::CalibratedCamera& camera,
                               const SurfaceMotionOptions& options)
    : camera_(camera),
      options_(options),
      rotation_(camera.camera_from_site.rotation.toRotationMatrix()),
      centre_site_(camera.centre_site()) {}

Eigen::Vector2d CameraEvidence::canvas_px(const Eigen::Vector3d& p_camera) const {
    Eigen::Vector2d px = camera_.intrinsics.project(p_camera);
    if (camera_.intrinsics.has_distortion()) px = camera_.intrinsics.distort(px);
    return reduced_px(px) - Eigen::Vector2d(canvas_.x, canvas_.y);
}

void CameraEvidence::look(const geometry::TriangleMesh& mesh_site,
                          const SurfacePoints& surface,
                          const MotionPicture& now,
                          const MotionPicture& before) {
    clear();
    if (now.empty() || before.empty()) return;
    find_flow(now, before);
    picture_now_ = &now;
    depths_.draw(mesh_site, camera_, canvas_);
    for (std::size_t cell = 0; cell < surface.num_cells(); ++cell) {
        first_of_cell_.push_back(static_cast<std::uint32_t>(sights_.size()));
        const std::uint32_t first = surface.first_of_cell[cell];
        for (std::uint32_t i = first; i < surface.first_of_cell[cell + 1]; ++i)
            see(surface.points[i], i - first);
    }
    first_of_cell_.push_back(static_cast<std::uint32_t>(sights_.size()));
}

void CameraEvidence::find_flow(const MotionPicture& now, const MotionPicture& before) {
    canvas_ = canvas_for(now.rect, before.rect);
    copy_part(now, canvas_, now_);
    copy_part(before, canvas_, before_);
    before_values_.assign(before_.data.begin(), before_.data.end());
    dense_flow_.compute(now_, before_, flow_);
}

void CameraEvidence::see(const SurfacePoint& point, std::uint32_t index) {
    const auto facing =
        static_cast<float>((centre_site_ - point.position).normalized().dot(point.normal));
    if (facing < options_.least_facing) return;
    const Eigen::Vector3d p = rotation_ * point.position + camera_.camera_from_site.translation;
    if (p.z() < kNearestSurface_m) return;
    const Eigen::Vector2d place = canvas_px(p);
    constexpr int kBorder = kHalf + 1;
    // written so that a place that is not a number is refused
    if (!(place.x() >= kBorder && place.y() >= kBorder && place.x() < canvas_.width - kBorder - 1 &&
          place.y() < canvas_.height - kBorder - 1))
        return;
    const int column = static_cast<int>(std::lround(place.x()));
    const int row = static_cast<int>(std::lround(place.y()));
    const auto inverse_depth = static_cast<float>(1.0 / p.z());
    const float nearest = depths_.inverse_depth(column, row);
    if (nearest > 0.0F && 1.0F / nearest < 1.0F / inverse_depth - options_.hidden_m) return;

    Sight& sight = sights_.emplace_back();
    sight.point = index;
    sight.column = column - kHalf;
    sight.row = row - kHalf;
    sight.weight = facing;
    sight.place_px = place.cast<float>();
    if (!take_patch(inverse_depth, sight)) {
        sights_.pop_back();
        return;
    }
    sight.flow_px = -flow_.at(column, row);
    constexpr double kStep_m = 1e-3;  // of the numerical derivative; bends of a lens are longer
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d moved = p + kStep_m * rotation_.col(axis);
        sight.px_per_m.col(axis) = ((canvas_px(moved) - place) / kStep_m).cast<float>();
    }
}

// False if too few pixels around the point belong to its surface.
bool CameraEvidence::take_patch(float inverse_depth, Sight& sight) const {
    Patch& patch = sight.patch;
    const float depth_m = 1.0F / inverse_depth;
    // bounds of the inverse depths of the same surface
    const float furthest = 1.0F / (depth_m + options_.same_depth_m);
    const float nearest = 1.0F / std::max(1e-3F, depth_m - options_.same_depth_m);
    const image::Mask& mask = picture_now_->mask;
    const int to_mask_x = canvas_.x - picture_now_->rect.x;
    const int to_mask_y = canvas_.y - picture_now_->rect.y;
    const auto shows = [&](int x, int y) {
        const int mx = x + to_mask_x;
        const int my = y + to_mask_y;
        return mx >= 0 && my >= 0 && mx < mask.width && my < mask.height && mask.at(mx, my) != 0;
    };
    float sum_x = 0.0F, sum_y = 0.0F;
    int num = 0;
    for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
            const int x = sight.column + i;
            const int y = sight.row + j;
            const float inverse = depths_.inverse_depth(x, y);
            if (inverse < furthest || inverse > nearest) continue;
            // the gradient must not reach across the outline
            if (!shows(x, y) || !shows(x - 1, y) || !shows(x + 1, y) || !shows(x, y - 1) ||
                !shows(x, y + 1))
                continue;
            const auto at = static_cast<std::size_t>(j * kStride + i);
            patch.gradient_x[at] = 0.5F * static_cast<float>(now_.at(x + 1, y) - now_.at(x - 1, y));
            patch.gradient_y[at] = 0.5F * static_cast<float>(now_.at(x, y + 1) - now_.at(x, y - 1));
            patch.value[at] = static_cast<float>(now_.at(x, y));
            patch.is_valid[at] = 1.0F;
            sum_x += patch.gradient_x[at];
            sum_y += patch.gradient_y[at];
            ++num;
        }
    }
    if (num < options_.least_pixels) return false;
    sight.num_valid = static_cast<float>(num);
    float xx = 0.0F, xy = 0.0F, yy = 0.0F;
    for (std::size_t at = 0; at < patch.value.size(); ++at) {
        patch.gradient_x[at] -= patch.is_valid[at] * sum_x / sight.num_valid;
        patch.gradient_y[at] -= patch.is_valid[at] * sum_y / sight.num_valid;
        xx += patch.gradient_x[at] * patch.gradient_x[at];
        xy += patch.gradient_x[at] * patch.gradient_y[at];
        yy += patch.gradient_y[at] * patch.gradient_y[at];
    }
    Eigen::Matrix2f structure;
    structure << xx, xy, xy, yy;
    structure /= sight.num_valid;
    const Eigen::Matrix2f damped = structure + options_.noise_sq * Eigen::Matrix2f::Identity();
    sight.step = damped.inverse();
    sight.trust = structure * sight.step;
    sight.step /= sight.num_valid;
    return true;
}

void CameraEvidence::add_flow(std::size_t cell,
                              float scale_px,
                              std::span<const Eigen::Vector3d> displacements,
                              std::span<PointEquations> equations) const {
    if (sights_.empty()) return;
    for (std::uint32_t i = first_of_cell_[cell]; i < first_of_cell_[cell + 1]; ++i) {
        const Sight& sight = sights_[i];
        const Eigen::Vector2f off_px =
            sight.flow_px - sight.px_per_m * displacements[sight.point].cast<float>();
        const float fits = quarter_at((sight.trust * off_px).squaredNorm(), scale_px);
        PointEquations& own = equations[sight.point];
        add_equations(
            sight.px_per_m, sight.trust, sight.trust * sight.flow_px, sight.weight * fits, own);
        own.seen += sight.weight;
        own.explained += sight.weight * fits;
    }
}

// Compares a patch with the picture before, displaced by `moved_px`. False where it leaves the
// canvas. `step_px`: how much further the patch is, damped where it lacks texture.
bool CameraEvidence::compare(const Sight& sight,
                             const Eigen::Vector2f& moved_px,
                             Eigen::Vector2f& step_px,
                             float& difference_sq) const {
    const float x = static_cast<float>(sight.column) + moved_px.x();
    const float y = static_cast<float>(sight.row) + moved_px.y();
    if (!(x >= 0.0F && y >= 0.0F && x + kStride + 1 < static_cast<float>(canvas_.width) &&
          y + kStride + 1 < static_cast<float>(canvas_.height)))
        return false;
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    const float right = x - static_cast<float>(column);
    const float down = y - static_cast<float>(row);
    const std::array<float, 4> shares{
        (1.0F - right) * (1.0F - down), right * (1.0F - down), (1.0F - right) * down, right * down};
    // sums per column of the patch, for SIMD
    std::array<float, kStride> sums_x{}, sums_y{}, sums{}, sums_sq{};
    const Patch& patch = sight.patch;
    for (int j = 0; j < kSide; ++j) {
        const float* const upper =
            before_values_.data() + static_cast<std::ptrdiff_t>(row + j) * canvas_.width + column;
        const float* const lower = upper + canvas_.width;
        const std::size_t first = static_cast<std::size_t>(j) * kStride;
        for (std::size_t i = 0; i < kStride; ++i) {
            const float before = shares[0] * upper[i] + shares[1] * upper[i + 1] +
                                 shares[2] * lower[i] + shares[3] * lower[i + 1];
            const float off = (before - patch.value[first + i]) * patch.is_valid[first + i];
            sums_x[i] += patch.gradient_x[first + i] * off;
            sums_y[i] += patch.gradient_y[first + i] * off;
            sums[i] += off;
            sums_sq[i] += off * off;
        }
    }
    Eigen::Vector2f slope = Eigen::Vector2f::Zero();
    float sum = 0.0F, sum_sq = 0.0F;
    for (std::size_t i = 0; i < kStride; ++i) {
        slope += Eigen::Vector2f(sums_x[i], sums_y[i]);
        sum += sums[i];
        sum_sq += sums_sq[i];
    }
    step_px = -(sight.step * slope);
    const float mean = sum / sight.num_valid;
    difference_sq = std::max(0.0F, sum_sq / sight.num_valid - mean * mean);
    return true;
}

void CameraEvidence::add_patches(std::size_t cell,
                                 const SurfacePoints& surface,
                                 std::span<const Eigen::Vector3d> displacements,
                                 std::span<PointEquations> equations) const {
    if (sights_.empty()) return;
    constexpr float kMaxStepPx = 1.5F;
    for (std::uint32_t i = first_of_cell_[cell]; i < first_of_cell_[cell + 1]; ++i) {
        const Sight& sight = sights_[i];
        const Eigen::Vector3d& displacement = displacements[sight.point];
        PointEquations& own = equations[sight.point];
        own.seen += sight.weight;
        const Eigen::Vector3d before =
            surface.points[surface.first_of_cell[cell] + sight.point].position - displacement;
        const Eigen::Vector3d p = rotation_ * before + camera_.camera_from_site.translation;
        if (p.z() < kNearestSurface_m) continue;
        const Eigen::Vector2f moved_px = canvas_px(p).cast<float>() - sight.place_px;
        Eigen::Vector2f step_px;
        float difference_sq = 0.0F;
        if (!compare(sight, moved_px, step_px, difference_sq)) continue;
        const float length = step_px.norm();
        if (length > kMaxStepPx) step_px *= kMaxStepPx / length;
        const float fits = quarter_at(difference_sq, options_.differs) *
                           quarter_at(step_px.squaredNorm(), options_.settled_px);
        // relative to the linear prediction: the solution is a displacement, not a change of it
        const Eigen::Vector2f predicted_px = sight.px_per_m * displacement.cast<float>();
        add_equations(sight.px_per_m,
                      sight.trust,
                      sight.trust * predicted_px - step_px,
                      sight.weight * fits,
                      own);
        own.explained += sight.weight * fits;
    }
}

}  // namespace atrium::motion
