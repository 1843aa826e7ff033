#include "viewer/receive/pairing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <variant>

namespace atrium::viewer {
namespace {

constexpr std::int64_t kPeriodNs = 33'000'000;
constexpr std::int64_t kStartNs = 1'700'000'000'000'000'000;

bus::SiteMesh mesh(const std::string& site,
                   std::uint64_t frame,
                   std::vector<std::uint32_t> cameras,
                   std::int64_t start_ns = kStartNs) {
    bus::SiteMesh m;
    m.site = site;
    m.frame_id = frame;
    m.capture_time = {start_ns + static_cast<std::int64_t>(frame) * kPeriodNs};
    m.textured_cameras = std::move(cameras);
    m.draco = {1, 2, 3};
    return m;
}

bus::CameraTexture texture(const std::string& site,
                           std::uint64_t frame,
                           std::uint32_t camera,
                           std::int64_t start_ns = kStartNs) {
    bus::CameraTexture t;
    t.site = site;
    t.camera = camera;
    t.frame_id = frame;
    t.capture_time = {start_ns + static_cast<std::int64_t>(frame) * kPeriodNs};
    return t;
}

TEST(Pairing, DeliversAFrameWhenItsLastPartArrives) {
    Pairing sut;
    EXPECT_FALSE(sut.add(texture("a", 1, 0)));
    EXPECT_FALSE(sut.add(mesh("a", 1, {0, 3})));
    const auto pair = sut.add(texture("a", 1, 3));
    ASSERT_TRUE(pair);
    EXPECT_EQ(pair->mesh.frame_id, 1u);
    EXPECT_EQ(pair->textures.size(), 2u);
    EXPECT_EQ(sut.num_pending("a"), 0u);
}

TEST(Pairing, MeshWithoutTexturesIsComplete) {
    Pairing sut;
    EXPECT_TRUE(sut.add(mesh("a", 1, {})));
}

TEST(Pairing, DoesNotMixSites) {
    Pairing sut;
    EXPECT_FALSE(sut.add(mesh("a", 1, {0})));
    EXPECT_FALSE(sut.add(texture("b", 1, 0)));
    EXPECT_TRUE(sut.add(texture("a", 1, 0)));
}

TEST(Pairing, DropsPartsOlderThanTheDeliveredFrame) {
    Pairing sut;
    EXPECT_FALSE(sut.add(mesh("a", 1, {0})));
    EXPECT_FALSE(sut.add(mesh("a", 2, {0})));
    EXPECT_TRUE(sut.add(texture("a", 2, 0)));
    EXPECT_EQ(sut.num_incomplete(), 1u);
    EXPECT_FALSE(sut.add(texture("a", 1, 0)));
    EXPECT_FALSE(sut.add(mesh("a", 2, {})));  // a duplicate
    EXPECT_EQ(sut.num_late(), 2u);
}

TEST(Pairing, ShowsARestartedSiteThatCountsFromZero) {
    Pairing sut;
    ASSERT_TRUE(sut.add(mesh("a", 900, {})));
    const std::int64_t later = kStartNs + 1000 * kPeriodNs;
    EXPECT_FALSE(sut.add(mesh("a", 0, {0}, later)));
    EXPECT_TRUE(sut.add(texture("a", 0, 0, later)));
}

// DDS may deliver a sample again after it has lost and found its writer.
TEST(Pairing, ShowsNoFrameTwiceWhenALostSiteIsBack) {
    Pairing sut;
    EXPECT_FALSE(sut.add(mesh("a", 29, {0})));
    ASSERT_TRUE(sut.add(mesh("a", 30, {})));
    EXPECT_FALSE(sut.add(mesh("a", 31, {0})));
    sut.forget("a");
    EXPECT_EQ(sut.num_pending("a"), 0U);
    EXPECT_FALSE(sut.add(mesh("a", 30, {})));
    EXPECT_FALSE(sut.add(texture("a", 31, 0))) << "its mesh was forgotten";
    EXPECT_TRUE(sut.add(mesh("a", 32, {})));
    // another program, whose clock is far behind
    sut.forget("a");
    EXPECT_TRUE(sut.add(mesh("a", 1, {}, kStartNs - 3'600'000'000'000)));
}

TEST(Pairing, ASiteThatIsGoneMakesRoom) {
    Pairing sut({.max_sites = 2});
    EXPECT_TRUE(sut.add(mesh("a", 1, {})));
    EXPECT_TRUE(sut.add(mesh("b", 1, {})));
    sut.forget("a");
    EXPECT_TRUE(sut.add(mesh("c", 1, {})));
    EXPECT_FALSE(sut.add(mesh("a", 2, {})));
    EXPECT_TRUE(sut.add(mesh("b", 2, {})));
}

TEST(Pairing, ClockSetBackDoesNotFreezeTheSite) {
    Pairing sut;
    ASSERT_TRUE(sut.add(mesh("a", 30, {})));
    EXPECT_TRUE(sut.add(mesh("a", 31, {}, kStartNs - 3'600'000'000'000)));
}

TEST(Pairing, IgnoresSitesBeyondItsLimit) {
    Pairing sut({.max_sites = 2});
    EXPECT_TRUE(sut.add(mesh("a", 1, {})));
    EXPECT_TRUE(sut.add(mesh("b", 1, {})));
    EXPECT_FALSE(sut.add(mesh("c", 1, {})));
    EXPECT_TRUE(sut.add(mesh("b", 2, {})));
}

// Random loss, duplication and reordering on two sites, many times.
class PairingUnderFaults : public testing::TestWithParam<int> {};

TEST_P(PairingUnderFaults, NeverMixesOrGoesBackAndStaysBounded) {
    std::mt19937 random(static_cast<unsigned>(GetParam()));
    const auto chance = [&](double p) { return std::bernoulli_distribution(p)(random); };
    const double loss = std::uniform_real_distribution<>(0.0, 0.3)(random);
    using Sample = std::variant<bus::SiteMesh, bus::CameraTexture>;
    struct Delivery {
        double due;
        Sample sample;
    };
    std::vector<Delivery> deliveries;
    std::uniform_real_distribution<> delay(0.0, 2.5);  // frames
    for (std::uint64_t frame = 0; frame < 200; ++frame) {
        for (const std::string site : {"a", "b"}) {
            std::vector<std::uint32_t> cameras;
            for (std::uint32_t c = 0; c < 6; ++c)
                if (chance(0.7)) cameras.push_back(c);
            std::vector<Sample> samples = {mesh(site, frame, cameras)};
            for (const std::uint32_t c : cameras) samples.emplace_back(texture(site, frame, c));
            for (const Sample& sample : samples)
                for (int copy = chance(0.05) ? 2 : 1; copy > 0; --copy)
                    if (!chance(loss))
                        deliveries.push_back({static_cast<double>(frame) + delay(random), sample});
        }
    }
    std::stable_sort(deliveries.begin(), deliveries.end(), [](const auto& x, const auto& y) {
        return x.due < y.due;
    });

    const PairingOptions options{.max_pending_frames = 3};
    Pairing sut(options);
    std::map<std::string, std::int64_t> last;
    std::size_t num_pairs = 0;
    for (const Delivery& delivery : deliveries) {
        const auto pair =
            std::visit([&](auto sample) { return sut.add(std::move(sample)); }, delivery.sample);
        for (const std::string site : {"a", "b"})
            ASSERT_LE(sut.num_pending(site), options.max_pending_frames);
        if (!pair) continue;
        ++num_pairs;
        const bus::SiteMesh& m = pair->mesh;
        std::vector<std::uint32_t> cameras;
        for (const bus::CameraTexture& t : pair->textures) {
            ASSERT_EQ(t.site, m.site);
            ASSERT_EQ(t.frame_id, m.frame_id);
            ASSERT_EQ(t.capture_time, m.capture_time);
            cameras.push_back(t.camera);
        }
        ASSERT_THAT(cameras, testing::UnorderedElementsAreArray(m.textured_cameras));
        const auto [previous, is_first] = last.try_emplace(m.site, m.capture_time.ns);
        if (!is_first) {
            ASSERT_GT(m.capture_time.ns, previous->second);
        }
        previous->second = m.capture_time.ns;
    }
    // (1 - loss)^7 of the frames with seven parts arrive complete: with 30 % loss, 8 % of 400
    EXPECT_GT(num_pairs, 5u);
}
INSTANTIATE_TEST_SUITE_P(Seeds, PairingUnderFaults, testing::Range(0, 40));

TEST(Pairing, DeliversEveryFrameInOrderWithoutLoss) {
    Pairing sut;
    for (std::uint64_t frame = 0; frame < 50; ++frame) {
        EXPECT_FALSE(sut.add(mesh("a", frame, {0, 1})));
        EXPECT_FALSE(sut.add(texture("a", frame, 1)));
        EXPECT_TRUE(sut.add(texture("a", frame, 0)));
    }
    EXPECT_EQ(sut.num_incomplete(), 0u);
    EXPECT_EQ(sut.num_late(), 0u);
}

// A site on several hosts: each camera node numbers its pictures, on its own clock.
bus::FrameKey own_key(std::uint64_t frame, std::uint32_t camera) {
    const std::int64_t off_ns = 1'000'000 * (static_cast<std::int64_t>(camera) - 2);
    return {1000 * camera + frame,
            {kStartNs + static_cast<std::int64_t>(frame) * kPeriodNs + off_ns}};
}

bus::SiteMesh naming_mesh(std::uint64_t frame, const std::vector<std::uint32_t>& cameras) {
    bus::SiteMesh m = mesh("a", frame, cameras);
    for (const std::uint32_t camera : cameras) m.texture_frames.push_back(own_key(frame, camera));
    return m;
}

bus::CameraTexture own_texture(std::uint64_t frame, std::uint32_t camera) {
    bus::CameraTexture t = texture("a", frame, camera);
    t.frame_id = own_key(frame, camera).frame_id;
    t.capture_time = own_key(frame, camera).capture_time;
    return t;
}

TEST(Pairing, FindsTheTexturesThatAMeshNames) {
    Pairing sut;
    EXPECT_FALSE(sut.add(own_texture(1, 0)));
    EXPECT_FALSE(sut.add(naming_mesh(1, {0, 3})));
    const auto pair = sut.add(own_texture(1, 3));
    ASSERT_TRUE(pair);
    ASSERT_EQ(pair->textures.size(), 2u);
    EXPECT_EQ(pair->textures[0].frame_id, own_key(1, 0).frame_id);
    EXPECT_EQ(pair->textures[1].frame_id, own_key(1, 3).frame_id);
}

TEST(Pairing, TexturesThatNoMeshNamesAreNoLoss) {
    Pairing sut;
    ASSERT_FALSE(sut.add(naming_mesh(1, {0})));
    ASSERT_TRUE(sut.add(own_texture(1, 0)));
    for (std::uint64_t frame = 2; frame < 40; ++frame) EXPECT_FALSE(sut.add(own_texture(frame, 0)));
    EXPECT_TRUE(sut.add(naming_mesh(39, {0})));
    EXPECT_EQ(sut.num_incomplete(), 0u);
    EXPECT_FALSE(sut.add(own_texture(38, 0)));
    EXPECT_EQ(sut.num_late(), 1u);
}

// The clock of a camera node was an hour ahead, and is set right.
TEST(Pairing, TexturesFromTheFutureDoNotKeepOutTheNewOnes) {
    Pairing sut;
    ASSERT_FALSE(sut.add(naming_mesh(1, {0})));
    ASSERT_TRUE(sut.add(own_texture(1, 0)));
    for (std::uint64_t frame = 0; frame < 100; ++frame)
        EXPECT_FALSE(sut.add(own_texture(100'000 + frame, 0)));
    for (std::uint64_t frame = 2; frame < 50; ++frame) {
        EXPECT_FALSE(sut.add(own_texture(frame, 0)));
        EXPECT_TRUE(sut.add(naming_mesh(frame, {0}))) << frame;
    }
}

// A hull that takes long: its mesh comes many textures later.
TEST(Pairing, TexturesWaitForASlowMesh) {
    Pairing sut;
    ASSERT_FALSE(sut.add(naming_mesh(1, {0})));
    ASSERT_TRUE(sut.add(own_texture(1, 0)));
    for (std::uint64_t frame = 2; frame < 22; ++frame) EXPECT_FALSE(sut.add(own_texture(frame, 0)));
    EXPECT_TRUE(sut.add(naming_mesh(2, {0})));
}

TEST(Pairing, ASiteMayChangeBetweenOneProcessAndSeveralHosts) {
    Pairing sut;
    EXPECT_FALSE(sut.add(naming_mesh(1, {0})));
    EXPECT_TRUE(sut.add(own_texture(1, 0)));
    EXPECT_FALSE(sut.add(mesh("a", 2, {0})));
    EXPECT_TRUE(sut.add(texture("a", 2, 0)));
    EXPECT_FALSE(sut.add(own_texture(3, 0)));
    EXPECT_TRUE(sut.add(naming_mesh(3, {0})));
}

class PairingOfHostsUnderFaults : public testing::TestWithParam<int> {};

TEST_P(PairingOfHostsUnderFaults, NeverMixesOrGoesBackAndStaysBounded) {
    std::mt19937 random(static_cast<unsigned>(GetParam()));
    const auto chance = [&](double p) { return std::bernoulli_distribution(p)(random); };
    using Sample = std::variant<bus::SiteMesh, bus::CameraTexture>;
    std::vector<std::pair<double, Sample>> deliveries;
    std::uniform_real_distribution<> delay(0.0, 2.5);  // frames
    for (std::uint64_t frame = 0; frame < 200; ++frame) {
        std::vector<std::uint32_t> cameras;
        for (std::uint32_t c = 0; c < 6; ++c) {
            if (chance(0.7)) cameras.push_back(c);
            if (chance(0.95))
                deliveries.emplace_back(static_cast<double>(frame) + delay(random),
                                        own_texture(frame, c));
        }
        if (chance(0.95))
            deliveries.emplace_back(static_cast<double>(frame) + delay(random),
                                    naming_mesh(frame, cameras));
    }
    std::ranges::stable_sort(deliveries, {}, [](const auto& d) { return d.first; });
    Pairing sut({.max_pending_frames = 4});
    std::int64_t last_ns = 0;
    std::size_t num_pairs = 0;
    for (auto& [due, sample] : deliveries) {
        const auto pair = std::visit([&](auto& s) { return sut.add(std::move(s)); }, sample);
        ASSERT_LE(sut.num_pending("a"), 4u);
        if (!pair) continue;
        ++num_pairs;
        ASSERT_GT(pair->mesh.capture_time.ns, last_ns);
        last_ns = pair->mesh.capture_time.ns;
        ASSERT_EQ(pair->textures.size(), pair->mesh.textured_cameras.size());
        for (std::size_t i = 0; i < pair->textures.size(); ++i) {
            ASSERT_EQ(pair->textures[i].camera, pair->mesh.textured_cameras[i]);
            ASSERT_EQ(pair->textures[i].frame_id, pair->mesh.texture_frames[i].frame_id);
            ASSERT_EQ(pair->textures[i].capture_time, pair->mesh.texture_frames[i].capture_time);
        }
    }
    EXPECT_GT(num_pairs, 40u);
}
INSTANTIATE_TEST_SUITE_P(Seeds, PairingOfHostsUnderFaults, testing::Range(0, 40));

}  // namespace
}  // namespace atrium::viewer
