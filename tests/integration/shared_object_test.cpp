#include "tests/support/network/mesh_site.hpp"
#include "tests/support/world/physics_meshes.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/scene/scene_timeline.hpp"
#include "world_server/world_server.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>
#include <thread>

// Two sites push one box, in turn and at once, over the real bus and the real world server. Two
// viewers must show it at the same place for the same time stamp.
namespace atrium {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kHandM = 0.14;  // a fist
constexpr double kPushMps = 0.35;
constexpr double kBackMps = 1.5;  // of a hand that touches nothing
constexpr double kMaxStepS = 0.1;
constexpr double kBoxM = 0.3;
constexpr std::uint32_t kFloor = 1;
constexpr std::uint32_t kBox = 2;
constexpr std::int64_t kStampStepNs = 4'000'000;  // places are compared 250 times a second
constexpr double kSamePlaceM = 0.005;             // allowed difference between the two viewers
// each push takes some seconds, and more with sanitizers
const auto kPatience = std::chrono::seconds(60);
const Eigen::Vector3d kAliceAtRest{-0.8, 0.0, 0.15};  // world
const Eigen::Vector3d kBobAtRest{0.9, 0.0, 0.15};

bus::BusOptions bus_options() {
    bus::BusOptions options;
    options.world = "shared-object-test-" + std::to_string(getpid());
    options.domain = 178;  // used by this test only: ctest may run others at the same time
    return options;
}

geometry::RigidTransform world_from_alice() {
    return {Eigen::Quaterniond::Identity(), {-0.9, 0.0, 0.0}};
}

geometry::RigidTransform world_from_bob() {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ())),
            {0.9, 0.0, 0.0}};
}

world_server::WorldServerConfig world_config() {
    world_server::WorldServerConfig config;
    config.bus = bus_options();
    world_server::WorldObject floor;
    floor.rigid.id = kFloor;
    floor.name = "floor";
    floor.rigid.shape = physics::ObjectShape::kPlane;
    floor.rigid.size_m = {6, 6, 1};
    world_server::WorldObject box;
    box.rigid.id = kBox;
    box.name = "box";
    box.rigid.size_m.setConstant(kBoxM);
    box.rigid.mass_kg = 2.0;
    box.rigid.world_from_object.translation = {0.0, 0.0, 0.5 * kBoxM};
    config.objects = {floor, box};
    config.placements = {{"alice", world_from_alice()}, {"bob", world_from_bob()}};
    return config;
}

/// A hand that moves straight to its target. Thread-safe.
class Hand {
public:
    explicit Hand(const Eigen::Vector3d& at_world) : at_(at_world), goal_(at_world) {}

    void send_to(const Eigen::Vector3d& goal_world, double speed_mps) {
        const std::lock_guard lock(mutex_);
        goal_ = goal_world;
        speed_mps_ = speed_mps;
    }

    /// Place of the hand at that time. Times must increase.
    Eigen::Vector3d move_on(Timestamp time) {
        const std::lock_guard lock(mutex_);
        if (last_ != Timestamp{}) {
            // a machine that stands still must not move it through the box
            const double step_s = std::min(1e-3 * milliseconds(time - last_), kMaxStepS);
            const double way_m = speed_mps_ * step_s;
            const Eigen::Vector3d to_go = goal_ - at_;
            const double left_m = to_go.norm();
            at_ = left_m <= way_m ? goal_ : Eigen::Vector3d(at_ + way_m / left_m * to_go);
        }
        last_ = time;
        return at_;
    }

    bool has_arrived() const {
        const std::lock_guard lock(mutex_);
        return (goal_ - at_).norm() < 1e-6;
    }

private:
    mutable std::mutex mutex_;
    Eigen::Vector3d at_;
    Eigen::Vector3d goal_;
    double speed_mps_ = 0.0;
    Timestamp last_;
};

struct Drawn {
    Eigen::Vector3d place;
    bool is_between = false;  // between two states, not beyond the newest
};

/// The path of a viewer from the bus to the picture, as SceneView uses it: a session and a timeline
/// with their own participant. Draws `pictures_per_s` times a second.
class SceneViewer {
public:
    SceneViewer(const std::string& name, double pictures_per_s)
        : period_(static_cast<std::int64_t>(1e9 / pictures_per_s)) {
        auto session = viewer::Session::create(bus_options(), name);
        EXPECT_TRUE(session) << (session ? "" : session.error().message);
        if (!session) return;
        session_ = std::move(*session);
        receiver_ = std::jthread([this](std::stop_token stop) { session_->receive(stop); });
        drawer_ = std::jthread([this](std::stop_token stop) { draw(stop); });
    }

