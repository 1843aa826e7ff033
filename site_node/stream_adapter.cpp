#include "site_node/stream_adapter.hpp"

#include <fmt/format.h>

namespace atrium::site_node {
namespace {

std::string text_of(const stream::StreamCap& cap) {
    if (cap.set_by.empty()) return "no limit";
    const double mbit_per_s = 1e-6 * cap.cap.bit_per_s;
    if (cap.set_by == stream::kMaxOption || cap.set_by == stream::kMinOption)
        return fmt::format("{} = {:.1f}", cap.set_by, mbit_per_s);
    return fmt::format(
        "viewer {}: {:.1f} Mbit/s, queue {:.0f} ms", cap.set_by, mbit_per_s, cap.queue_ms);
}

stream::FrameBytes frame_bytes(const SiteFrame& frame) {
    stream::FrameBytes bytes{frame.draco.size(), 0};
    for (const CodedCamera& camera : frame.cameras) {
        bytes.fixed += camera.texture.mask.size();
        bytes.colour += camera.texture.colour.size();
    }
    for (const RemoteTexture& texture : frame.remote_textures) {
        bytes.fixed += texture.mask_bytes;
        bytes.colour += texture.colour_bytes;
    }
    return bytes;
}

}  // namespace

StreamAdapter::StreamAdapter(const stream::StreamOptions& options,
                             int jpeg_quality,
                             double rate_hz,
                             std::string site,
                             bus::Reader<bus::StreamFeedback> feedback)
    : site_(std::move(site)),
      feedback_(std::move(feedback)),
      controller_(jpeg_quality, rate_hz),
      links_(options) {
    state_.jpeg_quality = static_cast<std::uint32_t>(jpeg_quality);
}

void StreamAdapter::add(const bus::StreamFeedback& feedback, stream::Time now) {
    links_.add(feedback.viewer,
               {feedback.num_complete,
                feedback.num_incomplete,
                feedback.num_samples,
                8.0 * feedback.payload_bytes_per_s,
                feedback.min_delay_ms,
                feedback.sure_delay_ms,
                feedback.longest_wait_ms},
               controller_.next_bit_per_s(),
               now);
}

void StreamAdapter::take_feedback(stream::Time now) {
    const bus::TakeReport report = feedback_.take(
        [&](bus::StreamFeedback&& feedback) {
            if (feedback.site == site_) add(feedback, now);
        },
        [&](const bus::StreamFeedback& gone) {
            if (gone.site == site_) links_.forget(gone.viewer);
        });
    if (report.num_rejected > 0) complaints_.warn("feedback_rejected " + report.first_rejection);
}

void StreamAdapter::log_level_change(const stream::StreamCap& cap) {
    const std::size_t index = controller_.level();
    if (index == logged_level_) return;
    logged_level_ = index;
    const stream::Level& level = controller_.ladder()[index];
    app::log::info("stream level quality={} resolution=1/{} rate=1/{} reason=\"{}\"",
                   level.jpeg_quality,
                   level.colour_divisor,
                   level.send_every,
                   text_of(cap));
}

std::optional<StreamAdapter::Choice> StreamAdapter::offer(stream::Time now) {
    const std::lock_guard own_lock(mutex_);
    take_feedback(now);
    const stream::StreamCap cap = links_.cap(now);
    controller_.set_cap(cap.cap);
    const auto index = controller_.offer(now);
    log_level_change(cap);
    const stream::Level& level = controller_.ladder()[controller_.level()];
    const std::lock_guard lock(state_mutex_);
    state_.jpeg_quality = static_cast<std::uint32_t>(level.jpeg_quality);
    state_.colour_divisor = static_cast<std::uint32_t>(level.colour_divisor);
    state_.send_every = static_cast<std::uint32_t>(level.send_every);
    state_.cap_bit_per_s = cap.cap.bit_per_s;
    state_.cap_set_by = cap.set_by;
    if (index) return Choice{*index, level};
    ++state_.num_dropped_for_rate;
    return std::nullopt;
}

void StreamAdapter::give_back() {
    const std::lock_guard own_lock(mutex_);
    controller_.give_back();
    const std::lock_guard lock(state_mutex_);
    ++state_.num_dropped_for_rate;
}

void StreamAdapter::coded(const Choice& choice, const SiteFrame& frame, stream::Time now) {
    const std::lock_guard own_lock(mutex_);
    controller_.coded(choice.index, frame_bytes(frame), now);
}

bus::StreamState StreamAdapter::state() const {
    const std::lock_guard lock(state_mutex_);
    return state_;
}

}  // namespace atrium::site_node
