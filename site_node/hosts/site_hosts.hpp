#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "core/config/table_reader.hpp"

#include <string>
#include <vector>

namespace atrium::hosts {

/// `[[host]]` of a site file: a computer of the site and what it does.
struct HostEntry {
    std::string name;                  // as `hostname` prints it
    std::vector<std::string> cameras;  // of the rig, by name
    bool takes_any = false;  // cameras = "auto": those that answer there and no other host names
    bool is_model = false;   // computes the hull
    std::string place;       // in the file, for errors: "site.toml:7"
    // of the computer, for `atrium plan` only
    int cores = 4;
    double score = 0.0;            // of one core (bench/score.sh); 0: as the machine of the costs
    double link_gbit_per_s = 1.0;  // its network
};

/// Reads every `[[host]]`. `reader` collects the errors.
void read_hosts(config::TableReader& reader, std::vector<HostEntry>& hosts);

/// Checks the hosts of site `site` against its rig: each camera hangs on one host, one host has the
/// model part. Errors: kConfiguration, with the place in the file.
Expected<void> check_hosts(const std::vector<HostEntry>& hosts,
                           const config::Rig& rig,
                           const std::string& site);

/// Finds the entry of host `name`. Error kConfiguration: names the hosts of the file.
Expected<HostEntry> find_host(const std::vector<HostEntry>& hosts, const std::string& name);

/// The cameras that may hang on `host`: its own, or all that no other host names.
std::vector<std::string> cameras_of(const HostEntry& host,
                                    const std::vector<HostEntry>& hosts,
                                    const config::Rig& rig);

}  // namespace atrium::hosts
