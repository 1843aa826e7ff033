#pragma once

#include "tests/support/network/impaired_network.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace atrium::test {

/// A simulated room of eight cameras at 30 Hz, and a viewer that draws nothing.
struct SiteSettings {
    int jpeg_quality = 86;
    std::filesystem::path cache;  // of the room's pictures, which are rendered if absent
    /// Options of both programs, instead of those of the network `wan`. With them the programs run
    /// in the network of this process.
    std::vector<std::string> bus_options;
};

struct ShownFrame {
    std::uint64_t id = 0;  // assigned by the site at its capture
    std::int64_t capture_ns = 0;
    std::int64_t complete_ns = 0;  // when the viewer has all of its parts

    double age_ms() const { return static_cast<double>(complete_ns - capture_ns) * 1e-6; }
};

/// The fate of the frames of an interval. `now_ns` of a Moment and these times are on one clock.
struct SiteReport {
    std::size_t num_published = 0;           // in that interval
    std::size_t num_complete = 0;            // of those
    std::vector<std::int64_t> published_ns;  // capture times of all, in order
    std::vector<ShownFrame> shown;           // all, in the order of completion
    std::size_t num_out_of_order = 0;        // completed after a newer one; over the whole run
    std::string out_of_order;                // which ones
    std::vector<double> ages_ms;             // of those that completed in that interval, sorted
    double bytes_per_s = 0.0;                // on the link, from the site, in that interval
    std::int64_t resident_before = 0;        // [B] of the site
    std::int64_t resident_after = 0;
    std::string output_of_site;

    double share() const;
    /// Frames per second that the site published, of captures between the two times.
    double published_per_s(std::int64_t from_ns, std::int64_t to_ns) const;
    double age_ms(double share) const;
    /// Time until the first complete frame with a later capture. NaN if there is none.
    double recovery_ms(std::int64_t since_ns) const;
};

/// A moment of a run.
struct Moment {
    std::int64_t now_ns = 0;
    std::uint64_t sent_bytes = 0;
    std::int64_t resident_bytes = 0;  // of the site
};

/// bin/site_node on host 0 and a viewer on host 1, each with the options that a user would give.
class SiteOverLink {
public:
    /// Starts both and waits until frames arrive. `network` may be null if `bus_options` tell the
    /// programs how to find each other.
    static Expected<std::unique_ptr<SiteOverLink>> start(ImpairedNetwork* network,
                                                         const SiteSettings& settings);
    HostedProcess& site() { return *site_; }
    HostedProcess& viewer() { return *viewer_; }
    Moment moment() const;
    /// Waits until the viewer has all parts of a frame that was captured after that time. Returns
    /// false after a minute.
    bool wait_for_frame_after(std::int64_t capture_ns);
    /// Ends both. The report covers the time from one moment to the other.
    Expected<SiteReport> finish(const Moment& from, const Moment& to);

private:
    explicit SiteOverLink(ImpairedNetwork* network) : network_(network) {}
    Expected<std::unique_ptr<HostedProcess>> start_on(int host,
                                                      std::vector<std::string> command,
                                                      const SiteSettings& settings) const;
    ImpairedNetwork* network_;
    std::unique_ptr<HostedProcess> site_;
    std::unique_ptr<HostedProcess> viewer_;
};

/// Resident memory of a process. 0 if it has ended.
std::int64_t resident_bytes(pid_t id);

}  // namespace atrium::test
