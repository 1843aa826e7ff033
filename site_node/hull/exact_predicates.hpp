#pragma once

#include <array>
#include <cstdint>

namespace atrium::hull::exact {

/// Exact predicates on an integer grid, where the hull is computed. Coordinates of viewing rays
/// have up to 38 bits, coordinates of camera centres (relative to the middle of the rig) up to 45.
/// Each predicate is the sign of a polynomial of these with at most 480 bits, evaluated without
/// rounding; no two predicates can contradict each other. Callers use a floating-point filter first
/// (doubles with an error bound) and call these as the exact fallback.
///
/// A result of zero means that the input is not in general position.
using Vector = std::array<std::int64_t, 3>;
inline constexpr double kMaxRay = 137438953472.0;       // 2^37, per coordinate
inline constexpr double kMaxCentre = 17592186044416.0;  // 2^44; a baseline has one bit more

__extension__ typedef __int128 Int128;

/// Returns the sign of a . (b x c). Requires |a| <= 2^45 and |b|, |c| <= 2^37 per coordinate.
int sign_of_determinant(const Vector& a, const Vector& b, const Vector& c);

/// The line in which a strip of another camera cuts a strip ("own" below), in the chart of the own
/// strip: phi = 0 and 1 on its two rays, u = 1 / depth. It is u = -((1 - phi) at_from + phi at_to)
/// / offset, in units of the grid (ray unit / centre unit).
struct Line {
    Int128 at_from = 0;  // normal of the other strip . first ray
    Int128 at_to = 0;    // normal . second ray
    Int128 offset = 1;   // normal . (own camera's centre - other's)
};

/// The line at infinity, u = 0.
inline constexpr Line kInfinity{0, 0, 1};

/// Returns the line of the other strip in the chart of the own strip, from the rays of both.
Line line_of(const Vector& other_from,
             const Vector& other_to,
             const Vector& own_from,
             const Vector& own_to,
             const Vector& own_centre_minus_other);

/// A place along the own strip: phi = w_to / (w_from + w_to).
struct Place {
    Int128 w_from = 1;
    Int128 w_to = 0;
};

/// Returns the place at which `ray` of another camera pierces the own strip; `baseline` joins the
/// two centres. Both weights are positive.
Place place_of(const Vector& ray,
               const Vector& baseline,
               const Vector& own_from,
               const Vector& own_to);

/// Return the sign of l - r: of phi, of u at `at`, of the slope du/dphi. Offsets must not be zero.
int compare_phi(const Place& l, const Place& r);
int compare_u(const Line& l, const Line& r, const Place& at);
int compare_slope(const Line& l, const Line& r);

/// Returns the sign of the difference in phi between the crossing of l1 with l2 and the crossing of
/// r1 with r2. Also 0 if either pair is parallel.
int compare_crossings(const Line& l1, const Line& l2, const Line& r1, const Line& r2);

/// A point of the chart. `crossing_of` and `u_of` compute in integers and round once at the end,
/// for lines so nearly parallel, or so nearly through the camera, that doubles would lose all
/// digits. The result is not finite if the point does not exist.
struct Point {
    double phi = 0.0;
    double u = 0.0;  // ray unit / centre unit
};
Point crossing_of(const Line& l, const Line& r);
double u_of(const Line& line, const Place& at);

}  // namespace atrium::hull::exact
