#pragma once

#include <cstdint>

namespace atrium::test {

/// The object in the states that the attacker publishes.
inline constexpr std::uint32_t kForgedObject = 4242;

}  // namespace atrium::test
