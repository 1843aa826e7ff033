#pragma once

#include "site_node/stream/rate_controller.hpp"
#include "site_node/stream/viewer_links.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

/// A site that streams to viewers over networks, all simulated, in simulated time. The decisions
/// come from the code of site_node/stream, everything else is simulated here.
namespace atrium::test {

/// Whether a program has a processor at a time [s].
using Runs = std::function<bool(double)>;
inline bool always(double) { return true; }

// Programs that lack a processor at times. The schedule follows from the seed.
/// A quota, as a control group has it: a fraction of each 100 ms, in one piece, for up to two
/// threads.
Runs with_quota(double share, std::uint64_t seed);
/// Busy loops of other programs: it waits 4 to 24 ms, then runs for 0.5 to 10 ms.
Runs beside_busy_loops(std::uint64_t seed);
/// Stands still for half a second every two to five seconds.
Runs with_freezes(std::uint64_t seed);

/// The link to one viewer. Times are in seconds since the start.
struct SimulatedLink {
    std::string viewer = "v1";
    std::function<double(double)> bit_per_s = [](double) { return 1e9; };  // at a time
    double delay_ms = 20.0;    // one way, without a queue
    double jitter_ms = 0.0;    // each sample is up to this much later or earlier
    double loss = 0.0;         // fraction of the datagrams; each lost one is sent again
    double buffer_ms = 300.0;  // queue beyond which samples are lost for good
    std::function<double(double)> clock_offset_ms = [](double) { return 0.0; };  // of the viewer
    /// A viewer that is paused neither receives nor reports.
    std::function<bool(double)> is_paused = [](double) { return false; };
    // In the viewer's host: the thread that takes datagrams from the socket, and the one that takes
    // samples from the reader.
    Runs receiver_runs = always;
    Runs taker_runs = always;
};

struct SimulatedSite {
    stream::StreamOptions options;
    int jpeg_quality = 85;
    double rate_hz = 30.0;
    double fixed_bytes = 12e3;  // mesh and masks of a frame
    /// Colours of a frame at the best level, by default 20 to 40 Mbit/s in total.
    std::function<double(double)> colour_bytes;
    int num_cameras = 8;
    Runs runs = always;
    double interrupted = 0.0;  // fraction of samples that leave 4 to 24 ms after they are written
    std::uint64_t seed = 1;
};

/// The records of one metaframe.
struct SentFrame {
    double time_s = 0.0;
    std::size_t level = 0;
    double bytes = 0.0;
};
struct ArrivedFrame {
    double time_s = 0.0;
    double age_ms = 0.0;  // since the site sent it
    double bytes = 0.0;
};
struct ViewerRecord {
    std::vector<ArrivedFrame> arrived;  // complete ones
    int num_incomplete = 0;
};
struct Step {
    double time_s = 0.0;
    std::size_t from = 0;
    std::size_t to = 0;
    std::string set_by;
};
struct CapSample {
    double time_s = 0.0;
    double bit_per_s = 0.0;         // 0: no cap
    double wanted_bit_per_s = 0.0;  // by the scene, at the best level
};
struct StreamRecord {
    std::vector<stream::Level> ladder;
    std::vector<SentFrame> sent;
    std::vector<Step> steps;
    std::vector<CapSample> caps;
    std::vector<ViewerRecord> viewers;  // in the order of the links
};

StreamRecord simulate(const SimulatedSite& site,
                      const std::vector<SimulatedLink>& links,
                      double seconds);

// Queries of a record, between two times [s].
double max_age_ms(const ViewerRecord& viewer, double from_s, double to_s);
double median_age_ms(const ViewerRecord& viewer, double from_s, double to_s);
double carried_bit_per_s(const ViewerRecord& viewer, double from_s, double to_s);
double sent_bit_per_s(const StreamRecord& record, double from_s, double to_s);
int num_steps(const StreamRecord& record, double from_s, double to_s);
/// The largest number of bits sent in any window of one second, without its largest frame.
double busiest_second_bits(const StreamRecord& record);

}  // namespace atrium::test
