// A world of a thousand objects that all appear at once, move, disappear at once and come again. It
// writes to the bus as a world server would, to test whether viewers keep their rate.
#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/bus_options.hpp"
#include "core/bus/messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace {

using namespace atrium;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPeriod = std::chrono::nanoseconds(1s) / 30;

template <typename T>
T value(Expected<T> expected) {
    if (expected) return std::move(*expected);
    std::exit(app::fail(expected.error()));
}

struct Options {
    int num_things = 1000;
    double again_s = 3.0;
    bool absurd = false;
};

class Things {
public:
    Things(const bus::Participant& participant, const Options& options)
        : options_(options),
          objects_(value(bus::Writer<bus::SceneObject>::create(participant))),
          states_(value(bus::Writer<bus::SceneState>::create(participant))) {
        state_.world = "things";
        for (int i = 0; i < options.num_things; ++i) add(static_cast<std::uint32_t>(i));
    }

    void run(std::stop_token stop) {
        std::mutex mutex;
        std::condition_variable_any never;
        auto due = Clock::now();
        auto again = due;
        while (!stop.stop_requested()) {
            if (Clock::now() >= again) {
                again += std::chrono::duration_cast<Clock::duration>(
                    std::chrono::duration<double>(options_.again_s));
                come_and_go();
            }
            move();
            due += kPeriod;
            std::unique_lock lock(mutex);
            never.wait_until(lock, stop, due, [] { return false; });
        }
    }

private:
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }

    // on request, sizes and places anywhere within the limits of the bus
    void add(std::uint32_t id) {
        bus::SceneObject object;
        object.object = id + 1;
        object.name = fmt::format("thing{}", id);
        object.shape = static_cast<bus::Shape>(id % 4);  // the four shapes besides the plane
        const double size_m = options_.absurd ? std::pow(10.0, between(-12.0, 5.0)) : 0.15;
        object.size_m.setConstant(size_m);
        if (object.shape == bus::Shape::kCapsule) object.size_m.z() *= 0.5 + between(1.0, 2.0);
        object.size_m = object.size_m.cwiseMin(1e5);
        object.mass_kg = 1.0;
        object.colour = Eigen::Vector3d(between(0, 1), between(0, 1), between(0, 1));
        described_.push_back(object);
        state_.objects.emplace_back().object = object.object;
    }

    void come_and_go() {
        const bool come = !std::exchange(are_there_, !are_there_);
        for (const bus::SceneObject& object : described_) {
            if (come)
                note(objects_.write(object));
            else if (const auto gone = objects_.dispose(object); !gone)
                complaints_.warn(gone.error().message);
        }
    }

    void move() {
        ++state_.tick;
        state_.time = Timestamp::now();
        const double reach_m = options_.absurd ? 1e5 : 4.0;
        for (bus::ObjectState& state : state_.objects) {
            auto& pose = state.world_from_object;
            if (options_.absurd || state_.tick == 1) {
                pose.translation = Eigen::Vector3d(
                    between(-reach_m, reach_m), between(-reach_m, reach_m), between(0.0, reach_m));
            }
            pose.translation.z() += 0.005 * std::sin(0.1 * static_cast<double>(state_.tick));
            state.linear_velocity.setConstant(options_.absurd ? 1e5 : 0.0);
            state.angular_velocity.setConstant(options_.absurd ? 1e5 : 0.0);
        }
        note(states_.write(state_));
    }

    template <typename Written>
    void note(const Written& written) {
        if (!written) complaints_.warn(written.error().message);
    }

    Options options_;
    std::mt19937 random_{1};
    bus::Writer<bus::SceneObject> objects_;
    bus::Writer<bus::SceneState> states_;
    std::vector<bus::SceneObject> described_;
    bus::SceneState state_;
    bool are_there_ = false;
    app::log::OncePerSecond complaints_;
};

}  // namespace

int main(int argc, char** argv) {
    const app::StopOnSignal stop;
    bus::BusOptions bus_options;
    Options own;
    config::OptionSet options;
    bus::declare(bus_options, options);
    options.add("things", own.num_things, "so many", {1, 2048});
    options.add("again", own.again_s, "they come, or go, so often [s]", {0.1, 1000});
    options.add("absurd", own.absurd, "of any size, anywhere, somewhere else in each state");
    const app::Start start =
        app::start({.name = "viewer_things",
                    .summary = "Writes a world of a thousand things that come and go at once.",
                    .examples = "  viewer_things --things 1000\n  viewer_things --absurd true\n"},
                   options,
                   argc,
                   argv);
    if (!start.go_on) return start.exit_code;
    const auto participant = value(bus::Participant::create(bus_options));
    Things things(participant, own);
    things.run(stop.token());
    return 0;
}
