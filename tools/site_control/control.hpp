#pragma once

#include "core/base/expected.hpp"
#include "site_node/hosts/site_hosts.hpp"
#include "tools/site_control/scripts.hpp"

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace atrium::site_control {

enum class Command { kUp, kDown, kStatus, kLogs };

struct ControlOptions {
    Command command = Command::kStatus;
    std::string site;
    std::vector<hosts::HostEntry> hosts;
    std::filesystem::path site_file;
    std::filesystem::path rig_file;  // empty: none is sent
    std::string this_host;
    std::vector<std::string> ssh{"ssh", "-o", "BatchMode=yes", "-o", "ConnectTimeout=5"};
    std::string programs;  // folder of the programs on each host
    int num_lines = 20;
    std::chrono::milliseconds patience = std::chrono::seconds(30);  // for each host
};

/// The site's file and its rig, placed so that the path between them stays. Error kNotFound if a
/// file cannot be read.
Expected<std::vector<SentFile>> files_to_send(const std::filesystem::path& site_file,
                                              const std::filesystem::path& rig_file);

/// The programs of a host. `site_file`: its place among the sent files.
std::vector<Program> programs_of(const hosts::HostEntry& host, const std::string& site_file);

/// Does it on all hosts at the same time. Passes each line, "HOST: TEXT", to `say`. Returns whether
/// all hosts answered and every program is as wanted.
bool control(const ControlOptions& options, const std::function<void(const std::string&)>& say);

}  // namespace atrium::site_control
