#include "core/bus/wire.hpp"

#include "core/bus/checks.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/soft_nodes.hpp"
#include "core/bus/topics.hpp"
#include "tests/unit/bus/random_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace atrium::bus {
namespace {

using ::testing::HasSubstr;
using testing::Random;
using testing::random_message;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <typename Message>
class EveryMessage : public ::testing::Test {};
using Messages = ::testing::Types<SiteDescription,
                                  SiteMesh,
                                  CameraTexture,
                                  SitePlacement,
                                  SceneObject,
                                  SoftBody,
                                  SoftBodyState,
                                  Scenery,
                                  SceneState,
                                  PersonProxy,
                                  ObjectProxy,
                                  SceneCommand,
                                  SiteStatus,
                                  WorldStatus,
                                  ViewerStatus,
                                  StreamFeedback,
                                  Presence>;
TYPED_TEST_SUITE(EveryMessage, Messages);

TYPED_TEST(EveryMessage, SurvivesTheWireUnchanged) {
    Random random(7);
    WireScratch scratch;
    for (int round = 0; round < 200; ++round) {
        const auto message = random_message<TypeParam>(random);
        ASSERT_TRUE(check(message).has_value()) << check(message).error().message;
        typename Topic<TypeParam>::Wire wire{};
        to_wire(message, scratch, wire);
        const auto back = from_wire(wire);
        ASSERT_TRUE(back.has_value()) << back.error().message;
        EXPECT_TRUE(testing::same(message, *back)) << "round " << round;
    }
}

TYPED_TEST(EveryMessage, KeepsItsKeyWithoutData) {
    Random random(8);
    const auto message = random_message<TypeParam>(random);
    typename Topic<TypeParam>::Wire key{};
    typename Topic<TypeParam>::Wire again{};
    key_to_wire(message, key);
    const auto back = key_from_wire(key);
    ASSERT_TRUE(back.has_value());
    key_to_wire(*back, again);
    EXPECT_EQ(std::memcmp(&key, &again, sizeof(key)), 0);
}

/// A valid wire struct, a change to it, and the field that the refusal must name.
template <typename Message>
struct Damage {
    std::string names;
    std::function<void(typename Topic<Message>::Wire&)> apply;
};

template <typename Message>
void expect_each_refused(const Message& good, const std::vector<Damage<Message>>& damages) {
    for (const auto& damage : damages) {
        WireScratch scratch;
        typename Topic<Message>::Wire wire{};
        to_wire(good, scratch, wire);
        ASSERT_TRUE(from_wire(wire).has_value()) << from_wire(wire).error().message;
        damage.apply(wire);
        const auto result = from_wire(wire);
        ASSERT_FALSE(result.has_value()) << damage.names;
        EXPECT_EQ(result.error().kind, ErrorKind::kInvalidData);
        EXPECT_THAT(result.error().message, HasSubstr(damage.names));
    }
}

void spoil_file(atrium_ModelFile& file, const char* text) {
    std::strncpy(file, text, sizeof(file) - 1);
    file[sizeof(file) - 1] = '\0';
}

void spoil_name(atrium_Name& name, const char* text) {
    std::strncpy(name, text, sizeof(name) - 1);
    name[sizeof(name) - 1] = '\0';
}

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
        {{"site", [](W& w) { spoil_name(w.site, ""); }},
         {"site", [](W& w) { spoil_name(w.site, "a b"); }},
         {"site", [](W& w) { spoil_name(w.site, "../etc"); }},
         {"site", [](W& w) { std::memset(w.site, 'a', sizeof(w.site)); }},  // no terminator
         {"cameras", [](W& w) { w.cameras._length = 65; }},
         {"cameras", [](W& w) { w.cameras._length = 0xffffffff; }},
         {"cameras.name", [](W& w) { spoil_name(w.cameras._buffer[1].name, "\xff"); }},
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
        {{"site", [](W& w) { spoil_name(w.site, "a/b"); }},
         {"capture_time", [](W& w) { w.capture_time_ns = -1; }},
         {"capture_time", [](W& w) { w.capture_time_ns = std::numeric_limits<long>::max(); }},
         {"textured_cameras", [](W& w) { w.textured_cameras._length = 65; }},
         {"textured_cameras", [](W& w) { w.textured_cameras._buffer = two_equal; }},
         {"textured_cameras",
          [](W& w) {
              w.textured_cameras._buffer = too_large;
              w.textured_cameras._length = 1;
          }},
         {"draco", [](W& w) { w.draco._length = kMaxCodedBytes + 1; }}});
}

