#include "site_node/capture/aravis_camera.hpp"
#include "site_node/capture/aravis_camera_session.hpp"

#include <fmt/format.h>

#include <algorithm>

// Software triggers of a camera.
namespace atrium::capture {

using std::chrono::nanoseconds;
using Clock = std::chrono::steady_clock;

void AravisCamera::fire(Clock::time_point due) {
    {
        const std::lock_guard lock(wake_->mutex);
        wake_->due = due;
    }
    // reported here, since the camera's thread may block: Aravis repeats a command for up to 3 s
    const nanoseconds unanswered = unanswered_time();
    if (unanswered < silence()) {
        is_unanswered_reported_ = false;
    } else if (!std::exchange(is_unanswered_reported_, true)) {
        report(true,
               fmt::format("does not answer for {:.1f} s",
                           static_cast<double>(unanswered.count()) * 1e-9));
    }
    wake_->changed.notify_one();
}

nanoseconds AravisCamera::unanswered_time() const {
    const std::int64_t sent_ns = trigger_sent_ns_;
    return nanoseconds(sent_ns == 0 ? 0 : now_ns() - sent_ns);
}

// Triggers for a beat, unless it is too late: a picture of another instant than those of the other
// cameras is useless.
void AravisCamera::trigger(Session& session, Clock::time_point due) {
    const nanoseconds late = Clock::now() - due;
    if (late > trigger_clock_.longest_late()) return;
    const Timestamp sent = Timestamp::now();
    trigger_clock_.note_trigger(sent + -late, sent);
    ++num_unanswered_;
    trigger_sent_ns_ = now_ns();
    GErrorSlot error;  // a camera that refuses will be silent
    arv_camera_software_trigger(session.camera.get(), error.out());
    trigger_sent_ns_ = 0;
    is_trigger_refused_ = error.failed();
    if (const auto delay = trigger_clock_.delay()) report_if_behind(*delay);
}

// Sends isolated triggers. The camera follows no beat meanwhile: each picture belongs to the one
// trigger before it.
void AravisCamera::measure_delay(Session& session, std::stop_token stop) {
    constexpr int kShots = 3;
    constexpr int kMostShots = 10;
    constexpr int kMostSilent = 4;  // shots without a picture
    std::optional<nanoseconds> delay;
    trigger_clock_.start_measuring();
    for (int quick = 0, shots = 0, silent = 0;
         quick < kShots && shots < kMostShots && silent < kMostSilent && !stop.stop_requested();
         ++shots) {
        trigger_clock_.begin_shot();
        const Timestamp sent = Timestamp::now();
        GErrorSlot error;
        arv_camera_software_trigger(session.camera.get(), error.out());
        if (error.failed()) break;  // the camera does not answer
        const nanoseconds asked_for = Timestamp::now() - sent;
        const auto seen = trigger_clock_.wait_for_picture(stop, silence());
        if (!seen) {
            ++silent;
            continue;
        }
        // a late acknowledgement can only make the delay too long; TriggerClock corrects that later
        delay = std::min(delay.value_or(nanoseconds::max()), *seen - sent);
        if (asked_for < shared_state_.period() / 8) ++quick;
    }
    trigger_clock_.finish_measuring(delay);
    if (delay) {
        std::int64_t least_ns = shared_state_.least_delay_ns;
        while (delay->count() < least_ns &&
               !shared_state_.least_delay_ns.compare_exchange_weak(least_ns, delay->count())) {
        }
        return;
    }
    if (stop.stop_requested() || std::exchange(is_unmeasured_reported_, true)) return;
    report(true,
           "sends no picture for a single trigger: its delay is unknown, and if it exceeds half a "
           "period its pictures show another instant than those of the other cameras");
}

// The other cameras' pictures do not wait that long.
void AravisCamera::report_if_behind(nanoseconds delay) {
    const nanoseconds behind = delay - nanoseconds(shared_state_.least_delay_ns);
    if (is_behind_reported_ || behind <= shared_state_.options.deadline) return;
    is_behind_reported_ = true;
    const auto ms = [](nanoseconds time) { return static_cast<double>(time.count()) * 1e-6; };
    report(true,
           fmt::format("delivers {:.0f} ms after its trigger, {:.0f} ms later than the first "
                       "camera, and misses every metaframe; raise capture.deadline_ms, now "
                       "{:.0f}, above that, or shorten its exposure or packet delay",
                       ms(delay),
                       ms(behind),
                       ms(shared_state_.options.deadline)));
}

}  // namespace atrium::capture
