// Error of the motion that SurfaceMotion finds in the pictures of a site's cameras, beside that of
// the motion that physics estimates from the same hulls. Writes comma-separated values, a row per
// act and class of true speed, over the surfels that the physics makes of the hulls. For a hand
// that rolls by 90 degrees, a line per trial with the angle that each of them finds.
#include "bench/thread_time.hpp"
#include "bench/value_of.hpp"
#include "bench/world/trial_acts.hpp"
#include "bench/world/trial_options.hpp"
#include "core/base/executor.hpp"
#include "core/config/rig.hpp"
#include "site_node/flow/dense_flow.hpp"
#include "site_node/motion/surface_motion.hpp"
#include "tests/support/pictures/filmed_act.hpp"
#include "world_server/physics/people/person_shape.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

constexpr double kRateHz = 30.0;
constexpr int kPairsPerAct = 8;    // of successive instants
constexpr double kMaxOffM = 0.04;  // a surfel farther from the true surface has no true motion
constexpr float kConfident = 0.5F;
constexpr double kCloth = 4.0;
constexpr std::array<double, 5> kFrom{0.0, 0.3, 1.0, 2.0, 3.0};  // [m/s] classes of true speed

struct Errors {
    std::vector<double> along;       // [m/s] along the surface
    std::vector<double> of_allowed;  // that, of the larger of 0.15 m/s and 10 % of the speed
    std::vector<double> whole;       // [m/s]

    void add(const Eigen::Vector3d& off, const Eigen::Vector3d& normal, double speed_mps) {
        const double along_mps = (off - normal.dot(off) * normal).norm();
        along.push_back(along_mps);
        of_allowed.push_back(along_mps / std::max(0.15, 0.1 * speed_mps));
        whole.push_back(off.norm());
    }
    void add(const Errors& other) {
        along.insert(along.end(), other.along.begin(), other.along.end());
        of_allowed.insert(of_allowed.end(), other.of_allowed.begin(), other.of_allowed.end());
        whole.insert(whole.end(), other.whole.begin(), other.whole.end());
    }
};

struct Class {
    Errors pictures;  // of all places
    Errors sure;      // of those with enough confidence
    Errors physics;
};

struct Result {
    std::array<Class, kFrom.size()> classes;
    std::vector<double> pictures_ms;  // processor time of one metaframe
    std::vector<double> physics_ms;
    std::vector<double> cells;
    std::vector<double> sights;

    void add(const Result& other) {
        for (std::size_t i = 0; i < classes.size(); ++i) {
            classes[i].pictures.add(other.classes[i].pictures);
            classes[i].sure.add(other.classes[i].sure);
            classes[i].physics.add(other.classes[i].physics);
        }
        const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        append(pictures_ms, other.pictures_ms);
        append(physics_ms, other.physics_ms);
        append(cells, other.cells);
        append(sights, other.sights);
    }
};

std::vector<Eigen::Vector3d> normals_of(const geometry::TriangleMesh& mesh) {
    std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3d normal =
            (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
        for (const std::uint32_t vertex : {a, b, c}) normals[vertex] += normal;
    }
    for (Eigen::Vector3d& normal : normals) normal.normalize();
    return normals;
}

// Compares the motion of all surfels with that of the true vertices beside them.
void judge(const test::FilmedInstant& now,
           const std::vector<Eigen::Vector3d>& before,
           const geometry::MotionField& found,
           const physics::PersonShape& shape,
           Result& result) {
    const auto normals = normals_of(now.truth);
    std::vector<std::size_t> by_height(now.truth.vertices.size());
    for (std::size_t i = 0; i < by_height.size(); ++i) by_height[i] = i;
    const auto height = [&](std::size_t i) { return now.truth.vertices[i].z(); };
    std::ranges::sort(by_height, {}, height);
    for (std::size_t s = 0; s < shape.surfels->size(); s += 2) {
        const physics::MovingSurfel& surfel = (*shape.surfels)[s];
        const Eigen::Vector3d place = surfel.position.cast<double>();
        double best_sq = kMaxOffM * kMaxOffM;
        std::size_t vertex = now.truth.vertices.size();
        for (auto i = std::ranges::lower_bound(by_height, place.z() - kMaxOffM, {}, height);
             i != by_height.end() && height(*i) < place.z() + kMaxOffM;
             ++i) {
            const double off_sq = (now.truth.vertices[*i] - place).squaredNorm();
            if (off_sq >= best_sq || normals[*i].dot(surfel.normal.cast<double>()) < 0.0) continue;
            best_sq = off_sq;
            vertex = *i;
        }
        if (vertex == now.truth.vertices.size()) continue;
        const Eigen::Vector3d truth = kRateHz * (now.truth.vertices[vertex] - before[vertex]);
        const auto above = std::ranges::upper_bound(kFrom, truth.norm());
        Class& own = result.classes[static_cast<std::size_t>(above - kFrom.begin()) - 1];
        const geometry::FoundMotion motion = found.at(surfel.position);
        const Eigen::Vector3d off = motion.velocity.cast<double>() - truth;
        own.pictures.add(off, normals[vertex], truth.norm());
        if (motion.confidence >= kConfident) own.sure.add(off, normals[vertex], truth.norm());
        own.physics.add(surfel.velocity.cast<double>() - truth, normals[vertex], truth.norm());
    }
}

