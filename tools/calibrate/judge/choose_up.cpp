#include "tools/calibrate/judge/choose_up.hpp"

#include "core/geometry/alignment.hpp"
#include "tools/calibrate/judge/angles.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

using VotingCameras = std::span<const geometry::CalibratedCamera>;

// Sine of the tilt at which a picture is not level any more.
constexpr double kNotLevel = 0.2;
// What a camera counts for a direction: 1 if it is upright along it. Cameras on their side are
// rarer, upside down rarer still. A camera that looks down says little, as its roll may be any.
constexpr double kCountOnSide = 0.5;
constexpr double kCountUpsideDown = 0.1;
constexpr double kCountLooksDown = 0.7;
constexpr double kStraightDown = 0.94;  // cosine: within 20 degrees
// Cameras rarely look up: a camera that does counts this much of the above.
constexpr double kLooksUp = 0.3;
constexpr double kSteeplyUp = 0.7;  // cosine: within 45 degrees
// Cameras look down rather than up: for a direction and its opposite that are equal otherwise.
constexpr double kDownwards = 0.05;
// Directions this near, as a cosine, are one. Another one with this share of the best vote rivals.
constexpr double kOneDirection = 0.94;
constexpr double kRivals = 0.85;
// Sides of two pictures give a direction if they are 20 degrees apart, as a sine; sides of many, if
// the mean square of their sines is this.
constexpr double kApart = 0.34;
constexpr double kApartSquare = 0.03;
// The horizon is known from parallel pictures if their ups agree: length of the mean.
constexpr double kUpsAgree = 0.8;
constexpr double kLevelRig = 0.15;  // mean sine
// Pictures that are all on their side and so level rival those that stand in different ways.
constexpr double kVeryLevelRig = 0.06;
// An axis of the frame is up if it is so near, as a cosine, and the pictures are about as level.
constexpr double kNearAxis = 0.966;
constexpr double kAboutAsLevel = 0.03;
// Deviations from level, as a sine, that count by their square; larger ones count by themselves.
constexpr double kLevelWithin = 0.0175;
constexpr int kReweightings = 30;
// Parallel pictures tell the tilt along them only if they look at the horizon.
constexpr double kParallelError_deg = 10.0;
constexpr double kLeastError_deg = 0.5;
constexpr double kRolled_deg = 5.0;
// Cost, as a sine, of a camera turned otherwise than most.
constexpr double kTurnedCost = 0.1;
// More pairs of cameras than this are sampled evenly.
constexpr std::size_t kMaxPairs = 2016;

enum class Stand { kNone, kLevel, kOnSide, kUpsideDown };

// The axes of a camera's pictures in the frame of the file: X right, Y down, Z forwards.
struct PictureAxes {
    Eigen::Vector3d x;
    Eigen::Vector3d y;
    Eigen::Vector3d z;
};
using RigAxes = std::vector<PictureAxes>;

struct CameraVote {
    Stand stand = Stand::kNone;
    double count = 0.0;
};
CameraVote vote_of(const PictureAxes& camera, const Eigen::Vector3d& up) {
    const auto levelness = [](double sine) {
        return std::max(0.0, 1.0 - sine * sine / (kNotLevel * kNotLevel));
    };
    const double looks = camera.z.dot(up);
    CameraVote vote;
    const auto consider = [&](Stand stand, double count) {
        if (count > vote.count) vote = {stand, count};
    };
    const bool is_upright = camera.y.dot(up) < 0.0;
    if (looks < -kStraightDown) consider(Stand::kLevel, kCountLooksDown);
    if (looks >= -kStraightDown) {
        const double level = levelness(camera.x.dot(up));
        consider(is_upright ? Stand::kLevel : Stand::kUpsideDown,
                 level * (is_upright ? 1.0 : kCountUpsideDown));
        consider(Stand::kOnSide, levelness(camera.y.dot(up)) * kCountOnSide);
    }
    if (looks > kSteeplyUp) vote.count *= kLooksUp;
    vote.count -= kDownwards * looks;
    return vote;
}

