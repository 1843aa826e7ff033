#include "core/bus/wire.hpp"

#include "core/bus/checks.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "core/bus/soft_nodes.hpp"
#include "core/bus/topics.hpp"
#include "tests/unit/bus/all_messages.hpp"
#include "tests/unit/bus/random_messages.hpp"
#include "tests/unit/bus/wire_damage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace atrium::bus {
namespace {

using testing::expect_each_refused;
using ::testing::HasSubstr;
using testing::kInfinity;
using testing::kNan;
using testing::Random;
using testing::random_message;
using testing::spoil_text;
using ::testing::StartsWith;

template <typename Message>
class EveryMessage : public ::testing::Test {};
TYPED_TEST_SUITE(EveryMessage, testing::AllMessages);

TYPED_TEST(EveryMessage, SurvivesTheWireUnchanged) {
    Random random(7);
    WireScratch scratch;
    for (int round = 0; round < 200; ++round) {
        const auto message = random_message<TypeParam>(random);
        ASSERT_TRUE(check(message).has_value()) << check(message).error().message;
        WireOf<TypeParam> wire{};
        to_wire(message, scratch, wire);
        const auto back = from_wire<TypeParam>(wire);
        ASSERT_TRUE(back.has_value()) << back.error().message;
        EXPECT_TRUE(testing::same(message, *back)) << "round " << round;
    }
}

TYPED_TEST(EveryMessage, KeepsItsKeyWithoutData) {
    Random random(8);
    const auto message = random_message<TypeParam>(random);
    WireOf<TypeParam> key{};
    WireOf<TypeParam> again{};
    key_to_wire(message, key);
    const auto back = key_from_wire<TypeParam>(key);
    ASSERT_TRUE(back.has_value());
    key_to_wire(*back, again);
    EXPECT_EQ(std::memcmp(&key, &again, sizeof(key)), 0);
}

/// Damages each field of good messages in each way, one at a time.
TYPED_TEST(EveryMessage, IsRefusedWithAnyFieldOutsideItsLimits) {
    Random random(9);
    WireScratch scratch;
    for (int round = 0; round < 10; ++round) {
        const auto good = random_message<TypeParam>(random);
        for (int which = 0;; ++which) {
            auto lent = good;  // damages may write through the lent sequences
            WireOf<TypeParam> wire{};
            to_wire(lent, scratch, wire);
            testing::WireDamage damage(which);
            fields(damage, good, wire);
            if (damage.name.empty()) break;
            const auto result = from_wire<TypeParam>(wire);
            ASSERT_FALSE(result.has_value()) << damage.name << ", damage " << which;
            EXPECT_EQ(result.error().kind, ErrorKind::kInvalidData);
            EXPECT_THAT(result.error().message, StartsWith(damage.name + ": "));
        }
    }
}

/// The writer's half of the checks, for messages that no wire struct can hold.
TEST(Check, RefusesTooManyElements) {
    SiteMesh mesh{"room", 1, {5}, {}, std::vector<std::uint8_t>(kMaxCodedBytes + 1)};
    EXPECT_THAT(check(mesh).error().message,
                StartsWith("SiteMesh.draco bytes: at most 8388608, got 8388609"));
    mesh.draco.pop_back();
    EXPECT_TRUE(check(mesh));
    EXPECT_THAT(check(SceneState{"hall", 1, {5}, std::vector<ObjectState>(2049)}).error().message,
                StartsWith("SceneState.objects: at most 2048, got 2049"));
}

/// Neighbours in memory without a gap or an overlap.
void expect_no_gaps(testing::Layout::Struct layout) {
    std::ranges::sort(layout.pieces, {}, &testing::Layout::Piece::begin);
    const auto rounded_up = [](std::uintptr_t at, std::size_t to) {
        return (at + to - 1) / to * to;
    };
    std::uintptr_t end = layout.whole.begin;
    for (const auto& piece : layout.pieces) {
        EXPECT_EQ(piece.begin - end, rounded_up(end, piece.alignment) - end)
            << "before " << piece.name << " of " << layout.pieces.front().name;
        end = piece.begin + piece.size;
    }
    EXPECT_EQ(layout.whole.begin + layout.whole.size, rounded_up(end, layout.whole.alignment));
}

TYPED_TEST(EveryMessage, ListsEachMemberOnce) {
    const TypeParam message;
    testing::Layout layout;
    layout.visit(message, kNoWire<WireOf<TypeParam>>);
    for (const auto& each : layout.structs) expect_no_gaps(each);
}

// The limits themselves, where they protect more than a figure.

SiteDescription good_description() {
    SiteDescription message;
    message.site = "room-1";
    message.cameras.resize(2);
    for (auto& camera : message.cameras) {
        camera.name = "c";
        camera.intrinsics = {640, 480, 500, 500, 320, 240, 0, {}};
    }
    message.bounds_site.add({-1, -1, 0});
    message.bounds_site.add({1, 1, 2});
    return message;
}

TEST(FromWire, RefusesEachBadFieldOfASiteDescription) {
    using W = atrium_SiteDescription;
    expect_each_refused<SiteDescription>(
        good_description(),
        {{"site", [](W& w) { spoil_text(w.site, ""); }},
         {"site", [](W& w) { spoil_text(w.site, "a b"); }},
         {"site", [](W& w) { spoil_text(w.site, "../etc"); }},
         {"site", [](W& w) { std::memset(w.site, 'a', sizeof(w.site)); }},  // no terminator
         {"cameras", [](W& w) { w.cameras._length = 65; }},
         {"cameras", [](W& w) { w.cameras._length = 0xffffffff; }},
         {"cameras.name", [](W& w) { spoil_text(w.cameras._buffer[1].name, "\xff"); }},
         {"width", [](W& w) { w.cameras._buffer[1].width = 0; }},
         {"width", [](W& w) { w.cameras._buffer[1].width = 0xffffffff; }},
         {"height", [](W& w) { w.cameras._buffer[0].height = 16385; }},
         {"fx", [](W& w) { w.cameras._buffer[0].fx = 0; }},
         {"fx", [](W& w) { w.cameras._buffer[0].fx = kNan; }},
         {"fy", [](W& w) { w.cameras._buffer[0].fy = -1; }},
         {"cx", [](W& w) { w.cameras._buffer[0].cx = kInfinity; }},
         {"cy", [](W& w) { w.cameras._buffer[0].cy = kNan; }},
         {"skew", [](W& w) { w.cameras._buffer[0].skew = kNan; }},
         {"distortion", [](W& w) { w.cameras._buffer[0].distortion[4] = kNan; }},
         {"camera_from_site",
          [](W& w) { w.cameras._buffer[0].camera_from_site.rotation[3] = 1.01; }},
         {"camera_from_site",
          [](W& w) { w.cameras._buffer[0].camera_from_site.rotation[0] = kNan; }},
         {"camera_from_site",
          [](W& w) { w.cameras._buffer[0].camera_from_site.translation[2] = 1e6; }},
         {"bounds_site", [](W& w) { w.bounds_min[0] = 5; }},
         {"bounds_site", [](W& w) { w.bounds_max[1] = kNan; }},
         {"bounds_site", [](W& w) { w.bounds_max[1] = kInfinity; }}});
}

TEST(FromWire, RefusesEachBadFieldOfASiteMesh) {
    using W = atrium_SiteMesh;
    static std::uint32_t two_equal[] = {3, 3};
    static std::uint32_t too_large[] = {64};
    expect_each_refused<SiteMesh>(
        {"room", 1, {5}, {0, 1}, {1, 2, 3}},
        {{"site", [](W& w) { spoil_text(w.site, "a/b"); }},
         {"capture_time", [](W& w) { w.capture_time_ns = -1; }},
         {"capture_time", [](W& w) { w.capture_time_ns = std::numeric_limits<long>::max(); }},
         {"textured_cameras", [](W& w) { w.textured_cameras._length = 65; }},
         {"textured_cameras", [](W& w) { w.textured_cameras._buffer = two_equal; }},
         {"textured_cameras",
          [](W& w) {
              w.textured_cameras._buffer = too_large;
              w.textured_cameras._length = 1;
          }},
         {"draco", [](W& w) { w.draco._length = kMaxCodedBytes + 1; }},
         {"mesh_sizes", [](W& w) { w.mesh_sizes._length = 65; }},
         {"mesh_sizes",
          [](W& w) {
              w.mesh_sizes._buffer = two_equal;
              w.mesh_sizes._length = 2;
          }},
         {"mesh_sizes", [](W& w) {
              w.mesh_sizes._buffer = too_large;
              w.mesh_sizes._length = 1;
          }}});
}

TEST(FromWire, RefusesEachBadFieldOfACameraTexture) {
    using W = atrium_CameraTexture;
    expect_each_refused<CameraTexture>(
        {"room", 2, 1, {5}, {10, 10, 20, 20}, {1}, {2}},
        {{"site", [](W& w) { spoil_text(w.site, ""); }},
         {"camera", [](W& w) { w.camera = 64; }},
         {"capture_time", [](W& w) { w.capture_time_ns = -1; }},
         {"crop_px.x", [](W& w) { w.crop_x = 0x80000000; }},
         {"crop_px.y", [](W& w) { w.crop_y = 0xffffffff; }},
         {"crop_px.width", [](W& w) { w.crop_width = 0; }},
         {"crop_px.width", [](W& w) { w.crop_width = 16375; }},
         {"crop_px.height", [](W& w) { w.crop_height = 0x7fffffff; }},
         {"colour", [](W& w) { w.colour._length = kMaxCodedBytes + 1; }},
         {"mask", [](W& w) { w.mask._length = 0xffffffff; }}});
}

TEST(FromWire, RefusesEachBadFieldOfTheWorldsTopics) {
    expect_each_refused<SitePlacement>(
        {"room", {}},
        {{"site", [](auto& w) { spoil_text(w.site, ""); }},
         {"world_from_site", [](auto& w) { w.world_from_site.rotation[3] = 0; }},
         {"world_from_site", [](auto& w) { w.world_from_site.translation[0] = -kInfinity; }}});
    SceneObject ball;
    ball.name = "ball";
    expect_each_refused<SceneObject>(
        ball,
        {{"name", [](auto& w) { spoil_text(w.name, "a\nb"); }},
         {"shape", [](auto& w) { w.shape = 8; }},
         {"shape", [](auto& w) { w.shape = 255; }},
         {"model", [](auto& w) { w.shape = 5; }},
         {"model", [](auto& w) { w.shape = 6; }},
         {"model", [](auto& w) { spoil_text(w.model, "../../etc/passwd"); }},
         {"model", [](auto& w) { spoil_text(w.model, "/etc/passwd"); }},
         {"model", [](auto& w) { std::memset(w.model, 'a', sizeof(w.model)); }},
         {"model_scale", [](auto& w) { w.model_scale = 0; }},
         {"model_scale", [](auto& w) { w.model_scale = kNan; }},
         {"texture", [](auto& w) { spoil_text(w.texture, "a/../b.png"); }},
         {"friction", [](auto& w) { w.friction = -0.1; }},
         {"friction", [](auto& w) { w.friction = kInfinity; }},
         {"restitution", [](auto& w) { w.restitution = 1.1; }},
         {"restitution", [](auto& w) { w.restitution = kNan; }},
         {"size_m", [](auto& w) { w.size_m[0] = 0; }},
         {"size_m", [](auto& w) { w.size_m[2] = kNan; }},
         {"mass_kg", [](auto& w) { w.mass_kg = -1; }},
         {"mass_kg", [](auto& w) { w.mass_kg = kInfinity; }},
         {"colour", [](auto& w) { w.colour[1] = 1.5; }},
         {"world_from_object", [](auto& w) { w.world_from_object.rotation[1] = 1; }}});
    expect_each_refused<SceneState>(
        {"hall", 1, {5}, std::vector<ObjectState>(2)},
        {{"world", [](auto& w) { spoil_text(w.world, "*"); }},
         {"time", [](auto& w) { w.time_ns = -5; }},
         {"objects", [](auto& w) { w.objects._length = 2049; }},
         {"world_from_object",
          [](auto& w) { w.objects._buffer[1].world_from_object.rotation[3] = kNan; }},
         {"linear_velocity", [](auto& w) { w.objects._buffer[1].linear_velocity[0] = kNan; }},
         {"angular_velocity", [](auto& w) { w.objects._buffer[0].angular_velocity[2] = 1e9; }}});
    SceneCommand add;
    add.sender = "viewer";
    add.kind = CommandKind::kAdd;
    add.object = ball;
    expect_each_refused<SceneCommand>(
        add,
        {{"sender", [](auto& w) { spoil_text(w.sender, ""); }},
         {"kind", [](auto& w) { w.kind = 9; }},
         {"point_object", [](auto& w) { w.point_object[2] = kNan; }},
         {"goal_world", [](auto& w) { w.goal_world[1] = 1e6; }},
         {"impulse_ns", [](auto& w) { w.impulse_ns[0] = kNan; }},
         {"SceneObject.mass_kg", [](auto& w) { w.object.mass_kg = kNan; }}});
}

TEST(ModelFile, StaysInItsFolder) {
    for (const char* good : {"a", "ball.obj", "puppet/arm-1.glb", "a/b/c_d.0.stl", "a/b..c"})
        EXPECT_TRUE(is_valid_model_file(good)) << good;
    for (const char* bad : {"",
                            "/",
                            "/a",
                            "a/",
                            "..",
                            "../a",
                            "a/..",
                            "a/../b",
                            "a//b",
                            ".a",
                            "./a",
                            "a/.b",
                            "a\\b",
                            "a:b",
                            "~/a",
                            "a\nb",
                            "a%2e"})
        EXPECT_FALSE(is_valid_model_file(bad)) << bad;
    EXPECT_TRUE(is_valid_model_file(std::string(127, 'a')));
    EXPECT_FALSE(is_valid_model_file(std::string(128, 'a')));
    EXPECT_FALSE(is_valid_model_file(std::string("a\0b", 3)));
}

TEST(SoftNodes, AreAccurateToHalfAStep) {
    Random random(12);
    for (const double extent_m : {0.0, 1e-7, 0.1, 2.0, 40.0}) {
        std::uniform_real_distribution<float> anywhere(-static_cast<float>(extent_m) / 2,
                                                       static_cast<float>(extent_m) / 2);
        std::vector<Eigen::Vector3f> places(500);
        for (auto& place : places)
            place = Eigen::Vector3f(anywhere(random), anywhere(random), 5 + anywhere(random));
        SoftBodyState state;
        quantise(places, state);
        ASSERT_TRUE(check(state));
        ASSERT_EQ(state.nodes.size(), places.size());
        EXPECT_LE(state.step_m, std::max(1e-6, extent_m / 65535.0) * 1.0001);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Eigen::Vector3d off = node_place(state, i) - places[i].cast<double>();
            EXPECT_LE(off.cwiseAbs().maxCoeff(), 0.5001 * state.step_m);
        }
    }
}

