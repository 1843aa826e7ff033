#pragma once

#include "core/base/expected.hpp"
#include "tools/doctor/facts/collect.hpp"
#include "tools/doctor/facts/system.hpp"
#include "tools/doctor/report/report.hpp"

#include <filesystem>
#include <optional>
#include <string>

/// Says what is wrong on this host for Atrium, and the command that mends it.
namespace atrium::doctor {

struct Options {
    std::filesystem::path file = {};  // of a site, world or viewer; empty: none
    std::optional<Roles> roles = {};  // nullopt: those of the file, else what fits
    std::string host = {};            // of a site on several hosts; empty: the system's
    std::string network = {};         // empty: the file's, else lan
    std::string interface = {};       // empty: the file's
    std::filesystem::path recordings = {};
    std::filesystem::path keys = {};
    std::filesystem::path programs = {};  // empty: not examined
    std::filesystem::path root = {};      // of a copy of a host's files; empty: this host
    bool is_json = false;
    bool is_verbose = false;
};

struct Start {
    bool go_on = false;
    int exit_code = 0;
};
/// Prints help, version or the error and tells the program to end.
Start parse_command_line(int argc, char** argv, Options& options);

struct Report {
    std::string text;  // for standard output; empty if there is nothing to say
    bool is_ill = false;
};

/// Examines the system. Errors: a file that the options name is missing or wrong.
Expected<Report> examine(const Options& options, const System& system, const TextStyle& style);

}  // namespace atrium::doctor
