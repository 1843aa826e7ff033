#pragma once

#include "tests/support/network/impaired_network.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace atrium::test {

/// Settings for Cyclone DDS between hosts of the network that know each other by address. The
/// elements of `internal` are added to those of <Internal>. A message is one UDP datagram, which IP
/// fragments above the MTU.
std::string network_xml(const ImpairedNetwork& network,
                        const std::string& internal,
                        int message_bytes = 1400,
                        int fragment_bytes = 1300);

struct StreamSettings {
    std::uint64_t num_frames = 300;  // at 30 Hz, each of one mesh and eight textures
    std::size_t mesh_bytes = 20'000;
    std::size_t texture_bytes = 7'000;
    int num_texture_writers = 1;  // 1..8, which share the cameras
    std::filesystem::path network_file;
    std::filesystem::path profiles_file;
};

struct CompleteFrame {
    std::uint64_t number = 0;  // from 1
    std::int64_t capture_ns = 0;
    std::int64_t complete_ns = 0;  // when the last of its samples was taken
};

struct StreamReport {
    std::vector<CompleteFrame> complete;  // in the order of completion
    std::size_t num_samples = 0;          // of 9 per frame
    std::size_t num_out_of_order = 0;     // samples older than an earlier one of the same key
    std::vector<double> write_ms;         // of each frame
    std::uint64_t num_failed_writes = 0;
    std::uint64_t retransmitted_bytes = 0;
    LineCounters there;  // data direction, from host to hub; of this stream alone
    LineCounters back;   // acknowledgement direction, likewise
    double seconds = 0.0;

    double share_complete() const;
    // of complete frames, at this fraction, sorted from the youngest
    double age_ms(double share) const;
    /// Longest time without a newer complete frame, between the first frame and the last.
    double longest_gap_ms() const;
    double write_ms_at(double share) const;
};

/// A stream from host 0 to host 1 between two separate programs.
class StreamOverLink {
public:
    /// Starts both programs and waits until they are matched.
    static Expected<std::unique_ptr<StreamOverLink>> start(ImpairedNetwork& network,
                                                           const StreamSettings& settings);
    HostedProcess& writer() { return *writer_; }
    HostedProcess& reader() { return *reader_; }
    /// Waits until all frames are written and nothing is on its way.
    Expected<StreamReport> finish();

private:
    StreamOverLink(ImpairedNetwork& network, const StreamSettings& settings)
        : network_(network), settings_(settings) {}
    ImpairedNetwork& network_;
    StreamSettings settings_;
    std::unique_ptr<HostedProcess> writer_;
    std::unique_ptr<HostedProcess> reader_;
    LineCounters there_before_;
    LineCounters back_before_;
    std::chrono::steady_clock::time_point started_;
};

/// The report as one table row. Without a report, the column heads.
std::string table_head();
std::string table_row(const std::string& name,
                      const StreamReport& report,
                      std::uint64_t num_frames);

}  // namespace atrium::test