TEST(FromWire, RefusesAFeedbackKeyWithABadName) {
    atrium_StreamFeedback key{};
    key_to_wire(StreamFeedback{"viewer", "room", {}}, key);
    ASSERT_TRUE(key_from_wire<StreamFeedback>(key).has_value());
    spoil_text(key.viewer, "");
    EXPECT_FALSE(key_from_wire<StreamFeedback>(key).has_value());
    spoil_text(key.viewer, "viewer");
    spoil_text(key.site, "a b");
    EXPECT_FALSE(key_from_wire<StreamFeedback>(key).has_value());
}

TEST(FromWire, RefusesAFaultOfACameraThatTheRigLacks) {
    SiteStatus status;
    status.site = "room";
    status.coherence = {RigVerdict::kMoved, 0.4, 48, {{"north", 0.4, 0.9, 300}}, {}};
    expect_each_refused<SiteStatus>(
        status,
        {{"finding", [](auto& w) { spoil_text(w.finding, "a\n"); }},
         {"coherence.fault.camera", [](auto& w) { w.coherence.fault.camera = 1; }},
         {"coherence.fault.camera", [](auto& w) { w.coherence.cameras._length = 0; }},
         {"coherence.verdict", [](auto& w) { w.coherence.verdict = 6; }},
         {"coherence.fault.cure",
          [](auto& w) { spoil_text(w.coherence.fault.cure, "a\033[2J"); }}});
    status.coherence.fault.camera = 7;
    status.coherence.verdict = RigVerdict::kCoherent;  // without a fault it means nothing
    EXPECT_TRUE(check(status));
}