double count_of(const RigAxes& rig, const Eigen::Vector3d& up) {
    double count = 0.0;
    for (const PictureAxes& camera : rig) count += vote_of(camera, up).count;
    return count;
}

// The side of a picture that is level.
const Eigen::Vector3d& level_side(const PictureAxes& camera, Stand stand) {
    return stand == Stand::kOnSide ? camera.y : camera.x;
}

struct LevelFit {
    Eigen::Vector3d up;      // most perpendicular to all sides, either way
    bool is_unique = false;  // false: the sides are nearly parallel
};
LevelFit perpendicular_to(const std::vector<Eigen::Vector3d>& sides) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& side : sides)
        sum +=
            side * side.transpose() / static_cast<double>(std::max<std::size_t>(sides.size(), 1));
    const geometry::PrincipalAxes found = geometry::principal_axes(sum);
    return {found.axes.col(0), found.values[1] > kApartSquare};
}

// As `perpendicular_to`, but minimises the deviations rather than their squares, so that a few
// rolled cameras do not pull it: least squares, weighted again and again.
LevelFit level_along(const std::vector<Eigen::Vector3d>& sides) {
    LevelFit fit = perpendicular_to(sides);
    for (int i = 0; i < kReweightings && fit.is_unique; ++i) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (const Eigen::Vector3d& side : sides)
            sum += side * side.transpose() / std::max(std::abs(side.dot(fit.up)), kLevelWithin);
        fit.up = geometry::principal_axes(sum).axes.col(0);
    }
    return fit;
}

// As if the pictures looked at the horizon; shorter than 1 if they disagree.
Eigen::Vector3d mean_upright(const RigAxes& rig, const Eigen::Vector3d& near) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double num = 0.0;
    for (const PictureAxes& camera : rig) {
        const Stand stand = vote_of(camera, near).stand;
        if (stand == Stand::kNone) continue;
        const Eigen::Vector3d& upright = stand == Stand::kOnSide ? camera.x : camera.y;
        sum += upright.dot(near) < 0.0 ? Eigen::Vector3d(-upright) : upright;
        num += 1.0;
    }
    return num > 0.0 ? Eigen::Vector3d(sum / num) : sum;
}

// Fits `up` to the cameras that agree with it.
LevelFit refined(const RigAxes& rig, Eigen::Vector3d up) {
    LevelFit fit{up, false};
    for (int i = 0; i < 3; ++i) {
        std::vector<Eigen::Vector3d> sides;
        for (const PictureAxes& camera : rig) {
            const Stand stand = vote_of(camera, up).stand;
            const Eigen::Vector3d& side = level_side(camera, stand);
            if (stand != Stand::kNone && std::abs(side.dot(up)) < kNotLevel) sides.push_back(side);
        }
        fit = level_along(sides);
        if (!fit.is_unique) fit.up = mean_upright(rig, up).normalized();
        if (fit.up.dot(up) < 0.0) fit.up = -fit.up;
        up = fit.up;
    }
    return fit;
}

// Directions along which two cameras are level, upright or turned, and those of the horizon.
std::vector<Eigen::Vector3d> candidates_of(const RigAxes& rig) {
    std::vector<Eigen::Vector3d> candidates;
    const auto add = [&](const Eigen::Vector3d& up) {
        candidates.push_back(up.normalized());
        candidates.push_back(-up.normalized());
    };
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const PictureAxes& camera : rig) {
        add(camera.y);
        add(camera.x);
        mean -= camera.y;
    }
    if (mean.norm() > 1e-3 * static_cast<double>(rig.size())) add(mean);
    const std::size_t step = rig.size() * (rig.size() - 1) / 2 / kMaxPairs + 1;
    std::size_t pair = 0;
    for (std::size_t i = 0; i < rig.size(); ++i) {
        for (std::size_t j = i + 1; j < rig.size(); ++j) {
            if (pair++ % step != 0) continue;
            for (const auto& a : {rig[i].x, rig[i].y}) {
                for (const auto& b : {rig[j].x, rig[j].y}) {
                    const Eigen::Vector3d up = a.cross(b);
                    if (up.norm() > kApart) add(up);
                }
            }
        }
    }
    return candidates;
}