    /// Waits until the place of the box in the newest picture meets the condition. Returns false at
    /// the timeout.
    bool wait_until_shown(const std::function<bool(const Eigen::Vector3d&)>& holds) {
        std::unique_lock lock(mutex_);
        return drawn_one_.wait_for(lock, kPatience, [&] {
            return !drawn_.empty() && holds(drawn_.rbegin()->second.place);
        });
    }

    /// By time stamp, in steps of kStampStepNs of the world's clock.
    std::map<std::int64_t, Drawn> drawn() const {
        const std::lock_guard lock(mutex_);
        return drawn_;
    }

private:
    void draw(const std::stop_token& stop) {
        std::mutex mutex;
        std::condition_variable_any never;
        for (auto due = Clock::now(); !stop.stop_requested(); due += period_) {
            std::unique_lock lock(mutex);
            never.wait_until(lock, stop, due, [] { return false; });
            draw_one(Clock::now());
        }
    }

    // Records each time stamp since the previous picture, from the available states.
    void draw_one(Clock::time_point now) {
        for (auto& [state, arrival] : session_->take_scene().states) {
            newest_ns_ = std::max(newest_ns_, state.time.ns);
            if (oldest_ns_ == 0) oldest_ns_ = state.time.ns;
            timeline_.add(std::move(state), arrival);
        }
        const auto shown = timeline_.shown_time(now);
        if (!shown) return;
        const std::int64_t last_step = shown->ns / kStampStepNs;
        if (next_step_ == 0) next_step_ = last_step;
        const std::lock_guard lock(mutex_);
        for (; next_step_ <= last_step; ++next_step_) {
            const Timestamp stamp{next_step_ * kStampStepNs};
            timeline_.sample_at(stamp, objects_);
            for (const bus::ObjectState& object : objects_) {
                if (object.object != kBox) continue;
                drawn_[next_step_] = {object.world_from_object.translation,
                                      stamp.ns >= oldest_ns_ && stamp.ns <= newest_ns_};
            }
        }
        drawn_one_.notify_all();
    }

    std::chrono::nanoseconds period_;
    std::unique_ptr<viewer::Session> session_;
    viewer::SceneTimeline timeline_;  // of the drawing thread, like the next four
    std::vector<bus::ObjectState> objects_;
    std::int64_t newest_ns_ = 0;
    std::int64_t oldest_ns_ = 0;
    std::int64_t next_step_ = 0;
    mutable std::mutex mutex_;
    std::condition_variable drawn_one_;
    std::map<std::int64_t, Drawn> drawn_;
    std::jthread receiver_;
    std::jthread drawer_;  // destroyed first
};

class SharedObject : public testing::Test {
protected:
    void SetUp() override {
        auto world = world_server::WorldServer::create(world_config());
        ASSERT_TRUE(world) << world.error().message;
        world_ = std::move(*world);
        running_ = std::jthread([this](std::stop_token stop) { EXPECT_TRUE(world_->run(stop)); });
        alice_site_ = start_site("alice", world_from_alice(), alice_);
        bob_site_ = start_site("bob", world_from_bob(), bob_);
        ASSERT_TRUE(alice_site_ && bob_site_);
        left_ = std::make_unique<SceneViewer>("left", 60.0);
        right_ = std::make_unique<SceneViewer>("right", 24.0);  // a viewer on a slow machine
    }

    static std::unique_ptr<test::MeshSite> start_site(
        const std::string& name, const geometry::RigidTransform& world_from_site, Hand& hand) {
        auto site = test::MeshSite::start(
            bus_options(),
            {.name = name},
            [&hand, site_from_world = world_from_site.inverse()](Timestamp capture) {
                const geometry::RigidTransform world_from_hand{Eigen::Quaterniond::Identity(),
                                                               hand.move_on(capture)};
                return physics_test::make_box_mesh(
                    Eigen::Vector3d::Constant(kHandM), site_from_world * world_from_hand, 8);
            });
        EXPECT_TRUE(site) << (site ? "" : site.error().message);
        return site ? std::move(*site) : nullptr;
    }

