#pragma once

#include "tests/support/impaired_network.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace atrium::test {

/// Settings for Cyclone DDS between hosts of the network that know each other by address. The
/// elements of `internal` are added to those of <Internal>. A message is one UDP datagram; larger
/// ones than the MTU are cut by IP.
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
    std::vector<CompleteFrame> complete;  // in the order in which they became so
    std::size_t num_samples = 0;          // of 9 per frame
    std::size_t num_out_of_order = 0;     // samples older than one of the same key before
    std::vector<double> write_ms;         // of each frame
    std::uint64_t num_failed_writes = 0;
    std::uint64_t retransmitted_bytes = 0;
    LineCounters there;  // the way of the data, from host to hub; of this stream alone
    LineCounters back;   // the way of the acknowledgements, likewise
    double seconds = 0.0;

    double share_complete() const;
    double age_ms(double share) const;  // of complete frames, at this share, the youngest first
    /// Longest time without a newer complete frame, between the first one and the last.
    double longest_gap_ms() const;
    double write_ms_at(double share) const;
};

/// A stream from host 0 to host 1 by programs of their own.
class StreamOverLink {
public:
    /// Both programs are started and have found each other.
    static Expected<std::unique_ptr<StreamOverLink>> start(ImpairedNetwork& network,
                                                           const StreamSettings& settings);
    HostedProcess& writer() { return *writer_; }
    HostedProcess& reader() { return *reader_; }
    /// Waits until all frames are written, and what is on its way has come.
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

/// The report as one row, or without one the heads of the columns.
std::string table_head();
std::string table_row(const std::string& name,
                      const StreamReport& report,
                      std::uint64_t num_frames);

}  // namespace atrium::test
