#include "site_node/capture/metaframe_assembler.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::capture {
namespace {

// A camera with a wild clock must not open metaframes without end.
constexpr std::size_t kMaxPending = 8;

}  // namespace

MetaframeAssembler::MetaframeAssembler(std::size_t num_cameras, const AssemblerOptions& options)
    : num_cameras_(num_cameras), options_(options) {
    assert(num_cameras > 0);
}

MetaframeAssembler::Pending* MetaframeAssembler::find_or_open(
    Timestamp time, std::chrono::steady_clock::time_point arrival) {
    for (Pending& p : pending_) {
        if (std::chrono::abs(time - p.time) <= options_.tolerance) return &p;
    }
    if (pending_.size() == kMaxPending) {
        pending_.pop_front();
        ++counters_.num_incomplete;
    }
    Pending opened;
    opened.frame_id = next_frame_id_++;
    opened.time = time;
    opened.first_arrival = arrival;
    opened.frames.resize(num_cameras_);
    const auto place =
        std::upper_bound(pending_.begin(), pending_.end(), time, [](Timestamp t, const Pending& p) {
            return t < p.time;
        });
    return &*pending_.insert(place, std::move(opened));
}

std::optional<Metaframe> MetaframeAssembler::add(CameraFrame frame,
                                                 std::chrono::steady_clock::time_point arrival) {
    expire(arrival);
    const bool too_old = last_emitted_.ns != std::numeric_limits<std::int64_t>::min() &&
                         frame.capture_time <= last_emitted_ + options_.tolerance;
    if (frame.camera >= num_cameras_ || frame.image == nullptr || too_old) {
        ++counters_.num_stray;
        return std::nullopt;
    }
    Pending* const pending = find_or_open(frame.capture_time, arrival);
    CameraFrame& place = pending->frames[frame.camera];
    if (place.image != nullptr) {
        ++counters_.num_stray;
        return std::nullopt;
    }
    place = std::move(frame);
    if (++pending->num_present < num_cameras_) return std::nullopt;

    Metaframe complete;
    complete.frame_id = pending->frame_id;
    complete.frames = std::move(pending->frames);
    complete.capture_time = std::min_element(complete.frames.begin(),
                                             complete.frames.end(),
                                             [](const auto& a, const auto& b) {
                                                 return a.capture_time < b.capture_time;
                                             })
                                ->capture_time;
    last_emitted_ = pending->time;
    ++counters_.num_complete;
    while (pending_.front().time < last_emitted_) {
        pending_.pop_front();
        ++counters_.num_incomplete;
    }
    pending_.pop_front();
    return complete;
}

void MetaframeAssembler::expire(std::chrono::steady_clock::time_point now) {
    const auto is_late = [&](const Pending& p) {
        return now - p.first_arrival > options_.deadline;
    };
    const auto kept = std::remove_if(pending_.begin(), pending_.end(), is_late);
    counters_.num_incomplete += static_cast<std::uint64_t>(pending_.end() - kept);
    pending_.erase(kept, pending_.end());
}

}  // namespace atrium::capture
