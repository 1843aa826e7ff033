#include "site_node/capture/frame_mailbox.hpp"

#include <algorithm>
#include <utility>

namespace atrium::capture {

// Pictures are released outside the lock throughout: this returns their buffers to a driver.

FrameMailbox::FrameMailbox(std::size_t num_cameras, std::chrono::nanoseconds max_age)
    : max_age_(max_age), slots_(num_cameras) {}

FrameMailbox::Outcome FrameMailbox::put(CameraFrame frame,
                                        std::chrono::steady_clock::time_point arrival) {
    std::optional<CameraFrame> replaced;
    {
        const std::lock_guard lock(mutex_);
        Slot& slot = slots_[frame.camera];
        if (!slot.is_listened_to) return Outcome::kNobodyListens;
        if (frame.image.empty() && slot.frame) return Outcome::kTaken;
        replaced = std::exchange(slot.frame, std::move(frame));
        slot.arrival = arrival;
        has_any_ = true;
    }
    changed_.notify_one();
    return replaced && !replaced->image.empty() ? Outcome::kReplacedOne : Outcome::kTaken;
}

void FrameMailbox::clear(std::size_t camera) {
    std::optional<CameraFrame> forgotten;
    const std::lock_guard lock(mutex_);
    forgotten.swap(slots_[camera].frame);
}

void FrameMailbox::listen(const std::vector<std::size_t>& only, bool all) {
    std::vector<std::optional<CameraFrame>> forgotten(slots_.size());
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        slots_[i].is_listened_to = all;
        forgotten[i].swap(slots_[i].frame);
    }
    for (const std::size_t camera : only) slots_[camera].is_listened_to = true;
    has_any_ = false;
}

void FrameMailbox::listen_to(const std::vector<std::size_t>& cameras) { listen(cameras, false); }
void FrameMailbox::listen_to_all() { listen({}, true); }
void FrameMailbox::listen_to_none() { listen({}, false); }

void FrameMailbox::ignore(std::size_t camera) {
    std::optional<CameraFrame> forgotten;
    const std::lock_guard lock(mutex_);
    slots_[camera].is_listened_to = false;
    forgotten.swap(slots_[camera].frame);
}

bool FrameMailbox::take(std::stop_token stop,
                        std::chrono::nanoseconds timeout,
                        std::vector<CameraFrame>& frames,
                        std::vector<std::uint64_t>& num_too_old) {
    frames.clear();
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, stop, timeout, [this] { return has_any_; })) return false;
    has_any_ = false;
    const auto now = std::chrono::steady_clock::now();
    std::size_t num_fresh = 0;
    for (Slot& slot : slots_) {
        if (!slot.frame) continue;
        frames.push_back(std::move(*slot.frame));
        slot.frame.reset();
        if (now - slot.arrival > max_age_) {
            ++num_too_old[frames.back().camera];
        } else {
            std::swap(frames[num_fresh++], frames.back());
        }
    }
    lock.unlock();
    frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(num_fresh), frames.end());
    std::sort(frames.begin(), frames.end(), [](const CameraFrame& a, const CameraFrame& b) {
        return a.capture_time < b.capture_time;
    });
    return !stop.stop_requested();
}

}  // namespace atrium::capture
