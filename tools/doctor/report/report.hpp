#pragma once

#include "tools/doctor/checks/finding.hpp"
#include "tools/doctor/facts/facts.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace atrium::doctor {

/// One line of what was checked, with the value found, or why it is unknown.
struct Checked {
    std::string what;
    std::string value;
};
std::vector<Checked> describe(const Facts& facts);

struct TextStyle {
    std::size_t width = 100'000;  // columns: sentences are wrapped, command lines never
    bool has_colour = false;
    bool says_healthy = false;  // one line if nothing is wrong
    bool shows_checked = false;
};

/// The report for people; empty if nothing is wrong and the style asks for nothing more.
std::string report_text(std::span<const Finding> findings,
                        const std::vector<Checked>& checked,
                        const TextStyle& style);

/// The report as one JSON object.
std::string report_json(std::span<const Finding> findings,
                        const std::vector<Checked>& checked,
                        const Roles& roles);

/// True if a finding stops Atrium or costs pictures.
bool is_ill(std::span<const Finding> findings);

/// Names of the roles, "site", "world", "viewer", "camera".
std::vector<std::string> names_of(const Roles& roles);

}  // namespace atrium::doctor
