#pragma once

#include <array>
#include <cstdint>

namespace atrium::hull::exact {

/// The numbers that are intersected, on an integer grid: viewing rays have up to 38 bits, camera
/// centres up to 45 (relative to the rig's middle), and every decision below is the sign of a
/// polynomial of these with at most 480 bits. It is computed without rounding, so that no two
/// decisions contradict each other; callers first try doubles with an error bound.
///
/// Zero is an answer as well: the input is not in general position.
using Vector = std::array<std::int64_t, 3>;
inline constexpr double kMaxRay = 137438953472.0;       // 2^37
inline constexpr double kMaxCentre = 17592186044416.0;  // 2^44: a baseline has one bit more

__extension__ typedef __int128 Int128;

/// Sign of a . (b x c), |a| <= 2^45 and |b|, |c| <= 2^37.
int sign_of_determinant(const Vector& a, const Vector& b, const Vector& c);

/// The line in which another camera's strip cuts a strip, in the chart of the latter: phi = 0 and 1
/// on its two rays, u = 1 / depth; u = -((1 - phi) at_from + phi at_to) / offset.
struct Line {
    Int128 at_from = 0;  // normal of the other strip . the first ray
    Int128 at_to = 0;    // . the second ray
    Int128 offset = 1;   // . (this camera's centre - the other's)
};

/// u = 0: infinity.
inline constexpr Line kInfinity{0, 0, 1};

Line line_of(const Vector& other_from,
             const Vector& other_to,
             const Vector& own_from,
             const Vector& own_to,
             const Vector& own_centre_minus_other);

/// A place along the strip: phi = w_to / (w_from + w_to).
struct Place {
    Int128 w_from = 1;
    Int128 w_to = 0;
};

/// Where `ray` of another camera pierces the strip; both weights are positive.
Place place_of(const Vector& ray,
               const Vector& baseline,
               const Vector& own_from,
               const Vector& own_to);

/// Signs of l - r. Offsets must not be zero.
int compare_phi(const Place& l, const Place& r);
int compare_u(const Line& l, const Line& r, const Place& at);
int compare_slope(const Line& l, const Line& r);

/// Of the places where l1 and l2, and where r1 and r2 cross; 0 as well where a pair is parallel.
int compare_crossings(const Line& l1, const Line& l2, const Line& r1, const Line& r2);

/// The same places as doubles, rounded at the very end: for lines so nearly parallel, or so nearly
/// through the camera, that doubles would lose them. Not finite where there is no such place.
struct Point {
    double phi = 0.0;
    double u = 0.0;  // in units of the grid: ray units / centre units
};
Point crossing_of(const Line& l, const Line& r);
double u_of(const Line& line, const Place& at);

}  // namespace atrium::hull::exact
