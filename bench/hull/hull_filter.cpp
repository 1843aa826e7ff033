#include "bench/hull/hull_scenes.hpp"
#include "site_node/hull/cones.hpp"
#include "site_node/hull/exact_predicates.hpp"
#include "site_node/hull/pencils.hpp"
#include "site_node/hull/rounding.hpp"
#include "site_node/hull/strip_chart.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

// Tightness of the error bounds of the hull's floating-point filter: the largest ratio of error and
// bound over many scenes, for each kind of number. Above 1 a decision could be wrong. `hull_filter
// [number of random scenes]`. True values come from the integers, in long double.
namespace atrium::bench {
namespace {

using hull::Cones;
using hull::Pencils;
using hull::PencilSide;
using hull::StripChart;
using Real = long double;
using Real3 = std::array<Real, 3>;

struct Worst {
    Real ratio = 0.0;
    std::uint64_t count = 0;
    std::uint64_t above = 0;  // 1

    void add(Real error, Real bound) {
        if (!std::isfinite(static_cast<double>(bound))) return;  // always decided exactly
        ++count;
        const Real share = error / bound;
        if (share > 1.0L) ++above;
        ratio = std::max(ratio, share);
    }
};
struct Report {
    Worst angle, offset, end, phi, event;
};

Real3 real(const hull::exact::Vector& v) {
    return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}
Real dot(const Real3& a, const Real3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Real3 cross(const Real3& a, const Real3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real3 unit(const Real3& a) {
    const Real n = std::sqrt(dot(a, a));
    return {a[0] / n, a[1] / n, a[2] / n};
}

template <typename Number>
Number pseudo_angle(Number x, Number y) {
    const Number p = x / (std::abs(x) + std::abs(y));
    return y < 0 ? p - 1 : 1 - p;
}

// The bound in pencils.cpp for one ray in the pencil of views i < k.
void check_angles(const Cones& cones, const Pencils& pencils, Report& report) {
    for (std::size_t i = 0; i < cones.num_views(); ++i) {
        for (std::size_t k = i + 1; k < cones.num_views(); ++k) {
            const Real3 axis = unit(real(cones.exact_baseline(i, k)));
            const Eigen::Vector3d baseline = cones.views[k].centre - cones.views[i].centre;
            int least = 0;
            baseline.cwiseAbs().minCoeff(&least);
            Real3 zero{};
            zero[static_cast<std::size_t>(least)] = 1.0L;
            const Real3 e2 = unit(cross(axis, zero));
            const Real3 e1 = cross(e2, axis);
            for (const auto& [own, other] : {std::pair{i, k}, std::pair{k, i}}) {
                const PencilSide& side = pencils.side(own, other);
                const Cones::View& view = cones.views[own];
                for (std::uint32_t r = 0; r < view.last_ray - view.first_ray; ++r) {
                    const std::uint32_t ray = view.first_ray + r;
                    const double x = side.across[r].x();
                    const double y = side.across[r].y();
                    const double length = std::abs(x) + std::abs(y);
                    const double error = 16.0 * hull::kRounding * cones.ray_length[ray];
                    if (!(error < length)) continue;
                    const Real3 exact = real(cones.exact_ray[ray]);
                    const Real truth = pseudo_angle(dot(e1, exact), dot(e2, exact));
                    Real difference = std::abs(truth - pseudo_angle(x, y));
                    difference = std::min(difference, 4.0L - difference);
                    report.angle.add(difference, error / length);
                }
            }
        }
    }
}

void check_offsets(const Cones& cones, const Pencils& pencils, Report& report) {
    for (std::size_t s = 0; s < cones.strips.size(); ++s) {
        const Cones::Strip& strip = cones.strips[s];
        const Cones::View& view = cones.views[strip.view];
        for (std::size_t k = 0; k < cones.num_views(); ++k) {
            if (k == strip.view) continue;
            const PencilSide::Offset& offset =
                pencils.side(strip.view, k).offset[s - view.first_strip];
            if (offset.inverse == 0.0) continue;
            const Real unit =
                static_cast<Real>(view.ray_unit) * view.ray_unit * cones.centre_unit_m;
            // (from x to) . baseline; the strip's normal is to x from
            const hull::exact::Line line =
                hull::exact::line_of(cones.exact_ray[strip.from],
                                     cones.exact_ray[strip.to],
                                     {},
                                     {},
                                     cones.exact_baseline(strip.view, k));
            const Real truth = -unit * static_cast<Real>(line.offset);
            const Real computed = cones.normal[s].dot(cones.views[k].centre - view.centre);
            report.offset.add(std::abs(truth - computed), offset.error);
        }
    }
}

hull::exact::Line line_of(const Cones& cones, std::uint32_t own, std::uint32_t other) {
    const Cones::Strip& a = cones.strips[own];
    const Cones::Strip& b = cones.strips[other];
    return hull::exact::line_of(cones.exact_ray[b.from],
                                cones.exact_ray[b.to],
                                cones.exact_ray[a.from],
                                cones.exact_ray[a.to],
                                cones.exact_baseline(b.view, a.view));
}

void check_chart(const Cones& cones, std::uint32_t own, const StripChart& chart, Report& report) {
    const Cones::Strip& strip = cones.strips[own];
    const Real unit = static_cast<Real>(cones.views[strip.view].ray_unit) / cones.centre_unit_m;
    std::set<std::uint32_t> pieces(chart.visible_at_start().begin(),
                                   chart.visible_at_start().end());
    for (const std::uint32_t e : chart.order()) {
        const StripChart::Event& event = chart.event(e);
        pieces.insert(event.arriving.begin(), event.arriving.begin() + event.num_arriving);
        pieces.insert(event.leaving.begin(), event.leaving.begin() + event.num_leaving);
    }
    for (const std::uint32_t p : pieces) {
        const StripChart::Piece& piece = chart.piece(p);
        if (piece.strip == StripChart::kInfinityStrip) continue;
        const hull::exact::Line line = line_of(cones, own, piece.strip);
        const Real from = -unit * static_cast<Real>(line.at_from) / static_cast<Real>(line.offset);
        const Real to = -unit * static_cast<Real>(line.at_to) / static_cast<Real>(line.offset);
        report.end.add(std::abs(from - chart.u(p, 0.0)), piece.error);
        report.end.add(std::abs(to - chart.u(p, 1.0)), piece.error);
        for (const std::uint32_t e : {piece.start_event, piece.end_event}) {
            if (e == StripChart::kNone) continue;
            const StripChart::Event& event = chart.event(e);
            const hull::exact::Place at =
                hull::exact::place_of(cones.exact_ray[event.ray],
                                      cones.exact_baseline(strip.view, event.view),
                                      cones.exact_ray[strip.from],
                                      cones.exact_ray[strip.to]);
            const Real w_from = static_cast<Real>(at.w_from);
            const Real w_to = static_cast<Real>(at.w_to);
            const Real truth = w_to / (w_from + w_to);
            report.phi.add(std::abs(truth - event.phi), event.phi_error);
            const Real u = (w_from * from + w_to * to) / (w_from + w_to);
            report.event.add(std::abs(u - chart.u(p, event.phi)),
                             piece.error + std::abs(piece.slope) * event.phi_error);
        }
    }
}

void check(const std::vector<hull::SilhouetteView>& views, Report& report) {
    hull::HullScratch scratch;
    const hull::VisualHull result = hull::compute_visual_hull(views, {}, scratch);
    if (result.status == hull::HullStatus::kTooFewViews ||
        result.status == hull::HullStatus::kTooComplex)
        return;
    const Cones& cones = hull::intersected_cones(scratch);
    Pencils pencils;
    SerialExecutor executor;
    if (!hull::build_pencils(cones, executor, pencils)) return;
    check_angles(cones, pencils, report);
    check_offsets(cones, pencils, report);
    StripChart chart;
    for (const Cones::Chain& chain : cones.chains) {
        for (std::uint32_t s = chain.first_strip; s < chain.last_strip; ++s) {
            if (s == chain.first_strip) {
                chart.start(cones, pencils, s, hull::HullOptions{}.max_steps);
            } else {
                chart.go_on(s);
            }
            if (!chart.collect()) break;
            if (chart.may_have_faces()) check_chart(cones, s, chart, report);
        }
    }
}

void print(const char* name, const Worst& worst) {
    std::printf("%-38s %12llu  %.3f  %llu\n",
                name,
                static_cast<unsigned long long>(worst.count),
                static_cast<double>(worst.ratio),
                static_cast<unsigned long long>(worst.above));
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) {
    using namespace atrium;
    const int num_scenes = argc > 1 ? std::atoi(argv[1]) : 300;
    bench::Report report;
    for (const char* name : {"person_10k", "person_24views", "torus", "cube_degenerate"}) {
        if (const auto views = bench::shared_set(name)) bench::check(*views, report);
    }
    bench::check(bench::person_views(8, 250), report);
    for (int seed = 0; seed < num_scenes; ++seed) {
        const auto number = static_cast<std::uint64_t>(seed);
        bench::check(test::make_scene(test::random_scene_options(number), number), report);
    }
    std::printf("%-38s %12s  %s  %s\n", "number", "checked", "worst error / bound", "above 1");
    bench::print("angle of a ray around a baseline", report.angle);
    bench::print("strip normal . baseline", report.offset);
    bench::print("u of a piece at the strip's rays", report.end);
    bench::print("phi of an event", report.phi);
    bench::print("u of a piece at an event", report.event);
    return report.angle.above + report.offset.above + report.end.above + report.phi.above +
                       report.event.above >
                   0
               ? 1
               : 0;
}
