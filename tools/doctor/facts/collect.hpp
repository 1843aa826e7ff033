#pragma once

#include "core/base/expected.hpp"
#include "tools/doctor/facts/facts.hpp"
#include "tools/doctor/facts/system.hpp"

#include <filesystem>
#include <optional>

/// Collects facts. Nothing here judges them.
namespace atrium::doctor {

struct Request {
    std::optional<Roles> roles = {};        // nullopt: what fits this host
    std::filesystem::path programs = {};    // folder of Atrium's programs; empty: not examined
    std::filesystem::path recordings = {};  // empty: not examined
    std::filesystem::path keys = {};        // empty: kKeys if it is there
    Wishes wishes = {};
};

inline constexpr const char* kKeys = "/etc/atrium/keys";

/// Reads what the file of a site, world or viewer asks of the host named `own_host`. Errors:
/// kNotFound, kConfiguration.
Expected<Wishes> read_wishes(const std::filesystem::path& file, const std::string& own_host);
/// The roles of the programs that read the file on the host named `own_host`.
Expected<Roles> roles_of_file(const std::filesystem::path& file, const std::string& own_host);
/// The name of the examined host, as Atrium's programs write it; empty: unknown.
std::string host_name(const System& system);

/// Takes about two seconds on a live system: it measures over one and looks for cameras.
Facts collect(const System& system, const Request& request);

// The parts.
NetworkFacts collect_network(const System& system, const Wishes& wishes);
/// `opens`: who takes the pictures; nullopt: the user of the system.
CameraFacts collect_cameras(const System& system,
                            const std::vector<Program>& programs,
                            const std::optional<User>& opens);
std::vector<Program> collect_programs(const System& system, const std::filesystem::path& folder);
ClockFacts collect_clock(const System& system);
GraphicsFacts collect_graphics(const System& system, const std::filesystem::path& programs);
LoadFacts collect_load(const System& system);
FolderFacts collect_folder(const System& system,
                           const std::filesystem::path& folder,
                           std::uint64_t test_bytes);
KeyFacts collect_keys(const System& system, const std::filesystem::path& folder);

/// The table of `site_node --list-cameras`.
std::vector<FoundCamera> parse_camera_table(const std::string& table);
/// "10.77.0.1"; nullopt for anything else.
std::optional<std::uint32_t> parse_address(const std::string& text);
std::string address_text(std::uint32_t address);

}  // namespace atrium::doctor
