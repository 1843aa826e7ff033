// The proxies that the whole server publishes, over the real bus on the loopback interface.
#include "core/bus/bus.hpp"
#include "core/bus/proxy_points.hpp"
#include "core/codec/mesh_codec.hpp"
#include "simulation_stage.hpp"
#include "tests/support/world/physics_meshes.hpp"
#include "world_server/world_server.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <thread>

namespace atrium::world_server {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr double kSpeedMps = 0.5;
constexpr auto kMeshPeriod = 33ms;
constexpr double kTurnS = 2.0;  // the person moves this long in one direction, then back

double seconds_since(Timestamp start, Timestamp time) {
    return std::chrono::duration<double>(time - start).count();
}

class ProxiesOnTheBus : public testing::Test {
protected:
    void SetUp() override {
        config_ = floor_and_ball();
        // out of the person's way
        config_.objects[1].rigid.world_from_object.translation = {3, 3, 0.1};
        config_.bus.world = "proxies-test-" + std::to_string(getpid());
        config_.bus.domain = 77;
        config_.placements = {{"alice", {Eigen::Quaterniond::Identity(), {-1, 0, 0}}}};
        auto server = WorldServer::create(config_);
        ASSERT_TRUE(server) << server.error().message;
        server_ = std::move(*server);
        running_ = std::jthread(
            [this](std::stop_token stop) { EXPECT_TRUE(server_->run(std::move(stop))); });
        participant_.emplace(bus::Participant::create(config_.bus).value());
        meshes_.emplace(bus::Writer<bus::SiteMesh>::create(*participant_).value());
    }

    // Position of the person's middle in the site at that time.
    double x_at(Timestamp time) const {
        const double turns = seconds_since(start_, time) / kTurnS;
        const double share = turns - 2.0 * std::floor(0.5 * turns);  // in [0, 2)
        return kSpeedMps * kTurnS * (share < 1.0 ? share : 2.0 - share);
    }
    // Time to the nearest turn, before or after.
    double s_to_turn(Timestamp time) const {
        const double within = std::fmod(seconds_since(start_, time), kTurnS);
        return std::min(within, kTurnS - within);
    }
    double velocity_x_at(Timestamp time) const {
        return std::fmod(seconds_since(start_, time), 2.0 * kTurnS) < kTurnS ? kSpeedMps
                                                                             : -kSpeedMps;
    }
    // True if meshes or ticks were late, or meshes were dropped, since one of the last calls. Then
    // the person may have stood still.
    bool was_late() {
        constexpr int kCalls = 3;
        const bus::WorldStatus status = server_->status();
        const std::uint64_t num_lost = status.num_skipped_ticks + status.num_meshes_dropped;
        if (longest_gap_ > kMeshPeriod * 5 / 4 || num_lost > num_lost_)
            num_late_calls_ = kCalls;
        else if (num_late_calls_ > 0)
            --num_late_calls_;
        num_lost_ = num_lost;
        longest_gap_ = {};
        return num_late_calls_ > 0;
    }
    void send_mesh() {
        const Clock::time_point now = Clock::now();
        if (sent_) longest_gap_ = std::max(longest_gap_, now - *sent_);
        sent_ = now;
        mesh_.site = "alice";
        // exactly a period apart: a busy machine must not change the velocities
        mesh_.capture_time =
            start_ + std::chrono::nanoseconds(kMeshPeriod) * static_cast<int>(++mesh_.frame_id);
        const auto shape = physics_test::make_person_mesh({x_at(mesh_.capture_time), 0, 0}, 0.3, 8);
        ASSERT_TRUE(codec::MeshEncoder().encode(shape, {}, mesh_.draco));
        ASSERT_TRUE(meshes_->write(mesh_));
    }
    // Returns true once `holds()`. The person moves meanwhile, with 30 meshes a second at most.
    bool move_until(const std::function<bool()>& holds) {
        const Clock::time_point end = Clock::now() + 60s;
        while (Clock::now() < end) {
            send_mesh();
            if (holds()) return true;
            std::this_thread::sleep_for(kMeshPeriod);
        }
        return false;
    }
    // Bytes published per tick, over one second.
    double bytes_per_tick() {
        const bus::WorldStatus before = server_->status();
        EXPECT_TRUE(
            move_until([&] { return server_->status().num_steps > before.num_steps + 120; }));
        const bus::WorldStatus after = server_->status();
        return static_cast<double>(after.num_bytes_published - before.num_bytes_published) /
               static_cast<double>(after.num_steps - before.num_steps);
    }

