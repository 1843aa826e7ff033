#include "site_node/hull/exact_predicates.hpp"

#include <boost/multiprecision/cpp_int.hpp>

namespace atrium::hull::exact {
namespace {

// 512 bits, fixed: never allocates.
using Wide = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512,
                                           512,
                                           boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked,
                                           void>>;

using Cross = std::array<Int128, 3>;

Cross cross(const Vector& a, const Vector& b) {
    return {static_cast<Int128>(a[1]) * b[2] - static_cast<Int128>(a[2]) * b[1],
            static_cast<Int128>(a[2]) * b[0] - static_cast<Int128>(a[0]) * b[2],
            static_cast<Int128>(a[0]) * b[1] - static_cast<Int128>(a[1]) * b[0]};
}

Int128 dot(const Cross& n, const Vector& v) { return n[0] * v[0] + n[1] * v[1] + n[2] * v[2]; }

Int128 magnitude(Int128 v) { return v < 0 ? -v : v; }
int sign(Int128 v) { return (v > 0) - (v < 0); }
int sign(const Wide& v) { return v.sign(); }

Wide numerator(const Line& line, const Place& at) {
    return Wide(line.at_from) * at.w_from + Wide(line.at_to) * at.w_to;
}

}  // namespace

int sign_of_determinant(const Vector& a, const Vector& b, const Vector& c) {
    return sign(dot(cross(b, c), a));
}

Line line_of(const Vector& other_from,
             const Vector& other_to,
             const Vector& own_from,
             const Vector& own_to,
             const Vector& own_centre_minus_other) {
    const Cross normal = cross(other_from, other_to);
    return {dot(normal, own_from), dot(normal, own_to), dot(normal, own_centre_minus_other)};
}

Place place_of(const Vector& ray,
               const Vector& baseline,
               const Vector& own_from,
               const Vector& own_to) {
    return {magnitude(dot(cross(ray, own_to), baseline)),
            magnitude(dot(cross(ray, own_from), baseline))};
}

int compare_phi(const Place& l, const Place& r) {
    // phi is monotone in w_to / w_from
    return sign(Wide(Wide(l.w_to) * r.w_from - Wide(r.w_to) * l.w_from));
}

int compare_u(const Line& l, const Line& r, const Place& at) {
    const Wide difference = numerator(r, at) * l.offset - numerator(l, at) * r.offset;
    return sign(difference) * sign(l.offset) * sign(r.offset);
}

int compare_slope(const Line& l, const Line& r) {
    const Wide difference =
        Wide(r.at_to - r.at_from) * l.offset - Wide(l.at_to - l.at_from) * r.offset;
    return sign(difference) * sign(l.offset) * sign(r.offset);
}

int compare_crossings(const Line& l1, const Line& l2, const Line& r1, const Line& r2) {
    // p and q are the difference of the two lines at phi = 0 and 1: phi / (1 - phi) = -p / q at the
    // crossing
    const auto difference = [](const Line& a, const Line& b, Wide& p, Wide& q) {
        p = Wide(a.at_from) * b.offset - Wide(b.at_from) * a.offset;
        q = Wide(a.at_to) * b.offset - Wide(b.at_to) * a.offset;
    };
    Wide lp;
    Wide lq;
    Wide rp;
    Wide rq;
    difference(l1, l2, lp, lq);
    difference(r1, r2, rp, rq);
    return sign(Wide(rp * lq - lp * rq)) * sign(lq) * sign(rq);
}

Point crossing_of(const Line& l, const Line& r) {
    const Wide p = Wide(l.at_from) * r.offset - Wide(r.at_from) * l.offset;
    const Wide q = Wide(l.at_to) * r.offset - Wide(r.at_to) * l.offset;
    const Wide p_minus_q = p - q;
    const double phi = p.convert_to<double>() / p_minus_q.convert_to<double>();
    // (1 - phi) : phi = -q : p
    const Wide above = Wide(p * l.at_to - q * l.at_from);
    const Wide below = Wide(p_minus_q * l.offset);
    return {phi, -above.convert_to<double>() / below.convert_to<double>()};
}

double u_of(const Line& line, const Place& at) {
    const Wide below = (Wide(at.w_from) + at.w_to) * line.offset;
    return -numerator(line, at).convert_to<double>() / below.convert_to<double>();
}

}  // namespace atrium::hull::exact
