#pragma once

namespace atrium::hull {

/// Relative rounding error of one operation on doubles.
inline constexpr double kRounding = 1.1102230246251565e-16;  // 2^-53

}  // namespace atrium::hull
