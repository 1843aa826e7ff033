#include "site_node/hosts/site_hosts.hpp"

#include "core/base/fnv1a.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "core/config/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace atrium::hosts {
namespace {

template <typename... Arguments>
tl::unexpected<Error> wrong(const std::string& place,
                            fmt::format_string<Arguments...> text,
                            Arguments&&... arguments) {
    return make_error(
        ErrorKind::kConfiguration,
        place + ": host: " + fmt::format(text, std::forward<Arguments>(arguments)...));
}

std::vector<std::string> names_of(const std::vector<HostEntry>& hosts) {
    std::vector<std::string> names;
    for (const HostEntry& host : hosts) names.push_back(host.name);
    return names;
}

// " (did you mean 'north'?)", or nothing.
std::string meant_by(const std::string& written, const std::vector<std::string>& names) {
    const std::string question = config::ask_which(config::names_meant_by(written, names));
    return question.empty() ? "" : " (" + question + ")";
}

std::string where_twice(const std::string& first, const std::string& second) {
    return first == second ? fmt::format("twice on '{}'", first)
                           : fmt::format("on '{}' and on '{}'", first, second);
}

}  // namespace

void read_hosts(config::TableReader& reader, std::vector<HostEntry>& hosts) {
    for (config::TableReader& table : reader.tables("host")) {
        HostEntry host;
        host.place = table.where("name");
        table.require("name");
        table.read("name", host.name);
        if (!config::is_valid_name(host.name))
            table.reject("name", "must be 1 to 63 characters of A-Z a-z 0-9 _ . -");
        if (table.has_array("cameras")) {
            table.read("cameras", host.cameras);
        } else {
            std::string which = table.has("cameras") ? "" : "none";
            table.read("cameras", which);
            host.takes_any = which == "auto";
            if (!host.takes_any && which != "none")
                table.reject("cameras",
                             "must be \"auto\" or a list of cameras of the rig, as in [\"door\"]");
        }
        table.read("model", host.is_model);
        table.read("regions", host.regions);
        table.read("cores", host.cores, {1, 1024});
        table.read("score", host.score, {0, 1e6});
        table.read("link_gbit_per_s", host.link_gbit_per_s, {1e-3, 1e3});
        hosts.push_back(std::move(host));
    }
}

