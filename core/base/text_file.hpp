#pragma once

#include "core/base/expected.hpp"

#include <cstddef>
#include <filesystem>
#include <string>

namespace atrium {

/// Far more than any configuration that a person writes.
inline constexpr std::size_t kMaxTextFileBytes = std::size_t{16} << 20U;

/// Reads a whole file, also a pipe. Fails with kNotFound and the system's reason if it cannot be
/// read, with kConfiguration if it is larger than `max_bytes`.
Expected<std::string> read_text_file(const std::filesystem::path& file,
                                     std::size_t max_bytes = kMaxTextFileBytes);

}  // namespace atrium
