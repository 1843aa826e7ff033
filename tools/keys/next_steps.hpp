#pragma once

#include "tools/keys/commands.hpp"

#include <string>

namespace atrium::keys_tool {

/// "atrium keys export NAME -o FILE", to copy: with a tunnel the file is an invitation.
std::string export_command(const Options& options,
                           const keys::Bundle& bundle,
                           const char* more = "");

/// What the owner does after `name` got a new key, step by step, with all commands.
std::string steps_after_renewal(const Options& options,
                                const keys::KeyStore& store,
                                const keys::Bundle& renewed,
                                Timestamp now);

/// How all others learn that a key is revoked, and how its member gets a new one. `revoked` is what
/// the member had until now, with its place in the tunnel.
std::string steps_after_revocation(const Options& options,
                                   const keys::KeyStore& store,
                                   const keys::Bundle& revoked,
                                   Timestamp now);

/// Says that the member has no place in the tunnel that this world has, and how it gets one; empty
/// if it has one, or if there is no tunnel.
std::string without_tunnel(const Options& options,
                           const keys::KeyStore& store,
                           const keys::Bundle& bundle);

}  // namespace atrium::keys_tool