// The likely error of an `up` to which these sides were fitted: that of least squares.
double error_deg_of(const std::vector<Eigen::Vector3d>& sides, const LevelFit& fit) {
    if (sides.size() < 3 || !fit.is_unique) return kParallelError_deg;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    double squares = 0.0;
    for (const Eigen::Vector3d& side : sides) {
        information += side * side.transpose();
        squares += std::pow(side.dot(fit.up), 2);
    }
    const Eigen::Vector3d along = geometry::principal_axes(information).values;
    const double variance = squares / static_cast<double>(sides.size() - 2);
    return std::max(kLeastError_deg,
                    kDegreesPerRad * std::sqrt(variance * (1.0 / along[1] + 1.0 / along[2])));
}

// How sure `choice` is, and the cameras that roll.
void judge_scatter(UpChoice& choice, const RigAxes& rig, const LevelFit& fit) {
    std::vector<Eigen::Vector3d> sides;
    for (std::size_t i = 0; i < rig.size(); ++i) {
        const Stand stand = vote_of(rig[i], fit.up).stand;
        const bool is_nearer_side = std::abs(rig[i].y.dot(fit.up)) < std::abs(rig[i].x.dot(fit.up));
        const Eigen::Vector3d& side =
            stand == Stand::kNone && is_nearer_side ? rig[i].y : level_side(rig[i], stand);
        if (stand != Stand::kNone) sides.push_back(side);
        const double roll_deg =
            std::asin(std::min(1.0, std::abs(side.dot(fit.up)))) * kDegreesPerRad;
        if (roll_deg > kRolled_deg && rig[i].z.dot(fit.up) >= -kStraightDown)
            choice.rolled.emplace_back(i, roll_deg);
    }
    choice.error_deg = error_deg_of(sides, fit);
}

UpVote vote_for(const RigAxes& rig, const Eigen::Vector3d& up) {
    UpVote vote;
    vote.up = up;
    for (std::size_t i = 0; i < rig.size(); ++i) {
        const Stand stand = vote_of(rig[i], up).stand;
        if (stand == Stand::kLevel) ++vote.num_level;
        if (stand == Stand::kOnSide) vote.on_side.push_back(i);
        if (stand == Stand::kUpsideDown) vote.upside_down.push_back(i);
    }
    return vote;
}

std::size_t num_agreeing(const UpVote& vote) {
    return vote.num_level + vote.on_side.size() + vote.upside_down.size();
}

struct Tilts {
    double agreeing = 0.0;  // mean sines
    double all = 0.0;
};
// Of the cameras as they stand along `stands`, about `up`.
Tilts tilts_about(const RigAxes& rig, const Eigen::Vector3d& up, const Eigen::Vector3d& stands) {
    Tilts tilts;
    double num = 0.0;
    for (const PictureAxes& camera : rig) {
        const Stand stand = vote_of(camera, stands).stand;
        const double tilt = std::abs(level_side(camera, stand).dot(up));
        tilts.all += tilt / static_cast<double>(rig.size());
        if (stand == Stand::kNone) continue;
        tilts.agreeing += tilt;
        num += 1.0;
    }
    if (num > 0.0) tilts.agreeing /= num;
    return tilts;
}

// Up if all cameras stood on their side, unless many directions would do. `max_tilt`: mean sine.
std::optional<Eigen::Vector3d> up_of_all_on_side(const RigAxes& rig,
                                                 const Eigen::Vector3d& not_up,
                                                 double max_tilt) {
    std::vector<Eigen::Vector3d> sides;
    double down = 0.0;
    for (const PictureAxes& camera : rig) sides.push_back(camera.y);
    LevelFit fit = perpendicular_to(sides);
    double tilt = 0.0;
    for (const PictureAxes& camera : rig) {
        tilt += std::abs(camera.y.dot(fit.up)) / static_cast<double>(rig.size());
        down -= 4.0 * camera.y.dot(fit.up) + camera.z.dot(fit.up);
    }
    if (down < 0.0) fit.up = -fit.up;
    if (!fit.is_unique || tilt > max_tilt || fit.up.dot(not_up) > kNearAxis) return std::nullopt;
    return fit.up;
}

