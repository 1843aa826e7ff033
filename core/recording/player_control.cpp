#include "core/recording/player.hpp"

#include <fmt/format.h>

#include <algorithm>

// What other threads ask of a player; player.cpp has what it then does.
namespace atrium::recording {
namespace {

constexpr double kMinSpeed = 0.05;
constexpr double kMaxSpeed = 20.0;
constexpr int kMaxSteps = 1'000'000;

}  // namespace

std::optional<std::string> LeftOut::update(const PlayState& state) {
    const std::uint64_t num = state.num_refused + state.num_damaged;
    if (num <= num_told_) return std::nullopt;
    num_told_ = num;
    return fmt::format("left_out refused={} damaged={} reason=\"{}\"",
                       state.num_refused,
                       state.num_damaged,
                       state.fault);
}

std::string position_text(std::chrono::nanoseconds time) {
    constexpr std::int64_t kTenthsPerMinute = 600;
    const std::int64_t tenths = time / std::chrono::milliseconds(100);
    const std::int64_t rest = tenths % kTenthsPerMinute;
    return fmt::format("{}:{:02}.{}", tenths / kTenthsPerMinute, rest / 10, rest % 10);
}

void Player::play() {
    const std::lock_guard lock(mutex_);
    // From the time that was asked for last, which may not be shown yet.
    const std::chrono::nanoseconds time = wanted_time_.value_or(state_.time);
    const bool is_at_end = state_.is_at_end && !wanted_time_ && wanted_steps_ == 0;
    if (is_at_end || time >= state_.out || time < state_.in) wanted_time_ = state_.in;
    state_.is_playing = true;
    changed_.notify_all();
}

void Player::pause() {
    const std::lock_guard lock(mutex_);
    state_.is_playing = false;
    changed_.notify_all();
}

void Player::step(int num) {
    const std::lock_guard lock(mutex_);
    state_.is_playing = false;
    wanted_steps_ =
        std::clamp(wanted_steps_ + std::clamp(num, -kMaxSteps, kMaxSteps), -kMaxSteps, kMaxSteps);
    is_shown_ = false;
    changed_.notify_all();
}

void Player::show_first() {
    bool is_beginning = false;
    {
        const std::lock_guard lock(mutex_);
        is_beginning = wanted_time_.value_or(state_.time).count() == 0;
    }
    if (is_beginning) step(2);
}

void Player::seek(std::chrono::nanoseconds time) {
    const std::lock_guard lock(mutex_);
    wanted_time_ = std::clamp(time, std::chrono::nanoseconds(0), state_.duration);
    wanted_steps_ = 0;
    is_shown_ = false;
    changed_.notify_all();
}

void Player::set_speed(double speed) {
    const std::lock_guard lock(mutex_);
    state_.speed = std::clamp(speed, kMinSpeed, kMaxSpeed);
    is_new_pace_ = true;
    changed_.notify_all();
}

void Player::set_loop(bool loops) {
    const std::lock_guard lock(mutex_);
    state_.loops = loops;
}

void Player::set_marks(std::chrono::nanoseconds in, std::chrono::nanoseconds out) {
    const std::lock_guard lock(mutex_);
    in = std::clamp(in, std::chrono::nanoseconds(0), state_.duration);
    out = std::clamp(out, std::chrono::nanoseconds(0), state_.duration);
    if (in >= out) return;
    state_.in = in;
    state_.out = out;
    is_new_pace_ = true;
    changed_.notify_all();
}

PlayState Player::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

bool Player::wait_until_shown(std::chrono::nanoseconds timeout) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, timeout, [this] { return is_shown_; });
}

}  // namespace atrium::recording
