#pragma once

namespace atrium::hull {

/// Error of one operation on doubles, relative.
inline constexpr double kRounding = 1.1102230246251565e-16;  // 2^-53

}  // namespace atrium::hull