    // Sends a hand to a place until the shown box meets the condition.
    void push(Hand& hand,
              const Eigen::Vector3d& towards,
              const std::function<bool(const Eigen::Vector3d&)>& is_there,
              const std::string& what) {
        hand.send_to(towards, kPushMps);
        ASSERT_TRUE(left_->wait_until_shown(is_there)) << what;
    }

    Eigen::Vector3d place_of_box() const { return left_->drawn().rbegin()->second.place; }

    void withdraw(Hand& hand, const Eigen::Vector3d& to) {
        hand.send_to(to, kBackMps);
        ASSERT_TRUE(left_->wait_until_shown([&](const auto&) { return hand.has_arrived(); }));
    }

    Hand alice_{kAliceAtRest};
    Hand bob_{kBobAtRest};
    std::unique_ptr<world_server::WorldServer> world_;
    std::jthread running_;
    std::unique_ptr<test::MeshSite> alice_site_;
    std::unique_ptr<test::MeshSite> bob_site_;
    std::unique_ptr<SceneViewer> left_;
    std::unique_ptr<SceneViewer> right_;
};

TEST_F(SharedObject, HasTheSamePlaceInBothViewersWhileTwoSitesPushIt) {
    if (HasFatalFailure()) return;
    const auto is_at_rest_in_the_middle = [](const Eigen::Vector3d& p) { return p.norm() < 0.2; };
    ASSERT_TRUE(left_->wait_until_shown(is_at_rest_in_the_middle));
    ASSERT_TRUE(right_->wait_until_shown(is_at_rest_in_the_middle));
    // each alone, while the other hand is far away
    push(
        alice_, {0.3, 0.0, 0.15}, [](const auto& p) { return p.x() > 0.2; }, "alice alone");
    withdraw(alice_, kAliceAtRest);
    push(
        bob_, {-0.3, 0.0, 0.15}, [](const auto& p) { return p.x() < 0.0; }, "bob alone");
    if (HasFatalFailure()) return;
    // both at once, from the same distance, across each other: alice causes motion along +x, bob
    // along -y
    withdraw(bob_, {0.9, 0.9, 0.15});
    const Eigen::Vector3d box = place_of_box();
    withdraw(bob_, box + Eigen::Vector3d(0.0, 0.5, 0.0));
    withdraw(alice_, box - Eigen::Vector3d(0.5, 0.0, 0.0));
    if (HasFatalFailure()) return;
    alice_.send_to(box + Eigen::Vector3d(0.8, 0.0, 0.0), kPushMps);
    push(
        bob_,
        box + Eigen::Vector3d(0.2, -0.8, 0.0),
        [&](const auto& p) { return p.x() > box.x() + 0.1 && p.y() < box.y() - 0.1; },
        "both at once");
    if (HasFatalFailure()) return;
    const std::int64_t end = left_->drawn().rbegin()->first;
    ASSERT_TRUE(right_->wait_until_shown([&](const auto&) { return true; }));

    const std::map<std::int64_t, Drawn> left = left_->drawn();
    const std::map<std::int64_t, Drawn> right = right_->drawn();
    std::size_t num_compared = 0;
    std::size_t num_moving = 0;
    double furthest_m = 0.0;
    std::optional<Eigen::Vector3d> before;
    for (const auto& [step, place] : left) {
        const auto other = right.find(step);
        if (step > end || other == right.end()) continue;
        // beyond the newest state each viewer extrapolates: that is not yet a place of the world
        if (!place.is_between || !other->second.is_between) continue;
        const double apart_m = (place.place - other->second.place).norm();
        ASSERT_LE(apart_m, kSamePlaceM) << "at " << step * kStampStepNs << " ns";
        furthest_m = std::max(furthest_m, apart_m);
        ++num_compared;
        const double step_s = 1e-9 * static_cast<double>(kStampStepNs);
        if (before && (place.place - *before).norm() > 0.1 * step_s) ++num_moving;
        before = place.place;
    }
    RecordProperty("num_compared", static_cast<int>(num_compared));
    RecordProperty("num_moving", static_cast<int>(num_moving));
    RecordProperty("furthest_um", static_cast<int>(1e6 * furthest_m));
    // the pushes alone take more than two seconds of motion: 500 time stamps
    EXPECT_GT(num_compared, 500U);
    EXPECT_GT(num_moving, 250U);
    for (const auto* site : {alice_site_.get(), bob_site_.get()}) EXPECT_EQ(site->num_failed(), 0U);
    EXPECT_EQ(world_->status().num_rejected, 0U);
}

}  // namespace
}  // namespace atrium
