#include "world_server/publisher.hpp"

#include "core/bus/bus.hpp"
#include "tests/support/comes_true.hpp"
#include "world_server/endpoints.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <map>
#include <set>

namespace atrium::world_server {
namespace {

using test_support::comes_true;

constexpr std::uint32_t kReused = 5;

SceneChange soft_thing() {
    SceneChange change;
    change.object.object = kReused;
    change.object.name = "cloth";
    change.object.shape = bus::Shape::kSoft;
    change.object.mass_kg = 1.0;
    bus::SoftBody& body = change.soft.emplace();
    body.object = kReused;
    body.num_nodes = 3;
    body.triangles = {{0, 1, 2}};
    body.thickness_m = 0.01;
    return change;
}

SceneChange model_thing() {
    SceneChange change;
    change.object.object = kReused;
    change.object.name = "rock";
    change.object.shape = bus::Shape::kConvex;
    change.object.model = "rock.obj";
    change.object.mass_kg = 1.0;
    bus::ObjectProxy& proxy = change.proxy.emplace();
    proxy.object = kReused;
    proxy.vertices = {{0, 0, 0}, {9, 0, 0}};
    proxy.edges = {{0, 1}};
    return change;
}

SceneChange box_thing() {
    SceneChange change;
    change.object.object = kReused;
    change.object.name = "box";
    change.object.mass_kg = 1.0;
    return change;
}

class PublisherOnTheBus : public testing::Test {
protected:
    PublisherOnTheBus() {
        bus::BusOptions options;
        options.world = "publisher-test-" + std::to_string(getpid());
        options.domain = 77;
        endpoints_.emplace(Endpoints::create(options).value());
        publisher_.emplace(*endpoints_);
        const bus::Participant viewer = bus::Participant::create(options).value();
        objects_.emplace(bus::Reader<bus::SceneObject>::create(viewer).value());
        bodies_.emplace(bus::Reader<bus::SoftBody>::create(viewer).value());
        states_.emplace(bus::Reader<bus::SoftBodyState>::create(viewer).value());
        proxies_.emplace(bus::Reader<bus::ObjectProxy>::create(viewer).value());
    }

    void send(const SceneChange& change) {
        Outbox::Content content;
        content.changes.push_back(change);
        publisher_->send(content);
    }

    // What a viewer has after the last change: the name of the object, and its other topics.
    bool until(const std::string& name, bool has_body, bool has_proxy) {
        return comes_true([&] {
            objects_->take([&](bus::SceneObject&& came) { name_ = came.name; },
                           [&](const bus::SceneObject&) { name_.clear(); });
            bodies_->take([&](bus::SoftBody&&) { has_body_ = true; },
                          [&](const bus::SoftBody&) { has_body_ = false; });
            proxies_->take([&](bus::ObjectProxy&&) { has_proxy_ = true; },
                           [&](const bus::ObjectProxy&) { has_proxy_ = false; });
            return name_ == name && has_body_ == has_body && has_proxy_ == has_proxy;
        });
    }

    std::optional<Endpoints> endpoints_;
    std::optional<Publisher> publisher_;
    std::optional<bus::Reader<bus::SceneObject>> objects_;
    std::optional<bus::Reader<bus::SoftBody>> bodies_;
    std::optional<bus::Reader<bus::SoftBodyState>> states_;
    std::optional<bus::Reader<bus::ObjectProxy>> proxies_;
    std::string name_;
    bool has_body_ = false;
    bool has_proxy_ = false;
};

TEST_F(PublisherOnTheBus, EndsTheSoftBodyAndTheProxyOfAReusedNumber) {
    send(soft_thing());
    ASSERT_TRUE(until("cloth", true, false));
    send(model_thing());
    EXPECT_TRUE(until("rock", false, true));
    send(box_thing());
    EXPECT_TRUE(until("box", false, false));
    send(soft_thing());
    EXPECT_TRUE(until("cloth", true, false));
    SceneChange gone = soft_thing();
    gone.is_gone = true;
    send(gone);
    EXPECT_TRUE(until("", false, false));
}

TEST_F(PublisherOnTheBus, SendsNoStateOfASoftObjectThatIsGone) {
    Outbox::Content content;
    content.changes.push_back(soft_thing());
    bus::SoftBodyState& state = content.state.soft.emplace_back();
    state.object = kReused;
    state.tick = 1;
    state.nodes = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}};
    content.state.rigid.world = "lab";
    content.has_state = true;
    publisher_->send(content);
    std::uint64_t tick = 0;
    const auto take = [&] {
        states_->take([&](bus::SoftBodyState&& came) { tick = came.tick; });
        return tick;
    };
    ASSERT_TRUE(comes_true([&] { return take() == 1; }));
    content.changes = {box_thing()};
    content.state.soft[0].tick = 2;  // of the step before the change
    publisher_->send(content);
    content.changes = {soft_thing()};
    content.state.soft[0].tick = 3;
    publisher_->send(content);
    ASSERT_TRUE(comes_true([&] {
        states_->take([&](bus::SoftBodyState&& came) {
            EXPECT_NE(came.tick, 2U);
            tick = came.tick;
        });
        return tick == 3;
    }));
}

}  // namespace
}  // namespace atrium::world_server
