#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/physics/world_state.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace atrium::world_server {

/// The state of a whole world as it is kept in a file: what moved, what commands added, and by its
/// absence what they removed.
struct SavedWorld {
    std::uint64_t description = 0;  // hash of the world's description that the state belongs to
    std::uint32_t next_id = 0;      // of the next object that is added without an id
    std::vector<bus::SceneObject> added;  // by commands, in full
    physics::WorldState state;
};

/// A header (magic, version, length, checksum) and what it is about; little endian on any machine.
std::vector<std::uint8_t> encode(const SavedWorld& world);

/// Trusts nothing: kInvalidData, with what is wrong, for bytes that `encode` did not make, or that
/// changed since. What it returns has passed `bus::check` and `physics::is_valid`.
Expected<SavedWorld> decode(std::span<const std::uint8_t> bytes);

/// Replaces the file as a whole: whoever reads it, or starts after a crash at any moment, has the
/// old content or the new one. Errors name the file.
Expected<void> write_atomically(const std::filesystem::path& file,
                                std::span<const std::uint8_t> bytes);

/// Whether `write_atomically` could be done now, without doing it: kUnavailable, with the reason.
Expected<void> check_writable(const std::filesystem::path& file);

/// kNotFound where there is none; kInvalidData where it is larger than any state.
Expected<std::vector<std::uint8_t>> read_file(const std::filesystem::path& file);

/// Renames a file that cannot be used, so that the next save does not overwrite it; returns its new
/// name, which nothing had before.
Expected<std::filesystem::path> put_aside(const std::filesystem::path& file);

}  // namespace atrium::world_server
