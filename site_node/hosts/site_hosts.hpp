#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "core/config/table_reader.hpp"

#include <span>
#include <string>
#include <vector>

namespace atrium::hosts {

/// `[[host]]` of a site file: a computer of the site and what it does.
struct HostEntry {
    std::string name;                  // as `hostname` prints it
    std::vector<std::string> cameras;  // of the rig, by name
    bool takes_any = false;  // cameras = "auto": those that answer there and that no host names
    bool is_model = false;   // collects the silhouettes and computes the hull
    std::string place;       // in the file, for errors: "site.toml:7"
    std::vector<std::string> regions{};  // whose hulls it computes instead of the model part
    // of the computer, for `atrium plan` only
    int cores = 4;
    double score = 0.0;            // of one core (bench/score.sh); 0: as the machine of the costs
    double link_gbit_per_s = 1.0;  // its network
};

/// Reads every `[[host]]`. `reader` collects the errors.
void read_hosts(config::TableReader& reader, std::vector<HostEntry>& hosts);

/// Checks the hosts of site `site` against its rig and the names of its regions: each camera hangs
/// on one host, each region is on one at most, one host has the model part. Errors: kConfiguration,
/// with the place in the file.
Expected<void> check_hosts(const std::vector<HostEntry>& hosts,
                           const config::Rig& rig,
                           std::span<const std::string> regions,
                           const std::string& site);

/// Those with cameras = "auto", if there are several: which of them has which camera shows only
/// when they run.
std::vector<std::string> hosts_that_share(const std::vector<HostEntry>& hosts);

/// The host other than the model part's that computes this region; null: the model part does.
const HostEntry* host_of_region(const std::vector<HostEntry>& hosts, const std::string& region);

/// Finds the entry of host `name`. Error kConfiguration: names the hosts of the file.
/// What a camera node must have in common with the model part: rig, rate, and its own `[[host]]`.
std::uint64_t part_fingerprint(const config::Rig& rig, const HostEntry& host);

/// The host of this name.
Expected<HostEntry> find_host(const std::vector<HostEntry>& hosts, const std::string& name);

/// The cameras that may hang on `host`: its own, or all that no other host names.
std::vector<std::string> cameras_of(const HostEntry& host,
                                    const std::vector<HostEntry>& hosts,
                                    const config::Rig& rig);

}  // namespace atrium::hosts