// The best other direction, if its vote is about as good.
std::optional<UpVote> rival_of(const RigAxes& rig,
                               const UpVote& chosen,
                               const std::vector<Eigen::Vector3d>& candidates,
                               const std::vector<double>& counts) {
    double best = kRivals * count_of(rig, chosen.up);
    std::optional<UpVote> rival;
    const auto is_other = [&](const Eigen::Vector3d& up) {
        const double cosine = up.dot(chosen.up);
        // without upright pictures, only the cameras that look down tell up from down
        return cosine < kOneDirection && (cosine > -kOneDirection || chosen.num_level > 0);
    };
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (counts[i] <= best || !is_other(candidates[i])) continue;
        const Eigen::Vector3d up = refined(rig, candidates[i]).up;
        if (!is_other(up)) continue;
        best = counts[i];
        rival = vote_for(rig, up);
    }
    return rival;
}

}  // namespace

UpChoice choose_up(VotingCameras cameras) {
    UpChoice choice;
    if (cameras.empty()) return choice;
    RigAxes rig;
    for (const auto& camera : cameras) {
        const Eigen::Matrix3d site_from_camera =
            camera.camera_from_site.rotation.conjugate().toRotationMatrix();
        rig.push_back({site_from_camera.col(0), site_from_camera.col(1), site_from_camera.col(2)});
    }
    const std::vector<Eigen::Vector3d> candidates = candidates_of(rig);
    std::vector<double> counts;
    for (const Eigen::Vector3d& up : candidates) counts.push_back(count_of(rig, up));
    const auto best = std::ranges::max_element(counts) - counts.begin();
    const LevelFit fit = refined(rig, candidates[static_cast<std::size_t>(best)]);
    static_cast<UpVote&>(choice) = vote_for(rig, fit.up);
    const Tilts tilts = tilts_about(rig, fit.up, fit.up);
    choice.tilt = tilts.agreeing;
    judge_scatter(choice, rig, fit);
    const std::size_t num_turned = choice.on_side.size() + choice.upside_down.size();
    choice.mean_tilt = tilts.all + kTurnedCost *
                                       static_cast<double>(std::min(num_turned, choice.num_level)) /
                                       static_cast<double>(rig.size());
    // two pictures have such a direction always: it must be about upright, too
    const double upright = mean_upright(rig, fit.up).dot(fit.up);
    choice.is_known = 2 * num_agreeing(choice) > rig.size() && choice.tilt < kLevelRig &&
                      (rig.size() > 2 ? fit.is_unique || upright > kUpsAgree
                                      : fit.is_unique && upright > kUpsAgree && num_turned == 0);

    if (rig.size() > 2) choice.rival = rival_of(rig, choice, candidates, counts);
    if (choice.is_known) {
        const double max_tilt = num_turned == 0 ? kLevelRig : kVeryLevelRig;
        choice.other_up =
            up_of_all_on_side(rig, choice.up, std::min(max_tilt, choice.tilt + kAboutAsLevel));
    }

    int axis = 0;
    const double cosine = choice.up.cwiseAbs().maxCoeff(&axis);
    const Eigen::Vector3d nearest =
        (choice.up[axis] > 0.0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(axis);
    if (cosine > kNearAxis &&
        tilts_about(rig, nearest, choice.up).agreeing < choice.tilt + kAboutAsLevel)
        choice.axis = {choice.up[axis] > 0.0 ? '+' : '-', "XYZ"[axis]};
    return choice;
}

}  // namespace atrium::calibrate
