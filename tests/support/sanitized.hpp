#pragma once

namespace atrium::test {

/// True in builds with ASan or TSan, which are five to twenty times slower. Long tests measure
/// fewer cases there; the cases themselves stay the same.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace atrium::test
