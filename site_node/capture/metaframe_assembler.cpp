#include "site_node/capture/metaframe_assembler.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::capture {
namespace {

// Limits how many metaframes a camera with a wild clock can open.
constexpr std::size_t kMaxPending = 8;

// A single camera with a wild clock may be this late; all of them, one after another, cannot.
constexpr std::chrono::seconds kFarTooOld{2};
constexpr std::size_t kRoundsOfAllCameras = 3;

}  // namespace

MetaframeAssembler::MetaframeAssembler(std::size_t num_cameras, const AssemblerOptions& options)
    : num_cameras_(num_cameras), options_(options), offsets_(num_cameras, options.tolerance) {
    assert(num_cameras > 0);
}

bool MetaframeAssembler::is_enough(const Pending& pending) const {
    return pending.num_present == num_cameras_ ||
           (options_.min_cameras > 0 && pending.num_present >= options_.min_cameras);
}

// Called once `pending` has left the queue: it becomes ready or is dropped.
void MetaframeAssembler::retire(Pending&& pending) {
    offsets_.learn(pending.frames);
    if (!is_enough(pending) || (ready_ && ready_->time > pending.time)) {
        ++counters_.num_incomplete;
        return;
    }
    if (ready_) ++counters_.num_incomplete;
    ready_ = std::move(pending);
    last_emitted_ = ready_->time;
}

template <typename IsDue>
void MetaframeAssembler::retire_all(IsDue is_due) {
    const auto due = std::stable_partition(
        pending_.begin(), pending_.end(), [&](const Pending& p) { return !is_due(p); });
    for (auto p = due; p != pending_.end(); ++p) retire(std::move(*p));
    pending_.erase(due, pending_.end());
    if (!ready_) return;
    while (!pending_.empty() && pending_.front().time < ready_->time) {
        pending_.pop_front();
        ++counters_.num_incomplete;
    }
}

bool MetaframeAssembler::is_too_old(Timestamp time) const {
    return last_emitted_.ns != std::numeric_limits<std::int64_t>::min() &&
           time < last_emitted_ + 2 * options_.tolerance;
}

// Returns null if there is none and it is too late to open one.
MetaframeAssembler::Pending* MetaframeAssembler::find_or_open(
    Timestamp time, std::chrono::steady_clock::time_point arrival) {
    if (is_too_old(time)) return nullptr;
    // pictures of one trigger are less than two tolerances apart, those of two triggers more
    const auto nearest =
        std::min_element(pending_.begin(), pending_.end(), [&](const auto& a, const auto& b) {
            return std::chrono::abs(time - a.time) < std::chrono::abs(time - b.time);
        });
    if (nearest != pending_.end() &&
        std::chrono::abs(time - nearest->time) < 2 * options_.tolerance) {
        return &*nearest;
    }
    if (pending_.size() == kMaxPending) {
        retire(std::move(pending_.front()));
        pending_.pop_front();
        if (is_too_old(time)) return nullptr;
    }
    Pending opened;
    opened.frame_id = next_frame_id_++;
    opened.time = time;
    opened.first_arrival = arrival;
    opened.frames.resize(num_cameras_);
    opened.is_lost.resize(num_cameras_, 0);
    for (std::size_t i = 0; i < num_cameras_; ++i) opened.frames[i].camera = i;
    const auto place =
        std::upper_bound(pending_.begin(), pending_.end(), time, [](Timestamp t, const Pending& p) {
            return t < p.time;
        });
    return &*pending_.insert(place, std::move(opened));
}

// Begins anew when the clock of all pictures was set back: else nothing would be returned until the
// former time is reached.
void MetaframeAssembler::note_age(Timestamp time) {
    const bool is_far = last_emitted_.ns != std::numeric_limits<std::int64_t>::min() &&
                        time + kFarTooOld < last_emitted_;
    num_far_too_old_ = is_far ? num_far_too_old_ + 1 : 0;
    if (num_far_too_old_ < kRoundsOfAllCameras * num_cameras_) return;
    num_far_too_old_ = 0;
    counters_.num_incomplete += pending_.size();
    pending_.clear();
    ready_.reset();
    last_emitted_ = {std::numeric_limits<std::int64_t>::min()};
}

void MetaframeAssembler::place(CameraFrame frame, std::chrono::steady_clock::time_point arrival) {
    const std::size_t camera = frame.camera;
    const bool is_lost = frame.is_lost();
    if (camera < num_cameras_) note_age(offsets_.trigger_time(frame));
    Pending* const pending =
        camera < num_cameras_ ? find_or_open(offsets_.trigger_time(frame), arrival) : nullptr;
    if (pending == nullptr || !pending->frames[camera].is_lost()) {
        if (!is_lost) ++counters_.num_stray;
        return;
    }
    if (pending->is_lost[camera] != 0) --pending->num_lost;
    pending->is_lost[camera] = is_lost ? 1 : 0;
    if (is_lost) {
        ++pending->num_lost;
    } else {
        pending->frames[camera] = std::move(frame);
        ++pending->num_present;
    }
    if (pending->num_present + pending->num_lost < num_cameras_) return;
    const Timestamp time = pending->time;
    retire_all([&](const Pending& p) { return p.time == time; });
}

std::optional<Metaframe> MetaframeAssembler::take_ready() {
    if (!ready_) return std::nullopt;
    const bool complete = ready_->num_present == num_cameras_;
    ++(complete ? counters_.num_complete : counters_.num_incomplete_used);
    Metaframe metaframe;
    metaframe.frame_id = ready_->frame_id;
    metaframe.capture_time = {std::numeric_limits<std::int64_t>::max()};
    for (const CameraFrame& frame : ready_->frames) {
        if (!frame.is_lost())
            metaframe.capture_time = std::min(metaframe.capture_time, frame.capture_time);
    }
    metaframe.frames = std::move(ready_->frames);
    ready_.reset();
    return metaframe;
}

std::optional<Metaframe> MetaframeAssembler::add(CameraFrame frame,
                                                 std::chrono::steady_clock::time_point arrival) {
    retire_all([&](const Pending& p) { return arrival - p.first_arrival > options_.deadline; });
    place(std::move(frame), arrival);
    return take_ready();
}

std::optional<Metaframe> MetaframeAssembler::expire(std::chrono::steady_clock::time_point now) {
    retire_all([&](const Pending& p) { return now - p.first_arrival > options_.deadline; });
    return take_ready();
}

std::optional<std::chrono::steady_clock::time_point> MetaframeAssembler::next_expiry() const {
    std::optional<std::chrono::steady_clock::time_point> next;
    for (const Pending& pending : pending_) {
        const auto expiry = pending.first_arrival + options_.deadline + std::chrono::nanoseconds(1);
        next = std::min(next.value_or(expiry), expiry);
    }
    return next;
}

std::optional<Metaframe> MetaframeAssembler::finish() {
    retire_all([](const Pending&) { return true; });
    return take_ready();
}

}  // namespace atrium::capture