TEST(FromWire, NormalisesAQuaternionWithASmallError) {
    WireScratch scratch;
    atrium_SitePlacement wire{};
    to_wire(SitePlacement{"room", {}}, scratch, wire);
    wire.world_from_site.rotation[3] = 1.0 + 0.9 * kQuaternionTolerance;
    const auto placement = from_wire<SitePlacement>(wire);
    ASSERT_TRUE(placement.has_value());
    EXPECT_NEAR(placement->world_from_site.rotation.norm(), 1.0, 1e-15);
}

TEST(FromWire, ChecksTheObjectOfAddCommandsOnly) {
    WireScratch scratch;
    atrium_SceneCommand wire{};
    SceneCommand reset;
    reset.sender = "viewer";
    to_wire(reset, scratch, wire);
    wire.object.mass_kg = kNan;
    const auto command = from_wire<SceneCommand>(wire);
    ASSERT_TRUE(command.has_value());
    EXPECT_EQ(command->object.mass_kg, 0.0);
}

TEST(ToWire, LendsCodedBytesWithoutACopy) {
    const SiteMesh message{"room", 1, {5}, {0}, std::vector<std::uint8_t>(1000, 7)};
    WireScratch scratch;
    atrium_SiteMesh wire{};
    to_wire(message, scratch, wire);
    EXPECT_EQ(wire.draco._buffer, message.draco.data());
    EXPECT_EQ(wire.draco._length, 1000U);
    EXPECT_EQ(payload_bytes(message), 4U + 8U + 8U + 4U + 1000U);
}

TEST(FromWire, AcceptsALatencyBetweenDifferentClocks) {
    Random random(3);
    auto status = random_message<ViewerStatus>(random);
    status.capture_to_display.median_ms = -3.6e6;  // the site's clock is an hour ahead
    status.capture_to_display.p99_ms = -3.5e6;
    EXPECT_TRUE(check(status));
}

}  // namespace
}  // namespace atrium::bus
