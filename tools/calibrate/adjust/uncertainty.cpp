#include "tools/calibrate/adjust/uncertainty.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdint>

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

// Derivatives by central differences, of values in units of 1 rad, 1 m; f as a share, cx and cy in
// pictures' widths.
struct Rows {
    CameraRows camera;
    WandRows wand;
};

Rows rows_of(const Bundle& bundle, const Sighting& sighting) {
    constexpr double kStep = 1e-6;
    const BundleCamera& camera = bundle.cameras[sighting.camera];
    const geometry::RigidTransform pose = camera.camera_from_world();
    const geometry::RigidTransform& wand = bundle.wands[sighting.instant].world_from_wand;
    const Eigen::Vector3d& light = bundle.wand.lights_m[sighting.light];
    BundleCamera local = camera;  // at the origin: points are given in its frame
    local.pose = {};
    Rows rows;
    const auto difference = [&](const auto& at) -> Eigen::Vector2d {
        return (at(kStep) - at(-kStep)) / (2.0 * kStep);
    };
    for (int k = 0; k < kPoseValues; ++k) {
        rows.camera.col(k) = difference(
            [&](double step) { return project(local, turned(pose, k, step) * (wand * light)); });
        rows.wand.col(k) = difference(
            [&](double step) { return project(local, pose * (turned(wand, k, step) * light)); });
    }
    const Eigen::Vector3d seen = pose * (wand * light);
    for (int k = 0; k < kLensValues; ++k) {
        const auto value = static_cast<std::size_t>(k);
        const double unit = k == 0 ? camera.lens[0] : k < 3 ? camera.width : 1.0;
        rows.camera.col(kPoseValues + k) = difference([&](double step) {
            BundleCamera changed = local;
            changed.lens[value] += step * unit;
            return project(changed, seen);
        });
    }
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
            const Rows rows = rows_of(bundle, sighting);
            if (!rows.camera.allFinite() || !rows.wand.allFinite()) continue;
            const Eigen::Index at = kCameraValues * static_cast<Eigen::Index>(sighting.camera);
            is_in[sighting.camera] = 1;
            normal.block<kCameraValues, kCameraValues>(at, at) +=
                weight * rows.camera.transpose() * rows.camera;
            of_wand += weight * rows.wand.transpose() * rows.wand;
            if (shared.empty() || shared.back().first != at)
                shared.emplace_back(at, Eigen::Matrix<double, kCameraValues, kPoseValues>::Zero());
            shared.back().second += weight * rows.camera.transpose() * rows.wand;
        }
        const Eigen::Matrix<double, kPoseValues, kPoseValues> inverse = of_wand.inverse();
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
        normal.ldlt().solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
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
