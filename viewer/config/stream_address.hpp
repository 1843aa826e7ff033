#pragma once

#include "core/base/expected.hpp"

#include <string>

namespace atrium::viewer {

/// Where a stream goes.
struct StreamTarget {
    std::string url;                  // as libavformat takes it
    std::string shown;                // for logs: without options and keys, which may be secret
    std::string format;               // the container: "mpegts" or "flv"
    bool waits_for_receiver = false;  // listens; else it calls the receiver
};

/// Parses `srt://host:port?mode=caller|listener`, `tcp://host:port` (`?mode=listener` listens),
/// `udp://host:port`, `rtmp://host/app/key` and `rtmps://`. Other options of the address go to
/// libavformat. Error kConfiguration names `video.stream` and the valid forms.
Expected<StreamTarget> parse_stream(const std::string& url);

}  // namespace atrium::viewer
