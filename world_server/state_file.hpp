#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/physics/state/world_state.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace atrium::world_server {

/// State of a whole world in the state file: motion, and objects added or edited. A described
/// object without an entry has been removed.
struct SavedWorld {
    std::uint64_t description = 0;        // hash of the world description that the state belongs to
    std::uint32_t next_id = 0;            // for the next object added without an id
    std::vector<bus::SceneObject> added;  // added by commands, in full
    std::vector<bus::SceneObject> edited;  // described objects that were edited, in full
    std::string loaded;                    // saved world that the description is from; empty: none
    std::uint64_t world_file = 0;          // hash of the server's own description; 0: not known
    physics::WorldState state;
};

/// Encodes a header (magic, version, length, checksum) and the state. Little endian on any machine.
std::vector<std::uint8_t> encode(const SavedWorld& world);

/// Safe for untrusted input. Fails with kInvalidData and the reason if the bytes are not from
/// `encode` or were changed. The result has passed `bus::check` and `physics::is_valid`.
Expected<SavedWorld> decode(std::span<const std::uint8_t> bytes);

/// Replaces the file atomically. A reader sees either the old or the new content, even after a
/// crash at any moment. Errors name the file.
Expected<void> write_atomically(const std::filesystem::path& file,
                                std::span<const std::uint8_t> bytes);

/// Tests whether `write_atomically` would succeed now, without changing the file. kUnavailable with
/// the reason if not.
Expected<void> check_writable(const std::filesystem::path& file);

/// Reads a file. kNotFound if there is none, kInvalidData if it is larger than any state.
Expected<std::vector<std::uint8_t>> read_file(const std::filesystem::path& file);

/// Renames an unusable file to a new, unused name and returns that name. The next save then does
/// not overwrite it.
Expected<std::filesystem::path> put_aside(const std::filesystem::path& file);

}  // namespace atrium::world_server
