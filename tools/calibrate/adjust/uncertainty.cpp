#include "tools/calibrate/adjust/uncertainty.hpp"

#include "core/geometry/alignment.hpp"
#include "tools/calibrate/adjust/reprojection.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace atrium::calibrate {
namespace {

constexpr int kPoseValues = 6, kLensValues = 8;
constexpr int kCameraValues = kPoseValues + kLensValues;
// Standard deviations of values that nothing determines, wide ones.
constexpr double kOpenTurn_rad = 1.0, kOpenShift_m = 10.0;
constexpr std::array<double, kLensValues> kOpenLens{0.7, 0.1, 0.1, 1.0, 1.0, 0.01, 0.01, 1.0};

using CameraRows = Eigen::Matrix<double, 2, kCameraValues>;
using WandRows = Eigen::Matrix<double, 2, kPoseValues>;

geometry::RigidTransform turned(const geometry::RigidTransform& pose, int k, double step) {
    geometry::RigidTransform moved = pose;
    if (k < 3) {
        const Eigen::Vector3d axis = Eigen::Vector3d::Unit(k);
        moved.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(step, axis)) * pose.rotation;
    } else {
        moved.translation[k - 3] += step;
    }
    return moved;
}

// Derivatives by values in units of 1 rad, 1 m; f as a share, cx and cy in pictures' widths.
// Rotations are turned about the axes of the frame that they lead to.
struct Rows {
    CameraRows camera;
    WandRows wand;
};

std::optional<Rows> rows_of(const Bundle& bundle, const Sighting& sighting) {
    const BundleCamera& camera = bundle.cameras[sighting.camera];
    const geometry::RigidTransform pose = camera.camera_from_world();
    const geometry::RigidTransform& wand = bundle.wands[sighting.instant].world_from_wand;
    const Eigen::Vector3d light = wand.rotation * bundle.wand.lights_m[sighting.light];
    const Eigen::Matrix3d turn = pose.rotation.toRotationMatrix();
    const Eigen::Vector3d seen_from_world = turn * (light + wand.translation);
    const auto seen = reproject(camera.lens, seen_from_world + pose.translation);
    if (!seen) return std::nullopt;
    Rows rows;
    rows.camera.leftCols<3>() = -seen->by_point * cross_matrix(seen_from_world);
    rows.camera.middleCols<3>(3) = seen->by_point;
    rows.camera.rightCols<kLensValues>() = seen->by_lens;
    rows.camera.col(kPoseValues) *= camera.lens[0];
    rows.camera.middleCols<2>(kPoseValues + 1) *= camera.width;
    const Eigen::Matrix<double, 2, 3> by_world = seen->by_point * turn;
    rows.wand.leftCols<3>() = -by_world * cross_matrix(light);
    rows.wand.rightCols<3>() = by_world;
    return rows;
}

}  // namespace

std::vector<CameraUncertainty> uncertainty_of(const Bundle& bundle,
                                              LensFreedom lens,
                                              double sigma_px) {
    const auto num_cameras = static_cast<Eigen::Index>(bundle.cameras.size());
    Eigen::MatrixXd normal =
        Eigen::MatrixXd::Zero(kCameraValues * num_cameras, kCameraValues * num_cameras);
    std::vector<std::uint8_t> is_in(bundle.cameras.size(), 0);
    const double weight = 1.0 / (sigma_px * sigma_px);
    // one wand after the other: its pose is eliminated
    for (std::size_t begin = 0; begin < bundle.sightings.size();) {
        std::size_t end = begin;
        Eigen::Matrix<double, kPoseValues, kPoseValues> of_wand =
            1e-9 * Eigen::Matrix<double, kPoseValues, kPoseValues>::Identity();
        std::vector<std::pair<Eigen::Index, Eigen::Matrix<double, kCameraValues, kPoseValues>>>
            shared;
        for (; end < bundle.sightings.size() &&
               bundle.sightings[end].instant == bundle.sightings[begin].instant;
             ++end) {
            const Sighting& sighting = bundle.sightings[end];
            if (!sighting.is_used || !error_px(bundle, sighting).allFinite()) continue;
            const auto rows = rows_of(bundle, sighting);
            if (!rows || !rows->camera.allFinite()) continue;
            const Eigen::Index at = kCameraValues * static_cast<Eigen::Index>(sighting.camera);
            is_in[sighting.camera] = 1;
            normal.block<kCameraValues, kCameraValues>(at, at) +=
                weight * rows->camera.transpose() * rows->camera;
            of_wand += weight * rows->wand.transpose() * rows->wand;
            if (shared.empty() || shared.back().first != at)
                shared.emplace_back(at, Eigen::Matrix<double, kCameraValues, kPoseValues>::Zero());
            shared.back().second += weight * rows->camera.transpose() * rows->wand;
        }
        const Eigen::Matrix<double, kPoseValues, kPoseValues> inverse = geometry::solve_symmetric(
            of_wand, Eigen::Matrix<double, kPoseValues, kPoseValues>::Identity());
        for (const auto& [row, left] : shared)
            for (const auto& [column, right] : shared)
                normal.block<kCameraValues, kCameraValues>(row, column) -=
                    left * inverse * right.transpose();
        begin = end;
    }
    bool is_first = true;
    for (Eigen::Index c = 0; c < num_cameras; ++c) {
        const bool is_fixed = is_first && is_in[static_cast<std::size_t>(c)] != 0;
        if (is_fixed) is_first = false;
        for (int k = 0; k < kCameraValues; ++k) {
            double open = k < 3             ? kOpenTurn_rad
                          : k < kPoseValues ? kOpenShift_m
                                            : kOpenLens[static_cast<std::size_t>(k - kPoseValues)];
            const bool is_lens_fixed =
                k >= kPoseValues &&
                (lens == LensFreedom::kFixed || (lens == LensFreedom::kFocal && k > kPoseValues) ||
                 (lens == LensFreedom::kRadial && k > kPoseValues && k != kPoseValues + 3) ||
                 (lens == LensFreedom::kAll && k == kCameraValues - 1));
            if ((is_fixed && k < kPoseValues) || is_lens_fixed) open = 1e-9;
            normal(kCameraValues * c + k, kCameraValues * c + k) += 1.0 / (open * open);
        }
    }
    const Eigen::MatrixXd covariance =
        geometry::solve_symmetric(normal, Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
    std::vector<CameraUncertainty> result(bundle.cameras.size());
    for (std::size_t c = 0; c < result.size(); ++c) {
        if (is_in[c] == 0) continue;
        const Eigen::Index at = kCameraValues * static_cast<Eigen::Index>(c);
        const auto deviation = [&](Eigen::Index k) {
            return std::sqrt(std::max(0.0, covariance(at + k, at + k)));
        };
        result[c].focal = deviation(kPoseValues);
        result[c].centre_px = bundle.cameras[c].width *
                              std::max(deviation(kPoseValues + 1), deviation(kPoseValues + 2));
        // centre = -R^T t; turning the camera moves it, too
        const geometry::RigidTransform pose = bundle.cameras[c].camera_from_world();
        Eigen::Matrix<double, 3, kPoseValues> move;
        for (int k = 0; k < kPoseValues; ++k)
            move.col(k) = (turned(pose, k, 1e-6).inverse().translation -
                           turned(pose, k, -1e-6).inverse().translation) /
                          2e-6;
        result[c].place_m = std::sqrt(
            std::max(0.0,
                     (move * covariance.block<kPoseValues, kPoseValues>(at, at) * move.transpose())
                         .trace()));
    }
    return result;
}

}  // namespace atrium::calibrate
