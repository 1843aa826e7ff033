// A simulated site that watches its rig by the silhouettes of people who walk: how soon is a camera
// that was moved named, and is nobody blamed in an hour of changing light?
//
//     coherence_trials drift [SEEDS]     CSV: fault, runs, named rightly, median s, longest s
//     coherence_trials hour [MINUTES]    CSV: people, minutes, looks, alarms, single judgements
//                                        that blame a camera, largest coherence [px]
#include "core/base/median.hpp"
#include "site_node/coherence/coherence_watch.hpp"
#include "tests/support/people/walk_film.hpp"
#include "tests/support/people/walking_people.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/rig_maker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <optional>
#include <vector>

namespace {

using namespace atrium;
using coherence::CoherenceWatch;
using test::Filming;
using test::Random;
using test::WalkFilm;
using Contours = std::vector<std::vector<Eigen::Vector2d>>;

constexpr double kLook_s = 0.5;

std::vector<geometry::CalibratedCamera> true_rig() {
    test::RingRigOptions options;
    options.focal_px = 800.0;
    return test::make_ring_rig(options);
}

// What changing light does to the silhouettes of one camera, for a while.
struct LightChange {
    std::size_t camera = 0, first_look = 0, last_look = 0;
    enum Kind { kPatch, kWider, kNarrower, kHoles, kNumKinds } kind = kPatch;
    Eigen::Vector2d patch_px = Eigen::Vector2d::Zero();  // kPatch: something lit on the floor
    double by_px = 0.0;                                  // kWider, kNarrower
};

// About one change every ten seconds, each for 3 to 40 s.
std::vector<LightChange> light_changes(std::uint64_t seed,
                                       std::size_t num_looks,
                                       const geometry::PinholeCamera& lens,
                                       std::size_t num_cameras) {
    Random random(seed);
    std::vector<LightChange> changes;
    for (std::size_t i = 0; i < num_looks / 20; ++i) {
        LightChange change;
        change.camera = static_cast<std::size_t>(
            test::between(random, 0.0, static_cast<double>(num_cameras) - 1e-9));
        change.first_look =
            static_cast<std::size_t>(test::between(random, 0.0, static_cast<double>(num_looks)));
        change.last_look =
            change.first_look + static_cast<std::size_t>(test::between(random, 6.0, 80.0));
        change.kind = static_cast<LightChange::Kind>(
            test::between(random, 0.0, static_cast<double>(LightChange::kNumKinds) - 1e-9));
        change.patch_px = {test::between(random, 0.0, lens.width - 1.0),
                           test::between(random, 0.6 * lens.height, lens.height - 1.0)};
        change.by_px = test::between(random, 0.5, 2.0);
        changes.push_back(change);
    }
    return changes;
}

void apply(const LightChange& change, Random& random, Contours& contours) {
    switch (change.kind) {
        case LightChange::kPatch: {
            std::vector<Eigen::Vector2d> patch;
            for (int k = 0; k < 6; ++k)
                patch.push_back(
                    change.patch_px +
                    Eigen::Vector2d(
                        test::between(random, 20.0, 90.0) * std::cos(k * std::numbers::pi / 3.0),
                        test::between(random, 10.0, 40.0) * std::sin(k * std::numbers::pi / 3.0)));
            contours.push_back(std::move(patch));
            return;
        }
        case LightChange::kWider: {
            std::vector<Eigen::Vector2d> wider;
            for (const Eigen::Vector2d& p : contours[0])
                for (int k = 0; k < 8; ++k)
                    wider.push_back(p + change.by_px *
                                            Eigen::Vector2d(std::cos(k * std::numbers::pi / 4.0),
                                                            std::sin(k * std::numbers::pi / 4.0)));
            contours[0] = std::move(wider);
            return;
        }
        case LightChange::kNarrower: {
            // a loose approximation: all points nearer to the middle
            Eigen::Vector2d middle = Eigen::Vector2d::Zero();
            for (const Eigen::Vector2d& p : contours[0])
                middle += p / static_cast<double>(contours[0].size());
            for (Eigen::Vector2d& p : contours[0])
                p -= change.by_px * (p - middle) / std::max(1.0, (p - middle).norm());
            return;
        }
        default: {
            // parts that look like the wall, other ones at each look
            const double where = test::between(random, 0.0, 1.0);
            double top = 1e9, bottom = -1e9;
            for (const Eigen::Vector2d& p : contours[0]) {
                top = std::min(top, p.y());
                bottom = std::max(bottom, p.y());
            }
            const double from = top + (where - 0.1) * (bottom - top);
            const double to = top + (where + 0.1) * (bottom - top);
            std::erase_if(contours[0],
                          [&](const Eigen::Vector2d& p) { return p.y() > from && p.y() < to; });
        }
    }
}

void watch_an_hour(double minutes) {
    const auto rig = true_rig();
    fmt::print("people,minutes,looks,alarms,single judgements,largest px\n");
    for (const int num_people : {1, 2}) {
        const auto num_looks = static_cast<std::size_t>(minutes * 60.0 / kLook_s);
        const auto changes = light_changes(7, num_looks, rig.front().intrinsics, rig.size());
        Filming filming{rig};
        filming.noise_px = 1.0;
        filming.spoil = [&](std::size_t camera, std::size_t look, Random& random, Contours& all) {
            for (const LightChange& change : changes) {
                if (change.camera != camera || look < change.first_look || look > change.last_look)
                    continue;
                if (!all[0].empty()) apply(change, random, all);
            }
        };
        CoherenceWatch watch(rig);
        std::size_t num_alarms = 0, num_blamed = 0, num_seen = 0;
        double largest_px = 0.0;
        while (num_seen < num_looks) {
            const WalkFilm film(3, num_people, num_seen);
            for (std::size_t i = 0; i < film.num_looks() && num_seen < num_looks; ++i) {
                const CoherenceWatch::Clock::time_point now{std::chrono::milliseconds(
                    static_cast<std::int64_t>(1000.0 * kLook_s * static_cast<double>(num_seen)))};
                const auto judgement = watch.look(film.sight(i, filming), now);
                ++num_seen;
                if (!judgement) continue;
                num_alarms += judgement->is_told ? 1 : 0;
                num_blamed += watch.judge().fault ? 1 : 0;
                largest_px = std::max(largest_px, judgement->report.rms_px);
            }
        }
        fmt::print("{},{:.0f},{},{},{},{:.2f}\n",
                   num_people,
                   minutes,
                   num_seen,
                   num_alarms,
                   num_blamed,
                   largest_px);
        std::fflush(stdout);
    }
}

struct Bump {
    const char* name;
    double turn_deg, move_m;
};

// How long somebody walks until the watch tells of a camera; nullopt: not within two minutes, or of
// another one.
std::optional<double> seconds_until_named(const Bump& bump, std::uint64_t seed) {
    Random random(seed);
    const auto rig = true_rig();
    const std::size_t camera = seed % rig.size();
    Filming filming{rig};
    CoherenceWatch watch(rig);
    constexpr std::size_t kBefore = 60;  // looks at a true rig
    for (std::size_t look = 0; look < kBefore + 240;) {
        const WalkFilm film(seed, 1, look);
        for (std::size_t i = 0; i < film.num_looks(); ++i, ++look) {
            if (look == kBefore)
                filming.truth[camera] = test::bumped(
                    rig[camera],
                    bump.turn_deg * std::numbers::pi / 180.0 * test::random_direction(random),
                    bump.move_m * test::random_direction(random));
            const CoherenceWatch::Clock::time_point now{std::chrono::milliseconds(
                static_cast<std::int64_t>(1000.0 * kLook_s * static_cast<double>(look)))};
            const auto judgement = watch.look(film.sight(i, filming), now);
            if (!judgement || !judgement->is_told) continue;
            const auto& report = judgement->report;
            if (look < kBefore || !report.fault || report.fault->camera != camera ||
                report.verdict != coherence::Verdict::kMoved)
                return std::nullopt;
            return kLook_s * static_cast<double>(look + 1 - kBefore);
        }
    }
    return std::nullopt;
}

void try_drift(int seeds) {
    fmt::print("fault,runs,named,median s,longest s\n");
    for (const Bump& bump : {Bump{"turned by 0.2 degrees", 0.2, 0.0},
                             Bump{"moved by 10 mm", 0.0, 0.010},
                             Bump{"turned by 1 degree and moved by 30 mm", 1.0, 0.030}}) {
        std::vector<double> seconds;
        for (int seed = 1; seed <= seeds; ++seed) {
            const auto named = seconds_until_named(bump, static_cast<std::uint64_t>(seed));
            if (named)
                seconds.push_back(*named);
            else
                fmt::print(stderr, "{}, seed {}: not named\n", bump.name, seed);
        }
        fmt::print("{},{},{},{:.1f},{:.1f}\n",
                   bump.name,
                   seeds,
                   seconds.size(),
                   median_of(seconds),
                   seconds.empty() ? 0.0 : *std::ranges::max_element(seconds));
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const double number = argc > 2 ? std::atof(argv[2]) : 0.0;
    if (argc >= 2 && std::strcmp(argv[1], "hour") == 0) {
        watch_an_hour(number > 0.0 ? number : 60.0);
    } else if (argc >= 2 && std::strcmp(argv[1], "drift") == 0) {
        try_drift(number > 0.0 ? static_cast<int>(number) : 20);
    } else {
        fmt::print(stderr,
                   "usage: coherence_trials drift [SEEDS] | coherence_trials hour [MINUTES]\n");
        return 2;
    }
    return 0;
}