void measure(const test::Act& act,
             const std::vector<geometry::CalibratedCamera>& cameras,
             std::uint64_t seed,
             Result& result) {
    test::ActFilmer filmer(act, cameras, kCloth, seed);
    motion::SurfaceMotion surface_motion(cameras);
    SerialExecutor executor;
    for (int pair = 0; pair < kPairsPerAct; ++pair) {
        // the first third is often still
        const double time_s = act.seconds * (0.3 + 0.65 * pair / kPairsPerAct);
        const std::array<double, 2> times_s{time_s - 1.0 / kRateHz, time_s};
        std::array<test::FilmedInstant, 2> instants{filmer.take(times_s[0]),
                                                    filmer.take(times_s[1])};
        geometry::MotionField found;
        physics::PersonShape shape;
        double pictures_ms = 0.0;
        double physics_ms = 0.0;
        // twice: the memory of a stream is warm
        for (int run = 0; run < 2; ++run) {
            physics::PersonShaper shaper(physics::PersonShapeOptions{});
            surface_motion.forget();
            for (std::size_t i = 0; i < instants.size(); ++i) {
                auto pictures = instants[i].pictures;
                const Timestamp capture{static_cast<std::int64_t>(1e9 * (1.0 + times_s[i]))};
                const double begin = thread_ms();
                surface_motion.estimate(instants[i].hull, pictures, capture, executor, found);
                const double middle = thread_ms();
                shape = shaper.shape(instants[i].hull, capture);
                pictures_ms = middle - begin;
                physics_ms = thread_ms() - middle;
            }
        }
        if (found.empty()) continue;
        result.pictures_ms.push_back(pictures_ms);
        result.physics_ms.push_back(physics_ms);
        result.cells.push_back(static_cast<double>(found.cells().size()));
        result.sights.push_back(static_cast<double>(surface_motion.num_sights()));
        judge(instants[1], filmer.truth_at(times_s[0]), found, shape, result);
    }
}

constexpr double kHandM = 0.1;  // around the middle of the palm

// The rotation about an axis through the middle of the palm that fits velocities best.
class RotationFit {
public:
    RotationFit(const Eigen::Vector3d& middle, const Eigen::Vector3d& axis)
        : middle_(middle), axis_(axis) {}

    void add(const Eigen::Vector3d& place, const Eigen::Vector3d& velocity) {
        const Eigen::Vector3d arm = place - middle_;
        if (arm.norm() > kHandM) return;
        const Eigen::Vector3d lever = axis_.cross(arm);
        moment_ += lever.dot(velocity);
        levers_sq_ += lever.squaredNorm();
    }
    // Of one picture [degrees].
    double degrees() const {
        return 180.0 / std::numbers::pi / kRateHz * moment_ / std::max(levers_sq_, 1e-9);
    }

private:
    Eigen::Vector3d middle_, axis_;
    double moment_ = 0.0;
    double levers_sq_ = 0.0;
};

