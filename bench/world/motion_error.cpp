// Error of the motion that physics estimates for a person's surface, with hulls from the cameras of
// a rig. Writes rows of comma-separated values, one per act, over all surfels within 15 cm of the
// held object or the hitting hand.
#include "bench/value_of.hpp"
#include "bench/world/trial_acts.hpp"
#include "bench/world/trial_options.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/config/rig.hpp"
#include "tests/support/shapes/decode_mesh.hpp"
#include "tests/support/world/acts.hpp"
#include "tests/support/world/hull_film.hpp"
#include "world_server/physics/people/person_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

constexpr double kNearM = 0.15;    // of the grip
constexpr double kMaxOffM = 0.04;  // a surfel farther from the true surface has no true motion
constexpr double kSettleS = 0.2;   // the first meshes have no predecessor

struct Errors {
    std::vector<double> all;  // [m/s]
    double along = 0.0;       // sum of estimated speed along the true motion
    double speed = 0.0;       // and sum of the true speed, where it is above 0.2 m/s
    std::vector<double> prepare_ms;

    void print(const std::string& name) {
        std::sort(all.begin(), all.end());
        std::sort(prepare_ms.begin(), prepare_ms.end());
        const auto at = [](const std::vector<double>& sorted, double share) {
            return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
        };
        const auto above = [&](double mps) {
            return 100.0 *
                   static_cast<double>(all.end() - std::lower_bound(all.begin(), all.end(), mps)) /
                   static_cast<double>(all.size());
        };
        fmt::print("{},{},{:.3f},{:.3f},{:.3f},{:.1f},{:.2f},{:.2f},{:.1f}\n",
                   name,
                   all.size(),
                   at(all, 0.5),
                   at(all, 0.9),
                   at(all, 0.99),
                   above(0.3),
                   above(1.0),
                   speed > 0.0 ? along / speed : 0.0,
                   at(prepare_ms, 0.5));
        std::fflush(stdout);
    }
    void add(const Errors& other) {
        all.insert(all.end(), other.all.begin(), other.all.end());
        prepare_ms.insert(prepare_ms.end(), other.prepare_ms.begin(), other.prepare_ms.end());
        along += other.along;
        speed += other.speed;
    }
};

Errors measure(const test::Act& act,
               const test::HullFilm& film,
               const physics::PersonShapeOptions& options,
               bool traces) {
    const test::ActedPerson person(act);
    physics::PersonShaper shaper(options);
    Errors errors;
    double before_s = 0.0;
    for (const auto& frame : film.frames) {
        if (frame.draco.empty()) continue;
        const auto mesh = value_of(test::decode_mesh(frame.draco));
        const auto start = std::chrono::steady_clock::now();
        const auto shape =
            shaper.shape(mesh, Timestamp{static_cast<std::int64_t>(1e9 * (1.0 + frame.capture_s))});
        errors.prepare_ms.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                .count());
        const double period_s = frame.capture_s - before_s;
        before_s = frame.capture_s;
        if (frame.capture_s < kSettleS || shape.period_s <= 0.0) continue;
        const auto now = person.mesh_site(frame.capture_s);
        const auto before = person.mesh_site(frame.capture_s - period_s);
        const Eigen::Vector3d grip = act.site_from_grip(frame.capture_s).translation;
        std::vector<std::size_t> near;
        for (std::size_t i = 0; i < now.vertices.size(); ++i)
            if ((now.vertices[i] - grip).norm() < kNearM + kMaxOffM) near.push_back(i);
        double sum = 0.0;
        double worst = 0.0;
        std::size_t num = 0;
        std::size_t num_wrong = 0;
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        Eigen::Vector3d true_mean = Eigen::Vector3d::Zero();
        for (const auto& surfel : *shape.surfels) {
            const Eigen::Vector3d place = surfel.position.cast<double>();
            if ((place - grip).norm() > kNearM) continue;
            double best = kMaxOffM;
            std::size_t vertex = now.vertices.size();
            for (const std::size_t i : near) {
                const double off = (now.vertices[i] - place).norm();
                if (off < best) {
                    best = off;
                    vertex = i;
                }
            }
            if (vertex == now.vertices.size()) continue;
            const Eigen::Vector3d truth =
                (now.vertices[vertex] - before.vertices[vertex]) / period_s;
            const Eigen::Vector3d found = surfel.velocity.cast<double>();
            const double error = (found - truth).norm();
            errors.all.push_back(error);
            sum += error;
            worst = std::max(worst, error);
            num_wrong += error > 0.3 ? 1 : 0;
            mean += found;
            true_mean += truth;
            ++num;
            if (truth.norm() > 0.2) {
                errors.along += found.dot(truth.normalized());
                errors.speed += truth.norm();
            }
        }
        if (traces && num > 0) {
            mean /= static_cast<double>(num);
            true_mean /= static_cast<double>(num);
            fmt::print(
                stderr,
                "{} {:.3f} n {} mean error {:.2f} worst {:.2f} wrong {}%  truth {:.2f} {:.2f} "
                "{:.2f} found {:.2f} {:.2f} {:.2f}\n",
                act.name,
                frame.capture_s,
                num,
                sum / static_cast<double>(num),
                worst,
                100 * num_wrong / num,
                true_mean.x(),
                true_mean.y(),
                true_mean.z(),
                mean.x(),
                mean.y(),
                mean.z());
        }
    }
    return errors;
}

// motion_error [--rig FILE] [--trials N] [--first SEED] [--trace] [name or beginning of names ...]
int run(int argc, char** argv) {
    TrialOptions options;
    options.num_trials = 4;
    const app::Start started =
        start({"motion_error",
               "Compares the velocities that the physics finds on people's surfaces, near what "
               "they hold, carry or hit with, "
               "with the true ones, with hulls from the cameras of a simulated room.",
               "  motion_error --trials 2 --only throw,clasp\n"},
              options,
              argc,
              argv);
    if (!started.go_on) return started.exit_code;
    test::FilmOptions filming;
    filming.cameras = value_of(config::load_rig(options.rig)).cameras;
    fmt::print("act,surfels,median_mps,p90_mps,p99_mps,over_0.3_percent,over_1_percent,along,ms\n");
    for (const auto& [name, make] : trial_acts()) {
        if (!options.wants(name)) continue;
        Errors together;
        for (std::uint64_t i = 0; i < options.num_trials; ++i) {
            const std::uint64_t seed = options.first + i;
            const test::Act act = make(seed);
            filming.seed = seed + 1;
            filming.first_s = 0.001 * static_cast<double>(seed * 7 % 33);
            const auto film =
                value_of(test::film(act, filming, ATRIUM_SOURCE_DIR "/.cache/world_trials"));
            together.add(measure(act, film, {}, options.traces));
        }
        together.print(name);
    }
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
