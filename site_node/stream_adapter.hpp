#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/messages.hpp"
#include "site_node/stream/viewer_links.hpp"

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>

namespace atrium::site_node {

/// Between the bus and site_node/stream: takes what viewers report, decides how the next metaframe
/// is coded, and tells of each step. One thread; `state` from any.
class StreamAdapter {
public:
    StreamAdapter(const stream::StreamOptions& options, int jpeg_quality, double rate_hz);

    void add(const bus::StreamFeedback& feedback, stream::Time now);
    void forget(const std::string& viewer) { links_.forget(viewer); }

    struct Choice {
        std::size_t index = 0;  // in the ladder
        stream::Level level;
    };
    /// A metaframe is there: how to code it. Nothing: it is to be left out, for the rate.
    std::optional<Choice> offer(stream::Time now);

    /// That metaframe was coded, so long after its capture.
    void coded(const Choice& choice,
               std::uint64_t frame_id,
               const stream::FrameBytes& bytes,
               std::chrono::nanoseconds capture_to_coded,
               stream::Time now);

    bus::StreamState state() const;

private:
    double own_delay_ms(std::uint64_t frame_id) const;
    void tell(const stream::StreamCap& cap);

    stream::RateController controller_;
    stream::ViewerLinks links_;
    // What the site itself took, of late: a site that needs longer is no queue in the network.
    struct OwnDelay {
        std::uint64_t frame_id = 0;
        double ms = 0.0;
    };
    std::array<OwnDelay, 128> own_delays_{};
    std::size_t newest_own_ = 0;
    std::size_t told_level_ = 0;

    mutable std::mutex state_mutex_;
    bus::StreamState state_;
};

}  // namespace atrium::site_node
