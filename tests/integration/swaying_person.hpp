#pragma once

#include <filesystem>

namespace atrium::test {

/// Writes a recording of a person who sways, as masks of eight cameras. Throws if it cannot.
void write_swaying_person(const std::filesystem::path& folder, int num_instants);

}  // namespace atrium::test
