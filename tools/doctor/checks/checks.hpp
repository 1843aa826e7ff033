#pragma once

#include "tools/doctor/checks/finding.hpp"
#include "tools/doctor/facts/facts.hpp"

#include <string>
#include <vector>

/// Turns facts into findings. Pure functions: the same facts give the same findings.
namespace atrium::doctor {

using Findings = std::vector<Finding>;

Findings check_programs(const Facts& facts);
Findings check_site_file(const Facts& facts);
Findings check_network(const Facts& facts);
Findings check_firewall(const Facts& facts);
Findings check_cameras(const Facts& facts);
Findings check_usb_cameras(const Facts& facts);  // part of check_cameras
Findings check_clock(const Facts& facts);
Findings check_graphics(const Facts& facts);
Findings check_load(const Facts& facts);
Findings check_folders(const Facts& facts);
Findings check_keys(const Facts& facts);

/// All checks: first the findings that stop Atrium, then those that cost, then the notes.
Findings check_all(const Facts& facts);

/// The bits of an address that are those of its network.
std::uint32_t mask_of(int prefix);
bool is_in(const CardAddress& network, std::uint32_t address);
/// The card by which packets to and from this address go; nullptr if no card is in its network.
const Card* card_towards(const NetworkFacts& network, const std::string& address);
/// The cards with GigE Vision cameras that answered, each once.
std::vector<const Card*> camera_cards(const Facts& facts);

/// The wired card that cameras are most likely at, not that of the default route if there is
/// another; nullptr if there is none.
const Card* likely_camera_card(const Facts& facts);

/// The path of a program, as a word for a shell; its name if programs were not examined.
std::string path_of(const Facts& facts, const std::string& name);
bool is_there(const Facts& facts, const std::string& name);
/// The path of a program that is there and uses the network.
std::string path_of_any(const Facts& facts);
/// The command line of the program that takes this host's pictures, with the site file.
std::string capture_program(const Facts& facts);
/// What to add to a sentence whose cure is a lower rate; empty in a site of one process.
std::string same_rate_on_all(const Wishes& wishes);

/// [Mbit/s] of this host's cameras of the site file that send through `card`; 0: none or unknown.
double camera_mbit_per_s(const Facts& facts, const Card& card);

}  // namespace atrium::doctor