// Adds up the roll of a hand through the first half of its act, which turns the palm by 90 degrees.
void measure_roll(const test::Act& act,
                  const std::vector<geometry::CalibratedCamera>& cameras,
                  std::uint64_t seed) {
    test::ActFilmer filmer(act, cameras, kCloth, seed);
    motion::SurfaceMotion surface_motion(cameras);
    physics::PersonShaper shaper(physics::PersonShapeOptions{});
    SerialExecutor executor;
    geometry::MotionField found;
    std::array<double, 3> degrees{};  // of the skin, by pictures, by physics
    for (double time_s = 0.15; time_s < 0.85; time_s += 1.0 / kRateHz) {
        test::FilmedInstant instant = filmer.take(time_s);
        const Timestamp capture{static_cast<std::int64_t>(1e9 * (1.0 + time_s))};
        surface_motion.estimate(instant.hull, instant.pictures, capture, executor, found);
        const physics::PersonShape shape = shaper.shape(instant.hull, capture);
        const geometry::RigidTransform palm = act.site_from_grip(time_s);
        const RotationFit fresh(palm.translation, -(palm.rotation * Eigen::Vector3d::UnitY()));
        std::array<RotationFit, 3> fits{fresh, fresh, fresh};
        const auto before = filmer.truth_at(time_s - 1.0 / kRateHz);
        for (std::size_t i = 0; i < before.size(); ++i) {
            const Eigen::Vector3d& now = instant.truth.vertices[i];
            fits[0].add(now, kRateHz * (now - before[i]));
        }
        for (const physics::MovingSurfel& surfel : *shape.surfels) {
            const Eigen::Vector3d place = surfel.position.cast<double>();
            fits[1].add(place, found.at(surfel.position).velocity.cast<double>());
            fits[2].add(place, surfel.velocity.cast<double>());
        }
        for (std::size_t i = 0; i < fits.size(); ++i) degrees[i] += fits[i].degrees();
    }
    fmt::print(
        "# roll {}: the skin around the palm by {:.0f} degrees, by pictures {:.0f}, by physics "
        "{:.0f}\n",
        seed,
        degrees[0],
        degrees[1],
        degrees[2]);
    std::fflush(stdout);
}

void print(const std::string& name, const Result& result) {
    for (std::size_t i = 0; i < kFrom.size(); ++i) {
        const Class& own = result.classes[i];
        if (own.pictures.along.empty()) continue;
        fmt::print(
            "{},{:g},{},{:.3f},{:.3f},{:.2f},{:.3f},{:.0f},{:.3f},{:.2f},{:.3f},{:.3f},{:.2f}\n",
            name,
            kFrom[i],
            own.pictures.along.size(),
            quantile(own.pictures.along, 0.5),
            quantile(own.pictures.along, 0.9),
            quantile(own.pictures.of_allowed, 0.5),
            quantile(own.pictures.whole, 0.5),
            100.0 * static_cast<double>(own.sure.along.size()) /
                static_cast<double>(own.pictures.along.size()),
            quantile(own.sure.along, 0.9),
            quantile(own.sure.of_allowed, 0.5),
            quantile(own.physics.along, 0.5),
            quantile(own.physics.along, 0.9),
            quantile(own.physics.of_allowed, 0.5));
    }
    fmt::print("# {}: {:.0f} cells, {:.0f} sights, {:.2f} ms of one core, physics {:.2f} ms\n",
               name,
               quantile(result.cells, 0.5),
               quantile(result.sights, 0.5),
               quantile(result.pictures_ms, 0.5),
               quantile(result.physics_ms, 0.5));
    std::fflush(stdout);
}

// flow_error [--rig FILE] [--trials N] [--first SEED] [--only ACTS]
int run(int argc, char** argv) {
    TrialOptions options;
    options.num_trials = 2;
    const app::Start started =
        start({"flow_error",
               "Compares the velocities that the pictures of a simulated room's cameras show on "
               "people's surfaces, and those that the physics estimates from hulls, with the true "
               "ones.",
               "  flow_error --trials 2 --only throw,kick\n"},
              options,
              argc,
              argv);
    if (!started.go_on) return started.exit_code;
    flow::keep_to_calling_threads();
    const auto cameras = value_of(config::load_rig(options.rig)).cameras;
    fmt::print(
        "act,from_mps,surfels,median_mps,p90_mps,of_allowed,whole_mps,sure_percent,"
        "sure_p90_mps,sure_of_allowed,physics_mps,physics_p90_mps,physics_of_allowed\n");
    Result together;
    for (const auto& [name, make] : trial_acts()) {
        if (!options.wants(name)) continue;
        Result result;
        for (std::uint64_t i = 0; i < options.num_trials; ++i) {
            const test::Act act = make(options.first + i);
            measure(act, cameras, options.first + i, result);
            if (name == "roll") measure_roll(act, cameras, options.first + i);
        }
        print(name, result);
        together.add(result);
    }
    print("all", together);
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
