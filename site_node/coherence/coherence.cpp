#include "site_node/coherence/coherence.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace atrium::coherence {
namespace {

constexpr double kStill_px = 2.0;
constexpr double kLeastScale_px = 1.0;  // of errors that count little
constexpr double kMostScale_px = 4.0;
constexpr double kScales = 4.0;  // standard deviations
// What certainty needs.
constexpr double kEffectOfNoise = 2.5;      // times the others' errors
constexpr double kEffectOfDeviation = 5.0;  // times its own uncertainty
constexpr double kSecondBest = 0.6;         // of the gain
constexpr double kHeldOut = 0.7;            // of the gain, found by other instants
constexpr double kLeastGain = 10.0;
constexpr double kRemaining = 0.7;  // of the camera's errors
constexpr double kIncoherent_px = 3.0;
// Of gains: a simpler fault explains as much.
constexpr double kAsGood = 0.98;
constexpr double kNearlyAsGood = 0.85;
constexpr double kLeastLate = 0.25;  // instants
constexpr double kSigmas = 4.0;

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

std::vector<double> errors_of(std::span<const Tangency> tangencies,
                              std::span<const double> dilations_px,
                              std::optional<std::uint32_t> only,
                              std::optional<std::uint32_t> without) {
    std::vector<double> errors;
    for (const Tangency& t : tangencies) {
        const auto has = [&](std::uint32_t camera) {
            return t.ends[0].camera == camera || t.ends[1].camera == camera;
        };
        if ((only && !has(*only)) || (without && has(*without))) continue;
        errors.push_back(error_without(t, dilations_px));
    }
    return errors;
}

geometry::RigidTransform moved(const geometry::CalibratedCamera& camera, const Fault& fault) {
    geometry::RigidTransform site_from_camera = camera.camera_from_site.inverse();
    const Eigen::Vector3d turn = fault.segment<3>(kFirstTurn);
    if (turn.norm() > 0.0)
        site_from_camera.rotation =
            (Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) *
             site_from_camera.rotation)
                .normalized();
    site_from_camera.translation += fault.segment<3>(kFirstMove);
    return site_from_camera.inverse();
}

// The length of three numbers of a fault, if it is certain.
std::optional<double> certain_length(const CameraFit& fit, int first) {
    const double length = fit.fault.segment<3>(first).norm();
    return length >= kSigmas * fit.deviation.segment<3>(first).norm() ? std::optional(length)
                                                                      : std::nullopt;
}

class Judge {
public:
    Judge(const std::vector<geometry::CalibratedCamera>& cameras,
          const std::vector<Tangency>& tangencies,
          std::uint32_t num_sights)
        : cameras_(cameras),
          tangencies_(tangencies),
          dilations_px_(find_dilations(tangencies, cameras.size())),
          num_sights_(num_sights) {}

    Report run() {
        Report report;
        report.num_sights = num_sights_;
        report.rms_px =
            robust_deviation(errors_of(tangencies_, dilations_px_, std::nullopt, std::nullopt));
        std::size_t num_seeing = 0;
        for (std::uint32_t c = 0; c < cameras_.size(); ++c) {
            const auto errors = errors_of(tangencies_, dilations_px_, c, std::nullopt);
            CameraCoherence camera;
            camera.num_tangencies = errors.size();
            const auto fitting = std::ranges::count_if(
                errors, [](double error) { return std::abs(error) <= kFits_px; });
            if (!errors.empty())
                camera.share = static_cast<double>(fitting) / static_cast<double>(errors.size());
            camera.rms_px = robust_deviation(errors);
            num_seeing += errors.size() >= Coherence::kLeastTangencies ? 1 : 0;
            report.cameras.push_back(camera);
        }
        if (num_seeing < 3 || num_sights_ < Coherence::kLeastSights) return report;
        report.verdict = report.rms_px > kIncoherent_px ? Verdict::kIncoherent : Verdict::kCoherent;
        find_fault(report);
        return report;
    }

private:
    void find_fault(Report& report) const {
        const double scale = std::clamp(kScales * report.rms_px, kLeastScale_px, kMostScale_px);
        const CameraFitter fitter(tangencies_, dilations_px_, num_sights_, scale);
        std::uint32_t best = 0;
        CameraFit best_fit;
        double second_gain = 0.0;
        for (std::uint32_t c = 0; c < cameras_.size(); ++c) {
            if (report.cameras[c].num_tangencies < Coherence::kLeastTangencies) continue;
            CameraFit fit = fitter.fit(c, Freedom::kAll);
            if (fit.gain > best_fit.gain) {
                second_gain = best_fit.gain;
                best_fit = std::move(fit);
                best = c;
            } else {
                second_gain = std::max(second_gain, fit.gain);
            }
        }
        if (!is_certain(best, best_fit, second_gain)) return;
        NamedFault fault;
        fault.camera = best;
        const CameraFit late = fitter.fit(best, Freedom::kLate);
        const CameraFit pose = fitter.fit(best, Freedom::kPose);
        const bool is_late = late.gain > pose.gain && std::abs(late.fault[kDelay]) >= kLeastLate;
        const CameraFit& cause = is_late ? late : pose;
        // another cause than these, or both at once
        if (cause.gain < kNearlyAsGood * best_fit.gain || !is_certain(best, cause, second_gain))
            return;
        fault.effect_px = cause.effect_px;
        fault.rms_after_px = cause.rms_after_px;
        report.verdict = is_late ? Verdict::kLate : Verdict::kMoved;
        if (is_late)
            fault.late_instants = late.fault[kDelay];
        else
            describe_motion(fitter, pose, fault);
        report.fault = fault;
    }

