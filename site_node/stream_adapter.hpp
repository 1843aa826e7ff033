#pragma once

#include "core/app/log.hpp"
#include "core/bus/bus.hpp"
#include "site_node/pipeline.hpp"
#include "site_node/stream/viewer_links.hpp"

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

namespace atrium::site_node {

/// Connects the bus to site_node/stream: takes the feedback of viewers, decides how to code the
/// next metaframe, and logs each change of level. Thread-safe. Metaframes overlap: one may be
/// offered before the previous one is coded, so the pacing sees byte counts one metaframe late.
class StreamAdapter {
public:
    StreamAdapter(const stream::StreamOptions& options,
                  int jpeg_quality,
                  double rate_hz,
                  std::string site,
                  bus::Reader<bus::StreamFeedback> feedback);

    struct Choice {
        std::size_t index = 0;  // in the ladder
        stream::Level level;
    };
    /// Decides how to code a new metaframe. Empty: skip it, to reduce the rate.
    std::optional<Choice> offer(stream::Time now);

    /// The metaframe offered last is not sent after all; counts it as dropped for the rate.
    void give_back();

    /// Reports the size of a metaframe coded with `choice`.
    void coded(const Choice& choice, const SiteFrame& frame, stream::Time now);

    bus::StreamState state() const;

private:
    void take_feedback(stream::Time now);
    void add(const bus::StreamFeedback& feedback, stream::Time now);
    void log_level_change(const stream::StreamCap& cap);

    std::mutex mutex_;  // guards all except state_
    std::string site_;
    bus::Reader<bus::StreamFeedback> feedback_;
    stream::RateController controller_;
    stream::ViewerLinks links_;
    std::size_t logged_level_ = 0;

    app::log::OncePerSecond complaints_;

    mutable std::mutex state_mutex_;
    bus::StreamState state_;
};

}  // namespace atrium::site_node
