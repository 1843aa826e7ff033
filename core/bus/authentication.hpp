#pragma once

#include "core/base/expected.hpp"

#include <dds/dds.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

/// Watches the authentication of other programs: wraps Cyclone's plugin, which reads the list of
/// revoked keys only once and does not say whom it refuses, and that for encryption, to know whom
/// it still hears (peer_leases.hpp). Private to core/bus.
namespace atrium::bus {

/// Loads Cyclone's plugins and ours (security_plugin.cpp) and returns the path of ours, for
/// Cyclone's settings. Fails with kNotFound if one of them is not installed.
Expected<std::string> install_security();

/// Cuts all programs of `world` whose key has one of these serial numbers (keys::Revocation) off
/// from this process, and refuses them from now on. The lists of several calls add up.
/// Thread-safe.
void refuse_keys(const std::string& world, const std::set<std::string>& serials);

/// Deletes what Cyclone knows of these participants: their next announcements begin anew. Those of
/// this process stay. A participant of the caller's must hold the domain open. Not for threads of
/// Cyclone.
void forget_participants(std::uint32_t domain, const std::vector<dds_guid_t>& participants);

/// What is known of a participant of another process.
enum class Standing : std::uint8_t {
    kNoKeys,   // it offers none
    kWaits,    // it offers some, and the handshake has not ended
    kRefused,  // this process refused them, and logged why
    kProven,
};
/// Thread-safe.
Standing standing_of(const dds_guid_t& participant);

/// Why the keys of a participant were refused or cut off last, and whose they are: "its key is
/// revoked (viewer bob)"; empty: they were not. Thread-safe.
std::string refusal_of(const dds_guid_t& participant);

/// The member whose key a program has proven: "viewer bob"; empty: none. Thread-safe.
std::string proven_name(const dds_guid_t& participant);
/// The same for the first program whose GUID is in a line that Cyclone logs. Thread-safe.
std::string proven_name_in(const std::string& line);

}  // namespace atrium::bus