    bool is_certain(std::uint32_t camera, const CameraFit& fit, double second_gain) const {
        const double noise =
            robust_deviation(errors_of(tangencies_, dilations_px_, std::nullopt, camera));
        double held_out = 0.0;
        std::size_t num_better = 0;
        for (const double gain : fit.held_out_gains) {
            held_out += gain;
            num_better += gain > 0.0 ? 1 : 0;
        }
        return fit.gain >= kLeastGain && second_gain <= kSecondBest * fit.gain &&
               fit.effect_px >= std::max(Coherence::kLeastEffect_px, kEffectOfNoise * noise) &&
               fit.effect_px >= kEffectOfDeviation * fit.effect_deviation_px &&
               held_out >= kHeldOut * fit.gain && num_better + 1 >= CameraFitter::kBlocks &&
               fit.rms_after_px <= kRemaining * fit.rms_before_px;
    }

    // The simplest motion that explains as much as any.
    void describe_motion(const CameraFitter& fitter,
                         const CameraFit& pose,
                         NamedFault& fault) const {
        const auto camera = static_cast<std::uint32_t>(fault.camera);
        const CameraFit turn = fitter.fit(camera, Freedom::kTurn);
        const CameraFit move = fitter.fit(camera, Freedom::kMove);
        const double needed = std::min(kAsGood * pose.gain, pose.gain - 1.0);
        const bool is_turn = turn.gain >= needed;
        const bool is_move = move.gain >= needed;
        fault.is_either = is_turn && is_move;
        const CameraFit& simple = is_turn && turn.gain >= move.gain ? turn : move;
        const CameraFit& shown = is_turn || is_move ? simple : pose;
        if (is_turn) fault.turned_deg = degrees(turn.fault.segment<3>(kFirstTurn).norm());
        if (is_move) fault.moved_mm = 1000.0 * move.fault.segment<3>(kFirstMove).norm();
        if (!is_turn && !is_move) {
            if (const auto radians = certain_length(pose, kFirstTurn))
                fault.turned_deg = degrees(*radians);
            if (const auto metres = certain_length(pose, kFirstMove))
                fault.moved_mm = 1000.0 * *metres;
        }
        fault.camera_from_site = moved(cameras_[camera], shown.fault);
    }

    const std::vector<geometry::CalibratedCamera>& cameras_;
    const std::vector<Tangency>& tangencies_;
    std::vector<double> dilations_px_;
    std::uint32_t num_sights_;
};

}  // namespace

Coherence::Coherence(std::vector<geometry::CalibratedCamera> cameras, std::size_t most_sights)
    : cameras_(std::move(cameras)), most_sights_(most_sights) {}

void Coherence::clear() {
    window_.clear();
    last_middles_px_.clear();
}

bool Coherence::has_moved(const Sight& sight) {
    std::vector<Eigen::Vector2d> middles;
    for (const SilhouetteHull& hull : sight.now) {
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        for (const Eigen::Vector2d& p : hull.points) sum += p;
        const auto count = static_cast<double>(std::max<std::size_t>(1, hull.points.size()));
        middles.emplace_back(sum / count);
    }
    bool moves = middles.size() != last_middles_px_.size();
    for (std::size_t i = 0; !moves && i < middles.size(); ++i)
        moves = (middles[i] - last_middles_px_[i]).norm() > kStill_px;
    if (moves) last_middles_px_ = std::move(middles);
    return moves;
}

bool Coherence::add(const Sight& sight) {
    if (!has_moved(sight)) return false;
    std::vector<Tangency> found;
    find_tangencies(cameras_, sight, 0, {}, found);
    if (found.empty()) return false;
    window_.push_back({std::move(found), {sight.now, {}}});
    if (window_.size() > most_sights_) window_.pop_front();
    return true;
}

Report Coherence::judge() const {
    std::vector<Tangency> all;
    std::uint32_t number = 0;
    for (const Instant& instant : window_) {
        for (Tangency t : instant.tangencies) {
            t.sight = number;
            all.push_back(t);
        }
        ++number;
    }
    return Judge(cameras_, all, number).run();
}

std::optional<OtherLenses> Coherence::other_lenses() const {
    std::vector<Sight> sights;
    for (const Instant& instant : window_) sights.push_back(instant.sight);
    return find_other_lenses(cameras_, sights);
}

}  // namespace atrium::coherence
