#pragma once

#include "tests/support/impaired_network.hpp"

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
    std::filesystem::path cache;  // of the room's pictures: rendered where they are not there
    /// Options of both programs, instead of those of the network `wan`; the programs then run in
    /// the network of this process.
    std::vector<std::string> bus_options;
};

struct ShownFrame {
    std::uint64_t id = 0;  // counted by the site, at its capture
    std::int64_t capture_ns = 0;
    std::int64_t complete_ns = 0;  // all its parts are with the viewer

    double age_ms() const { return static_cast<double>(complete_ns - capture_ns) * 1e-6; }
};

/// What came of the frames of some time; `now_ns` of a Moment and these times are of one clock.
struct SiteReport {
    std::size_t num_published = 0;           // of that time
    std::size_t num_complete = 0;            // of those
    std::vector<std::int64_t> published_ns;  // capture times of all, in order
    std::vector<ShownFrame> shown;           // all, in the order in which they were complete
    std::size_t num_out_of_order = 0;        // complete after a newer one; of all
    std::vector<double> ages_ms;             // of those complete in that time, sorted
    double bytes_per_s = 0.0;                // on the link, from the site; of that time
    std::int64_t resident_before = 0;        // [B] of the site
    std::int64_t resident_after = 0;
    std::string output_of_site;

    double share() const;
    /// Frames per second that the site published of what it captured from one time to the other.
    double published_per_s(std::int64_t from_ns, std::int64_t to_ns) const;
    double age_ms(double share) const;
    /// From that time to the first complete frame that was captured later; NaN: none.
    double recovery_ms(std::int64_t since_ns) const;
};

/// A moment of a run.
struct Moment {
    std::int64_t now_ns = 0;
    std::uint64_t sent_bytes = 0;
    std::int64_t resident_bytes = 0;  // of the site
};

/// bin/site_node on host 0 and a viewer on host 1, each with the options that its user would give.
class SiteOverLink {
public:
    /// Both are there, and frames arrive. `network` may be null where `bus_options` say how they
    /// find each other.
    static Expected<std::unique_ptr<SiteOverLink>> start(ImpairedNetwork* network,
                                                         const SiteSettings& settings);
    HostedProcess& site() { return *site_; }
    HostedProcess& viewer() { return *viewer_; }
    Moment moment() const;
    /// Ends both; the report is of the time from one moment to the other.
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

/// Of a process; 0 where it is gone.
std::int64_t resident_bytes(pid_t id);

}  // namespace atrium::test
