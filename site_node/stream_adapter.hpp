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

/// Between the bus and site_node/stream: takes what viewers report, decides how the next metaframe
/// is coded, and logs each step. Thread-safe. Metaframes overlap: one may be offered before the one
/// before it is coded, so that the pacing sees the bytes of a metaframe one later.
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
    /// A metaframe is there: how to code it. Nothing: it is to be left out, for the rate.
    std::optional<Choice> offer(stream::Time now);

    /// That metaframe was coded, just now.
    void coded(const Choice& choice, const SiteFrame& frame, stream::Time now);

    bus::StreamState state() const;

private:
    void take_feedback(stream::Time now);
    void add(const bus::StreamFeedback& feedback, stream::Time now);
    void tell(const stream::StreamCap& cap);

    std::mutex mutex_;  // of all but the state
    std::string site_;
    bus::Reader<bus::StreamFeedback> feedback_;
    stream::RateController controller_;
    stream::ViewerLinks links_;
    std::size_t told_level_ = 0;

    app::log::OncePerSecond complaints_;

    mutable std::mutex state_mutex_;
    bus::StreamState state_;
};

}  // namespace atrium::site_node