Expected<void> check_hosts(const std::vector<HostEntry>& hosts,
                           const config::Rig& rig,
                           std::span<const std::string> regions,
                           const std::string& site) {
    std::map<std::string, std::string> host_of_camera;
    std::map<std::string, std::string> region_hosts;
    std::map<std::string, int> num_named;
    const HostEntry* model = nullptr;
    bool takes_any = false;
    for (const HostEntry& host : hosts) {
        if (++num_named[host.name] > 1) return wrong(host.place, "two are named '{}'", host.name);
        if (!config::is_valid_name(bus::host_program_name(site, host.name)))
            return wrong(
                host.place, "'{}' with the site's name must have at most 62 characters", host.name);
        if (host.is_model && model != nullptr)
            return wrong(host.place,
                         "'{}' and '{}' both have model = true; one host computes the hull",
                         model->name,
                         host.name);
        if (host.is_model) model = &host;
        takes_any |= host.takes_any;
        if (!host.is_model && !host.takes_any && host.cameras.empty() && host.regions.empty())
            return wrong(host.place,
                         "'{}' has nothing to do: give it cameras of the rig, cameras = \"auto\", "
                         "regions, or model = true",
                         host.name);
        for (const std::string& region : host.regions) {
            if (std::ranges::find(regions, region) == regions.end())
                return wrong(host.place,
                             "'{}' computes region '{}', which the file lacks; its [[hull.region]] "
                             "are {}{}",
                             host.name,
                             region,
                             regions.empty() ? "none" : fmt::format("{}", fmt::join(regions, ", ")),
                             meant_by(region, {regions.begin(), regions.end()}));
            const auto [former, is_new] = region_hosts.emplace(region, host.name);
            if (!is_new)
                return wrong(host.place,
                             "region '{}' is {}: each is computed once",
                             region,
                             where_twice(former->second, host.name));
        }
        for (const std::string& camera : host.cameras) {
            if (std::ranges::find(rig.cameras, camera, &geometry::CalibratedCamera::name) ==
                rig.cameras.end()) {
                std::vector<std::string> names;
                for (const auto& each : rig.cameras) names.push_back(each.name);
                return wrong(host.place,
                             "'{}' has camera '{}', which the rig lacks; it has {}{}",
                             host.name,
                             camera,
                             fmt::join(names, ", "),
                             meant_by(camera, names));
            }
            const auto [former, is_new] = host_of_camera.emplace(camera, host.name);
            if (!is_new)
                return wrong(host.place,
                             "camera '{}' is {}: it hangs on one",
                             camera,
                             where_twice(former->second, host.name));
        }
    }
    std::size_t num_entries = 0;  // of SiteStatus.hosts
    for (const HostEntry& host : hosts) {
        num_entries += host.takes_any || !host.cameras.empty() ? 1 : 0;
        num_entries += !host.is_model && !host.regions.empty() ? 1 : 0;
    }
    if (num_entries > bus::kMaxCamerasPerSite)
        return wrong(hosts.back().place,
                     "at most {} are possible; one with cameras and regions counts twice",
                     bus::kMaxCamerasPerSite);
    if (model == nullptr)
        return wrong(hosts.front().place, "none has model = true: which one computes the hull?");
    for (const geometry::CalibratedCamera& camera : rig.cameras) {
        if (!takes_any && !host_of_camera.contains(camera.name))
            return wrong(
                hosts.front().place,
                "camera '{}' hangs on none: add it to the cameras of its host, or give one "
                "host cameras = \"auto\"",
                camera.name);
    }
    return {};
}

std::uint64_t part_fingerprint(const config::Rig& rig, const HostEntry& host) {
    Fnv1a hash;
    hash.add(config::fingerprint(rig));
    hash.add_rounded(rig.rate_hz);
    hash.add(std::uint64_t{host.takes_any ? 1U : 0U});
    std::vector<std::string> cameras = host.cameras;
    std::ranges::sort(cameras);
    for (const std::string& camera : cameras) hash.add(camera);
    return hash.value();
}

std::vector<std::string> hosts_that_share(const std::vector<HostEntry>& hosts) {
    std::vector<std::string> names;
    for (const HostEntry& host : hosts) {
        if (host.takes_any) names.push_back(host.name);
    }
    if (names.size() < 2) names.clear();
    return names;
}

const HostEntry* host_of_region(const std::vector<HostEntry>& hosts, const std::string& region) {
    for (const HostEntry& host : hosts) {
        if (!host.is_model && std::ranges::find(host.regions, region) != host.regions.end())
            return &host;
    }
    return nullptr;
}

Expected<HostEntry> find_host(const std::vector<HostEntry>& hosts, const std::string& name) {
    const auto found = std::ranges::find(hosts, name, &HostEntry::name);
    if (found != hosts.end()) return *found;
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format("no [[host]] of the site is named '{}'; there are {}{}; --host NAME says which "
                    "one this computer is",
                    name,
                    fmt::join(names_of(hosts), ", "),
                    meant_by(name, names_of(hosts))));
}

std::vector<std::string> cameras_of(const HostEntry& host,
                                    const std::vector<HostEntry>& hosts,
                                    const config::Rig& rig) {
    if (!host.takes_any) return host.cameras;
    std::vector<std::string> free;
    for (const geometry::CalibratedCamera& camera : rig.cameras) {
        const bool is_taken = std::ranges::any_of(hosts, [&](const HostEntry& other) {
            return std::ranges::find(other.cameras, camera.name) != other.cameras.end();
        });
        if (!is_taken) free.push_back(camera.name);
    }
    return free;
}

}  // namespace atrium::hosts