    WorldServerConfig config_;
    std::unique_ptr<WorldServer> server_;
    std::jthread running_;
    std::optional<bus::Participant> participant_;
    std::optional<bus::Writer<bus::SiteMesh>> meshes_;
    bus::SiteMesh mesh_;
    const Timestamp start_ = Timestamp::now();
    std::optional<Clock::time_point> sent_;  // time of the last mesh
    Clock::duration longest_gap_{};
    std::uint64_t num_lost_ = 0;  // ticks and meshes
    int num_late_calls_ = 0;
};

TEST_F(ProxiesOnTheBus, GivePlaceAndVelocityOfAPersonToReadersOnly) {
    ASSERT_TRUE(move_until([&] { return server_->status().num_sites == 1; }));
    const double bytes_without = bytes_per_tick();
    double bytes_with = 0.0;
    {
        auto reader = bus::Reader<bus::PersonProxy>::create(*participant_).value();
        int num_told = 0;
        int num_compared = 0;
        Timestamp last;
        const auto look = [&](bus::PersonProxy&& proxy) {
            ++num_told;
            EXPECT_EQ(proxy.site, "alice");
            EXPECT_GE(proxy.capture_time, last) << "an older proxy followed a newer one";
            last = proxy.capture_time;
            ASSERT_GT(proxy.points.size(), 500U);
            ASSERT_GE(proxy.num_surfels, proxy.points.size());
            if (s_to_turn(proxy.capture_time) < 0.25) return;
            Eigen::AlignedBox3d box;
            std::vector<double> along;
            std::vector<double> across;
            for (std::size_t i = 0; i < proxy.points.size(); ++i) {
                box.extend(bus::place_of(proxy, i));
                const Eigen::Vector3d velocity = bus::velocity_of(proxy.points[i]);
                along.push_back(velocity.x());
                across.push_back(velocity.tail<2>().norm());
                EXPECT_NEAR(bus::normal_of(proxy.points[i]).norm(), 1.0, 1e-3);
            }
            const auto middle_of = [](std::vector<double>& values) {
                const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
                std::nth_element(values.begin(), middle, values.end());
                return *middle;
            };
            const double velocity_x = middle_of(along);
            if (was_late() && velocity_x == 0.0) return;
            ++num_compared;
            EXPECT_NEAR(velocity_x, velocity_x_at(proxy.capture_time), 0.1);
            EXPECT_LT(middle_of(across), 0.1);
            // in the world the site stands a metre to the left; the proxy is behind by a mesh
            // period at most
            geometry::Aabb truth;
            const double x_m = x_at(proxy.capture_time) - 1.0;
            for (const Eigen::Vector3d& v :
                 physics_test::make_person_mesh({x_m, 0, 0}, 0.3, 8).vertices)
                truth.add(v);
            const double behind_m = kSpeedMps * physics::PersonShapeOptions{}.max_period_s;
            const Eigen::Vector3d allowed_m(0.03 + behind_m, 0.03, 0.03);  // surfels: 2 cm apart
            EXPECT_TRUE(((box.min() - truth.min).array().abs() < allowed_m.array()).all());
            EXPECT_TRUE(((box.max() - truth.max).array().abs() < allowed_m.array()).all());
        };
        const auto take = [&] {
            EXPECT_EQ(reader.take(look).num_rejected, 0U);
            return num_compared >= 10;
        };
        const Clock::time_point begin = Clock::now();
        ASSERT_TRUE(move_until(take));
        const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
        EXPECT_LE(num_told, 10.0 * took_s + 2.0);
        bytes_with = bytes_per_tick();

        // readers learn that a person has left
        bool is_gone = false;
        reader.take({});
        meshes_->dispose(mesh_);
        const Clock::time_point end = Clock::now() + 20s;
        while (!is_gone && Clock::now() < end) {
            reader.take({}, [&](const bus::PersonProxy& gone) { is_gone = gone.site == "alice"; });
            std::this_thread::sleep_for(10ms);
        }
        EXPECT_TRUE(is_gone);
    }
    // about 1500 points of 18 bytes, 10 times a second, over 120 ticks
    EXPECT_GT(bytes_with, bytes_without + 1000.0);
    const double bytes_after = bytes_per_tick();
    EXPECT_LT(bytes_after, bytes_without + 100.0) << "proxies are still sent without a reader";
    RecordProperty("bytes_per_s", static_cast<int>(120.0 * (bytes_with - bytes_without)));
}

}  // namespace
}  // namespace atrium::world_server