TEST(FromWire, RefusesEachBadFieldOfACameraTexture) {
    using W = atrium_CameraTexture;
    expect_each_refused<CameraTexture>(
        {"room", 2, 1, {5}, {10, 10, 20, 20}, {1}, {2}},
        {{"site", [](W& w) { spoil_name(w.site, ""); }},
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
        {{"site", [](auto& w) { spoil_name(w.site, ""); }},
         {"world_from_site", [](auto& w) { w.world_from_site.rotation[3] = 0; }},
         {"world_from_site", [](auto& w) { w.world_from_site.translation[0] = -kInfinity; }}});
    SceneObject ball;
    ball.name = "ball";
    expect_each_refused<SceneObject>(
        ball,
        {{"name", [](auto& w) { spoil_name(w.name, "a\nb"); }},
         {"shape", [](auto& w) { w.shape = 8; }},
         {"shape", [](auto& w) { w.shape = 255; }},
         {"model", [](auto& w) { w.shape = 5; }},
         {"model", [](auto& w) { w.shape = 6; }},
         {"model", [](auto& w) { spoil_file(w.model, "../../etc/passwd"); }},
         {"model", [](auto& w) { spoil_file(w.model, "/etc/passwd"); }},
         {"model", [](auto& w) { std::memset(w.model, 'a', sizeof(w.model)); }},
         {"model_scale", [](auto& w) { w.model_scale = 0; }},
         {"model_scale", [](auto& w) { w.model_scale = kNan; }},
         {"texture", [](auto& w) { spoil_file(w.texture, "a/../b.png"); }},
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
        {{"world", [](auto& w) { spoil_name(w.world, "*"); }},
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
        {{"sender", [](auto& w) { spoil_name(w.sender, ""); }},
         {"kind", [](auto& w) { w.kind = 9; }},
         {"point_object", [](auto& w) { w.point_object[2] = kNan; }},
         {"goal_world", [](auto& w) { w.goal_world[1] = 1e6; }},
         {"impulse_ns", [](auto& w) { w.impulse_ns[0] = kNan; }},
         {"SceneObject.mass_kg", [](auto& w) { w.object.mass_kg = kNan; }}});
}

TEST(FromWire, RefusesEachBadFieldOfASoftBodyAndOfScenery) {
    static std::uint16_t beyond[] = {0, 1, 4};
    expect_each_refused<SoftBody>({3, 4, 0.01, {{0, 1, 2}}, {{2, 3}}},
                                  {{"num_nodes", [](auto& w) { w.num_nodes = 4097; }},
                                   {"triangles", [](auto& w) { w.num_nodes = 2; }},
                                   {"triangles", [](auto& w) { w.triangles._buffer = beyond; }},
                                   {"triangles", [](auto& w) { w.triangles._length = 2; }},
                                   {"triangles", [](auto& w) { w.triangles._length = 24579; }},
                                   {"segments", [](auto& w) { w.num_nodes = 3; }},
                                   {"segments", [](auto& w) { w.segments._length = 1; }},
                                   {"segments", [](auto& w) { w.segments._length = 0xffffffff; }},
                                   {"thickness_m", [](auto& w) { w.thickness_m = kNan; }},
                                   {"thickness_m", [](auto& w) { w.thickness_m = -0.1; }}});
    expect_each_refused<SoftBodyState>({3, 1, {5}, {0, 0, 0}, 1e-4, {{0, 1, 2}, {65535, 0, 9}}},
                                       {{"time", [](auto& w) { w.time_ns = -1; }},
                                        {"origin_m", [](auto& w) { w.origin_m[1] = kInfinity; }},
                                        {"step_m", [](auto& w) { w.step_m = 0; }},
                                        {"step_m", [](auto& w) { w.step_m = kNan; }},
                                        {"step_m", [](auto& w) { w.step_m = 2; }},
                                        {"nodes", [](auto& w) { w.nodes._length = 5; }},
                                        {"nodes", [](auto& w) { w.nodes._length = 12291; }}});
    Scenery room;
    room.name = "room";
    room.model = "room.obj";
    expect_each_refused<Scenery>(
        room,
        {{"name", [](auto& w) { spoil_name(w.name, ""); }},
         {"model", [](auto& w) { spoil_file(w.model, ""); }},
         {"model", [](auto& w) { spoil_file(w.model, "..//x"); }},
         {"model_scale", [](auto& w) { w.model_scale = -1; }},
         {"texture", [](auto& w) { spoil_file(w.texture, "a b"); }},
         {"colour", [](auto& w) { w.colour[0] = kNan; }},
         {"world_from_model", [](auto& w) { w.world_from_model.translation[0] = kNan; }}});
}

TEST(FromWire, RefusesEachBadFieldOfAProxy) {
    PersonProxy person;
    person.site = "alice";
    person.points.resize(3);
    person.touches = {{2, {0.1, 0.2, 0.3}}};
    expect_each_refused<PersonProxy>(
        person,
        {{"site", [](auto& w) { spoil_name(w.site, "a b"); }},
         {"capture_time", [](auto& w) { w.capture_time_ns = -1; }},
         {"origin_m", [](auto& w) { w.origin_m[0] = kNan; }},
         {"origin_m", [](auto& w) { w.origin_m[2] = 1e6; }},
         {"step_m", [](auto& w) { w.step_m = kNan; }},
         {"step_m", [](auto& w) { w.step_m = 0; }},
         {"step_m", [](auto& w) { w.step_m = 2; }},
         {"points", [](auto& w) { w.points._length = 2049; }},
         {"touches", [](auto& w) { w.touches._length = 0xffffffff; }},
         {"point_world", [](auto& w) { w.touches._buffer[0].point_world[1] = kInfinity; }}});
    static std::uint16_t beyond[] = {0, 2};
    expect_each_refused<ObjectProxy>({3, {0, 0, 0}, 1e-4, {{0, 1, 2}, {65535, 0, 9}}, {{0, 1}}},
                                     {{"origin_m", [](auto& w) { w.origin_m[1] = kInfinity; }},
                                      {"step_m", [](auto& w) { w.step_m = kNan; }},
                                      {"step_m", [](auto& w) { w.step_m = -1e-4; }},
                                      {"vertices", [](auto& w) { w.vertices._length = 5; }},
                                      {"vertices", [](auto& w) { w.vertices._length = 12291; }},
                                      {"edges", [](auto& w) { w.edges._length = 1; }},
                                      {"edges", [](auto& w) { w.edges._length = 24578; }},
                                      {"edges", [](auto& w) { w.edges._buffer = beyond; }}});
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

TEST(FromWire, RefusesEachBadFieldOfAStatus) {
    Random random(3);
    expect_each_refused<SiteStatus>(
        random_message<SiteStatus>(random),
        {{"site", [](auto& w) { spoil_name(w.site, ""); }},
         {"time", [](auto& w) { w.time_ns = -1; }},
         {"left_out.dropped_l", [](auto& w) { w.left_out.dropped_l = kNan; }},
         {"left_out.dropped_l", [](auto& w) { w.left_out.dropped_l = 1e16; }},
         {"metaframes_per_s", [](auto& w) { w.metaframes_per_s = -1; }},
         {"bytes_per_s", [](auto& w) { w.bytes_per_s = kInfinity; }},
         {"capture_to_publish", [](auto& w) { w.capture_to_publish.median_ms = kNan; }},
         {"cameras", [](auto& w) { w.cameras._length = 65; }},
         {"cameras", [](auto& w) { w.cameras._length = 0xffffffff; }},
         {"cameras.name", [](auto& w) { spoil_name(w.cameras._buffer[1].name, ""); }},
         {"cameras.name", [](auto& w) { spoil_name(w.cameras._buffer[0].name, "a\nb"); }},
         {"cameras.connected", [](auto& w) { w.cameras._buffer[1].connected = 2; }},
         {"cameras.connected", [](auto& w) { w.cameras._buffer[0].connected = 255; }},
         {"cameras.offset_ms", [](auto& w) { w.cameras._buffer[1].offset_ms = kNan; }},
         {"cameras.offset_ms", [](auto& w) { w.cameras._buffer[0].offset_ms = -1e16; }},
         {"last_picture_age", [](auto& w) { w.cameras._buffer[1].last_picture_age_ms = kNan; }},
         {"last_picture_age", [](auto& w) { w.cameras._buffer[1].last_picture_age_ms = -0.5; }},
         {"last_picture_age",
          [](auto& w) { w.cameras._buffer[0].last_picture_age_ms = kInfinity; }},
         {"stream.jpeg_quality", [](auto& w) { w.stream.jpeg_quality = 0; }},
         {"stream.jpeg_quality", [](auto& w) { w.stream.jpeg_quality = 101; }},
         {"stream.colour_divisor", [](auto& w) { w.stream.colour_divisor = 0; }},
         {"stream.colour_divisor", [](auto& w) { w.stream.colour_divisor = 3; }},
         {"stream.send_every", [](auto& w) { w.stream.send_every = 0; }},
         {"stream.send_every", [](auto& w) { w.stream.send_every = 0xffffffff; }},
         {"stream.cap_bit_per_s", [](auto& w) { w.stream.cap_bit_per_s = kNan; }},
         {"stream.cap_bit_per_s", [](auto& w) { w.stream.cap_bit_per_s = -1; }},
         {"stream.cap_set_by", [](auto& w) { spoil_name(w.stream.cap_set_by, "a b"); }},
         {"stream.cap_set_by",
          [](auto& w) { std::memset(w.stream.cap_set_by, 'a', sizeof(w.stream.cap_set_by)); }},
         {"stages", [](auto& w) { w.stages.silhouettes_ms = kNan; }},
         {"stages", [](auto& w) { w.stages.hull_ms = -1; }},
         {"stages", [](auto& w) { w.stages.coding_ms = kInfinity; }},
         {"stages", [](auto& w) { w.stages.publishing_ms = 1e16; }},
         {"mesh_bytes_per_s", [](auto& w) { w.mesh_bytes_per_s = -1; }},
         {"texture_bytes_per_s", [](auto& w) { w.texture_bytes_per_s = kNan; }},
         {"seconds per second", [](auto& w) { w.processor.run_per_s = -1; }},
         {"is_waiting_known", [](auto& w) { w.processor.is_waiting_known = 2; }},
         {"nice", [](auto& w) { w.processor.nice = 20; }},
         {"first_output_s", [](auto& w) { w.first_output_s = kNan; }}});
    expect_each_refused<WorldStatus>(
        random_message<WorldStatus>(random),
        {{"world", [](auto& w) { spoil_name(w.world, ""); }},
         {"time", [](auto& w) { w.time_ns = -1; }},
         {"steps_per_s", [](auto& w) { w.steps_per_s = kNan; }},
         {"capture_to_collision", [](auto& w) { w.capture_to_collision.p99_ms = -1e16; }},
         {"bytes_per_s", [](auto& w) { w.bytes_per_s = -1; }},
         {"bytes_per_s", [](auto& w) { w.bytes_per_s = kNan; }},
         {"step", [](auto& w) { w.step.median_ms = kInfinity; }},
         {"prepare", [](auto& w) { w.prepare.p99_ms = kNan; }},
         {"seconds per second", [](auto& w) { w.processor.waited_per_s = kNan; }},
         {"is_waiting_known", [](auto& w) { w.processor.is_waiting_known = 255; }},
         {"nice", [](auto& w) { w.processor.nice = -21; }},
         {"first_output_s", [](auto& w) { w.first_output_s = -1; }}});
    expect_each_refused<ViewerStatus>(
        random_message<ViewerStatus>(random),
        {{"viewer", [](auto& w) { spoil_name(w.viewer, ""); }},
         {"time", [](auto& w) { w.time_ns = -1; }},
         {"frames_per_s", [](auto& w) { w.frames_per_s = kNan; }},
         {"capture_to_display", [](auto& w) { w.capture_to_display.median_ms = kInfinity; }},
         {"seconds per second", [](auto& w) { w.processor.longest_wait_per_s = kInfinity; }},
         {"is_waiting_known", [](auto& w) { w.processor.is_waiting_known = 3; }},
         {"nice", [](auto& w) { w.processor.nice = 32767; }},
         {"first_output_s", [](auto& w) { w.first_output_s = 1e16; }},
         {"max_frames_per_s", [](auto& w) { w.max_frames_per_s = -1; }},
         {"scale", [](auto& w) { w.scale = 1.5; }},
         {"scale", [](auto& w) { w.scale = kNan; }},
         {"has_shadows", [](auto& w) { w.has_shadows = 2; }}});
}

TEST(FromWire, RefusesEachBadFieldOfAFeedback) {
    Random random(3);
    expect_each_refused<StreamFeedback>(
        random_message<StreamFeedback>(random),
        {{"viewer", [](auto& w) { spoil_name(w.viewer, ""); }},
         {"viewer", [](auto& w) { std::memset(w.viewer, 'a', sizeof(w.viewer)); }},
         {"site", [](auto& w) { spoil_name(w.site, "a/b"); }},
         {"time", [](auto& w) { w.time_ns = -1; }},
         {"time", [](auto& w) { w.time_ns = std::numeric_limits<long>::max(); }},
         {"payload_bytes_per_s", [](auto& w) { w.payload_bytes_per_s = -1; }},
         {"payload_bytes_per_s", [](auto& w) { w.payload_bytes_per_s = kNan; }},
         {"payload_bytes_per_s", [](auto& w) { w.payload_bytes_per_s = 1e16; }},
         {"delay_ms", [](auto& w) { w.min_delay_ms = kNan; }},
         {"delay_ms", [](auto& w) { w.min_delay_ms = -1e16; }},
         {"delay_ms", [](auto& w) { w.median_delay_ms = kInfinity; }},
         {"delay_ms", [](auto& w) { w.sure_delay_ms = kNan; }},
         {"longest_wait_ms", [](auto& w) { w.longest_wait_ms = -1; }},
         {"longest_wait_ms", [](auto& w) { w.longest_wait_ms = kNan; }},
         {"longest_wait_ms", [](auto& w) { w.longest_wait_ms = 1e16; }}});
}

TEST(FromWire, RefusesAFeedbackKeyWithABadName) {
    atrium_StreamFeedback key{};
    key_to_wire(StreamFeedback{"viewer", "room", {}}, key);
    ASSERT_TRUE(key_from_wire(key).has_value());
    spoil_name(key.viewer, "");
    EXPECT_FALSE(key_from_wire(key).has_value());
    spoil_name(key.viewer, "viewer");
    spoil_name(key.site, "a b");
    EXPECT_FALSE(key_from_wire(key).has_value());
}

TEST(FromWire, NormalisesAQuaternionWithASmallError) {
    WireScratch scratch;
    atrium_SitePlacement wire{};
    to_wire(SitePlacement{"room", {}}, scratch, wire);
    wire.world_from_site.rotation[3] = 1.0 + 0.9 * kQuaternionTolerance;
    const auto placement = from_wire(wire);
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
    const auto command = from_wire(wire);
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

TEST(FromWire, RefusesABadPresence) {
    Random random(4);
    expect_each_refused<Presence>(
        random_message<Presence>(random),
        {{"kind", [](auto& w) { w.kind = 4; }},
         {"name", [](auto& w) { w.member[0] = '*'; }},
         {"host", [](auto& w) { w.host[0] = '\0'; }},
         {"version", [](auto& w) { w.version[0] = ' '; }},
         {"start_time", [](auto& w) { w.start_time_ns = -1; }},
         {"clock_max_error", [](auto& w) { w.clock_max_error_ns = -1; }}});
}

}  // namespace
}  // namespace atrium::bus
