#include "world_server/physics/people/person_shape.hpp"

#include "tests/support/world/physics_meshes.hpp"
#include "ticks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace atrium::physics {
namespace {

using physics_test::make_box_mesh;

Timestamp frame_time(int frame) {
    return Timestamp{1'000'000'000} + std::chrono::nanoseconds(frame * 33'333'333LL);
}

geometry::TriangleMesh slab_at(const Eigen::Vector3d& position, int num_cuts) {
    return make_box_mesh({0.04, 0.10, 0.18}, {Eigen::Quaterniond::Identity(), position}, num_cuts);
}

TEST(SurfaceIndex, FindsTheNearestWithEqualFacingWithAndWithoutAvx2) {
    geometry::TriangleMesh mesh = slab_at({0.0, 0.0, 1.0}, 3);
    geometry::append(mesh, slab_at({0.06, 0.3, 1.1}, 4));
    const SurfaceIndex index(mesh, {});
    SurfaceIndex plain;
    plain.forbid_avx2();
    plain.assign(mesh, {});
    const auto samples = index.samples();
    ASSERT_EQ(plain.samples().size(), samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_EQ(plain.samples()[i].position, samples[i].position);
        EXPECT_EQ(plain.samples()[i].normal, samples[i].normal);
    }
    std::mt19937 random(7);
    std::uniform_real_distribution<float> offset_m(-0.2F, 0.5F);
    std::size_t num_found = 0;
    // the number of places is no multiple of the batch size
    std::vector<SurfaceSample> places(27);
    std::vector<std::uint32_t> found(places.size());
    std::vector<std::uint32_t> found_plain(places.size());
    for (int round = 0; round < 800; ++round) {
        const float radius_m = round % 2 == 0 ? 0.05F : 0.3F;
        for (SurfaceSample& place : places) {
            place.position = {offset_m(random), offset_m(random), 0.9F + offset_m(random)};
            place.normal =
                Eigen::Vector3f(offset_m(random), offset_m(random), offset_m(random)).normalized();
        }
        index.nearest(places, radius_m, 0.6F, found);
        plain.nearest(places, radius_m, 0.6F, found_plain);
        ASSERT_EQ(found, found_plain);
        for (std::size_t i = 0; i < places.size(); ++i) {
            float least_sq = radius_m * radius_m;
            std::uint32_t expected = SurfaceIndex::kNone;
            for (std::uint32_t s = 0; s < samples.size(); ++s) {
                const float distance_sq = (samples[s].position - places[i].position).squaredNorm();
                if (!(distance_sq < least_sq) || !(samples[s].normal.dot(places[i].normal) > 0.6F))
                    continue;
                least_sq = distance_sq;
                expected = s;
            }
            ASSERT_EQ(found[i] == SurfaceIndex::kNone, expected == SurfaceIndex::kNone);
            if (found[i] == SurfaceIndex::kNone) continue;
            ++num_found;
            const SurfaceSample& sample = samples[found[i]];
            EXPECT_FLOAT_EQ((sample.position - places[i].position).norm(), std::sqrt(least_sq));
            EXPECT_GT(sample.normal.dot(places[i].normal), 0.59F);
        }
    }
    EXPECT_GT(num_found, 1000U);
}

TEST(SurfaceIndex, FindsNothingAtFarOrNonFinitePlaces) {
    const SurfaceIndex index(slab_at({0.0, 0.0, 1.0}, 3), {});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    const Eigen::Vector3f up(0.0F, 0.0F, 1.0F);
    const std::vector<SurfaceSample> places{{{nan, 0.0F, 1.0F}, up},
                                            {{0.0F, infinite, 1.0F}, up},
                                            {{0.0F, 0.0F, -3e38F}, up},
                                            {{0.0F, 0.0F, 1e12F}, up}};
    std::vector<std::uint32_t> found(places.size(), 0);
    index.nearest(places, 0.3F, 0.6F, found);
    EXPECT_EQ(found, std::vector<std::uint32_t>(places.size(), SurfaceIndex::kNone));
}

TEST(PersonShaper, MeasuresTheVelocityOfASlabAlongItsNormal) {
    for (const double speed_mps : {1.0, 2.0, 4.0, 6.0}) {
        PersonShaper shaper({});
        shaper.shape(slab_at({0.0, 0.0, 1.0}, 3), frame_time(0));
        const PersonShape shape =
            shaper.shape(slab_at({speed_mps * kMeshPeriodS, 0.0, 1.0}, 4), frame_time(1));
        ASSERT_FALSE(shape.surfels->empty());
        for (const MovingSurfel& surfel : *shape.surfels) {
            const Eigen::Vector3f& v = surfel.velocity;
            EXPECT_NEAR(v.x(), speed_mps, 0.08 * speed_mps);
            EXPECT_NEAR(v.y(), 0.0, 0.1 * speed_mps);
            EXPECT_NEAR(v.z(), 0.0, 0.1 * speed_mps);
        }
    }
}

TEST(PersonShaper, GivesEachPartItsOwnVelocity) {
    const auto figure = [](double offset) {
        geometry::TriangleMesh mesh = slab_at({0.0, 0.0, 1.0}, 3);
        geometry::append(mesh, slab_at({offset, 1.0, 1.0}, 3));
        return mesh;
    };
    PersonShaper shaper({});
    shaper.shape(figure(0.0), frame_time(0));
    const PersonShape shape = shaper.shape(figure(2.0 * kMeshPeriodS), frame_time(1));
    for (const MovingSurfel& surfel : *shape.surfels) {
        const double expected = surfel.position.y() > 0.5F ? 2.0 : 0.0;
        EXPECT_NEAR(surfel.velocity.x(), expected, 0.2);
    }
}

TEST(PersonShaper, TreatsFlickerOfAStillOutlineAsRest) {
    std::mt19937 random(5);
    std::normal_distribution<double> noise_m(0.0, 0.002);  // about half a pixel at 2 m
    PersonShaper shaper({});
    PersonShape shape;
    for (int frame = 0; frame < 5; ++frame) {
        geometry::TriangleMesh mesh = physics_test::make_person_mesh({0, 0, 0}, 0.5, 8 + frame);
        for (Eigen::Vector3d& v : mesh.vertices) {
            v += Eigen::Vector3d(noise_m(random), noise_m(random), noise_m(random));
        }
        shape = shaper.shape(mesh, frame_time(frame));
    }
    double sum = 0.0;
    for (const MovingSurfel& surfel : *shape.surfels) sum += surfel.velocity.norm();
    EXPECT_LT(sum / static_cast<double>(shape.surfels->size()), 0.03);
}

TEST(PersonShaper, NeverExceedsItsSpeedLimit) {
    const PersonShapeOptions options{.max_speed_mps = 3.0};
    PersonShaper shaper(options);
    shaper.shape(slab_at({0.0, 0.0, 1.0}, 3), frame_time(0));
    const PersonShape shape = shaper.shape(slab_at({0.09, 0.09, 1.0}, 3), frame_time(1));
    for (const MovingSurfel& surfel : *shape.surfels) {
        EXPECT_LE(surfel.velocity.norm(), 3.0F * 1.0001F);
    }
}

// Specks of surface appear and disappear where cameras see little. Another speck is always near.
TEST(PersonShaper, DoesNotMistakeANewSpeckForAMovedOne) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> extent_m(0.02, 0.05);
    std::uniform_real_distribution<double> way_m(-0.3, 0.3);
    const auto triple = [&](auto& distribution) {
        return Eigen::Vector3d(distribution(random), distribution(random), distribution(random));
    };
    const Eigen::Vector3d before(-0.5, 0.1, 1.3);
    int num_specks = 0;
    int num_flying = 0;
    while (num_specks < 100) {
        const Eigen::Vector3d now = before + triple(way_m);
        const auto figure = [&](const Eigen::Vector3d& speck, int num_cuts) {
            geometry::TriangleMesh mesh = physics_test::make_person_mesh({0, 0, 0}, 0.5, num_cuts);
            geometry::append(
                mesh, make_box_mesh(triple(extent_m), {Eigen::Quaterniond::Identity(), speck}, 3));
            return mesh;
        };
        if ((now - before).norm() < 0.2) continue;
        PersonShaper shaper({});
        shaper.shape(figure(before, 10), frame_time(0));
        const PersonShape shape = shaper.shape(figure(now, 11), frame_time(1));
        ++num_specks;
        num_flying += std::any_of(shape.surfels->begin(),
                                  shape.surfels->end(),
                                  [](const MovingSurfel& s) { return s.velocity.norm() > 3.0F; })
                          ? 1
                          : 0;
    }
    EXPECT_LE(num_flying, 5) << "of " << num_specks;
}

TEST(PersonShaper, GivesNoVelocityWithoutAUsablePreviousMesh) {
    PersonShaper shaper({});
    EXPECT_EQ(shaper.shape(slab_at({0, 0, 1}, 2), frame_time(0)).period_s, 0.0);
    EXPECT_GT(shaper.shape(slab_at({0, 0, 1}, 2), frame_time(1)).period_s, 0.0);
    EXPECT_EQ(shaper.shape(slab_at({0, 0, 1}, 2), frame_time(1)).period_s, 0.0) << "same time";
    EXPECT_EQ(shaper.shape(slab_at({0, 0, 1}, 2), frame_time(0)).period_s, 0.0) << "earlier";
    EXPECT_EQ(shaper.shape(slab_at({0, 0, 1}, 2), frame_time(60)).period_s, 0.0) << "long after";
    shaper.forget();
    EXPECT_EQ(shaper.shape(slab_at({0, 0, 1}, 2), frame_time(61)).period_s, 0.0) << "forgotten";
}

TEST(PersonShaper, AcceptsAnEmptyMesh) {
    PersonShaper shaper({});
    EXPECT_TRUE(shaper.shape({}, frame_time(0)).surfels->empty());
    EXPECT_FALSE(shaper.shape(slab_at({0, 0, 1}, 2), frame_time(1)).surfels->empty());
}

}  // namespace
}  // namespace atrium::physics
