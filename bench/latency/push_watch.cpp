#include "bench/latency/push_watch.hpp"

#include "core/codec/mesh_codec.hpp"
#include "tests/support/shapes/decode_mesh.hpp"
#include "tests/support/shapes/surface_distance.hpp"

#include <chrono>
#include <cmath>
#include <utility>

namespace atrium::bench {
namespace {

constexpr double kAwayM = 0.12;     // the hand is this far from the place of the ball
constexpr double kMovedM = 0.001;   // the ball moves: this far from its place,
constexpr double kMovesMps = 0.05;  // or at this speed
constexpr double kStillMps = 0.005;
constexpr int kStillStates = 6;  // a tenth of a second

const bus::ObjectState* find(const bus::SceneState& state, std::uint32_t object) {
    for (const bus::ObjectState& candidate : state.objects)
        if (candidate.object == object) return &candidate;
    return nullptr;
}

}  // namespace

PushWatch::PushWatch(Target target, std::uint64_t seed)
    : target_(std::move(target)), random_(seed) {}

bus::SceneCommand PushWatch::put_ball() {
    std::uniform_real_distribution<double> share(-1.0, 1.0);
    bus::SceneCommand command;
    command.sender = "world-latency";
    command.kind = bus::CommandKind::kAdd;
    command.object = target_.ball;
    for (int axis = 0; axis < 3; ++axis)
        command.object.world_from_object.translation[axis] +=
            share(random_) * target_.spread_m[axis];
    place_world_ = command.object.world_from_object.translation;
    num_still_ = 0;
    push_ = {};
    gap_m_.reset();
    phase_ = Phase::kPut;
    return command;
}

bus::SceneCommand PushWatch::take_ball() {
    bus::SceneCommand command;
    command.sender = "world-latency";
    command.kind = bus::CommandKind::kRemove;
    command.target = target_.ball.object;
    phase_ = Phase::kDone;
    return command;
}

std::optional<bus::SceneCommand> PushWatch::look_for_end() {
    if (push_.capture == Timestamp{} || push_.moved == Timestamp{}) return std::nullopt;
    pushes_.push_back(push_);
    return take_ball();
}

std::optional<bus::SceneCommand> PushWatch::see(const bus::SiteMesh& mesh, Timestamp received) {
    // the measured programs share the same two cores: skip work on meshes without a push
    const bool tells_little = phase_ == Phase::kDone || phase_ == Phase::kPut;
    if (tells_little && mesh.frame_id % 4 != 0) return std::nullopt;
    const auto decoded = test::decode_mesh(mesh.draco);
    if (!decoded || decoded->empty()) return std::nullopt;
    const bool is_there = phase_ != Phase::kDone;
    const Eigen::Vector3d place =
        is_there ? place_world_ : target_.ball.world_from_object.translation;
    const double gap_m =
        test::SurfaceDistance(*decoded).distance_m(target_.world_from_site.inverse() * place) -
        0.5 * target_.ball.size_m.x();
    switch (phase_) {
        case Phase::kDone:
            if (gap_m > kAwayM) return put_ball();
            break;
        case Phase::kPut:
            if (gap_m > 0.0) break;
            ++num_missed_;  // the hand arrived before the ball was at rest
            return take_ball();
        case Phase::kArmed:
            gap_m_ = gap_m;
            gap_capture_ = mesh.capture_time;
            if (gap_m <= 0.0) {
                ++num_missed_;  // the push was missed
                return take_ball();
            }
            if (gap_m < 0.5 * kAwayM) phase_ = Phase::kHandComes;
            break;
        case Phase::kHandComes:
            if (gap_m > kAwayM) {
                ++num_missed_;  // the hand went back before both had happened
                return take_ball();
            }
            if (gap_m <= 0.0 && push_.capture == Timestamp{}) {
                const double share = *gap_m_ / (*gap_m_ - gap_m);
                const auto period = static_cast<double>((mesh.capture_time - gap_capture_).count());
                push_.touch = gap_capture_ + std::chrono::nanoseconds(std::llround(share * period));
                push_.capture = mesh.capture_time;
                push_.mesh_received = received;
            }
            gap_m_ = gap_m;
            gap_capture_ = mesh.capture_time;
            return look_for_end();
    }
    return std::nullopt;
}

std::optional<bus::SceneCommand> PushWatch::see(const bus::SceneState& state, Timestamp received) {
    const bus::ObjectState* ball = find(state, target_.ball.object);
    if (ball == nullptr || phase_ == Phase::kDone) return std::nullopt;
    const Eigen::Vector3d& place = ball->world_from_object.translation;
    const double speed_mps = ball->linear_velocity.norm();
    if (phase_ == Phase::kPut) {
        num_still_ = speed_mps < kStillMps ? num_still_ + 1 : 0;
        if (num_still_ < kStillStates) return std::nullopt;
        place_world_ = place;
        phase_ = Phase::kArmed;
        return std::nullopt;
    }
    if (push_.moved != Timestamp{}) return std::nullopt;
    if ((place - place_world_).norm() < kMovedM && speed_mps < kMovesMps) return std::nullopt;
    push_.moved = state.time;
    push_.state_received = received;
    return look_for_end();
}

}  // namespace atrium::bench
