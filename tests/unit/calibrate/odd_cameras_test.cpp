// Rigs put together from files of several programs: units mixed, poses written in several ways.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kTurn_rad = 6.283185307179586;

// Cameras all around that look at about (0, 0, 1), in a frame moved by `origin`.
test::Cameras ring_around(atrium::test::Random& random,
                          int num_cameras,
                          const Eigen::Vector3d& origin) {
    test::Cameras cameras = test::random_room(random, num_cameras);
    for (int i = 0; i < num_cameras; ++i) {
        const double angle =
            kTurn_rad * (i + atrium::test::between(random, -0.2, 0.2)) / num_cameras;
        const double radius = atrium::test::between(random, 2.0, 4.0);
        const Eigen::Vector3d eye(radius * std::cos(angle),
                                  radius * std::sin(angle),
                                  atrium::test::between(random, 0.8, 2.6));
        const Eigen::Vector3d target =
            Eigen::Vector3d(0, 0, 1.0) + atrium::test::random_in_cube(random, 0.2);
        const Eigen::Matrix3d r = test::level_rotation(eye, target);
        cameras[static_cast<std::size_t>(i)].camera_from_site = {Eigen::Quaterniond(r),
                                                                 -(r * (eye + origin))};
    }
    return cameras;
}

struct Room {
    explicit Room(int seed) : random(static_cast<std::uint64_t>(seed)) {
        // the origin is in its middle or beside it
        const Eigen::Vector3d corner(1.0, 1.0, 0.0);
        const Eigen::Vector3d origin =
            seed % 2 == 0 ? Eigen::Vector3d::Zero().eval()
                          : atrium::test::between(random, corner, Eigen::Vector3d(3.0, 3.0, 0.1));
        cameras = ring_around(random, atrium::test::between(random, 5, 9), origin);
    }
    std::size_t chosen() {
        return static_cast<std::size_t>(
            atrium::test::between(random, 0, static_cast<int>(cameras.size()) - 1));
    }

    atrium::test::Random random;
    test::Cameras cameras;
};

class OddCameras : public testing::Test {
protected:
    Conclusion conclusion_of(const test::Cameras& cameras, double units_per_m) const {
        const auto foreign =
            read_foreign({folder_.write("a.yml", test::opencv_yaml(cameras, units_per_m))}, "auto");
        if (!foreign) return failed(foreign.error().message);
        const auto result = conclude(*foreign, {});
        return result ? *result : failed(result.error().message);
    }
    static Conclusion failed(const std::string& message) {
        ADD_FAILURE() << message;
        return {};
    }

    static constexpr int kNumRooms = 60;
    test::Folder folder_;
};

// One or two cameras in another unit: the rig must be that of equal units, and the cameras named.
TEST_F(OddCameras, OfAnotherUnitAreConverted) {
    struct Mix {
        double units_per_m;
        double factor;
        int at_least;
    };
    // mm and cm among m, m among mm, cm among mm: ten times is within what rooms may have
    for (const Mix& mix :
         {Mix{1.0, 1000.0, 59}, {1.0, 100.0, 59}, {1000.0, 0.001, 59}, {1000.0, 0.1, 50}}) {
        int num_mended = 0;
        for (int seed = 1; seed <= kNumRooms; ++seed) {
            Room room(seed);
            const Conclusion whole = conclusion_of(room.cameras, mix.units_per_m);
            EXPECT_THAT(whole.problems, IsEmpty()) << seed;
            EXPECT_THAT(whole.checks, Not(Contains(HasSubstr("another unit")))) << seed;
            std::vector<std::string> names;
            test::Cameras mixed = room.cameras;
            for (int i = 0; i <= seed % 2; ++i) {
                auto& camera = mixed[room.chosen()];
                if (names == std::vector{camera.name}) continue;
                camera.camera_from_site.translation *= mix.factor;
                names.push_back(camera.name);
            }
            std::ranges::sort(names);
            const Conclusion result = conclusion_of(mixed, mix.units_per_m);
            if (test::difference(result.rig.cameras, whole.rig.cameras) > 1e-5) continue;
            ++num_mended;
            EXPECT_THAT(result.problems, IsEmpty()) << seed;
            EXPECT_THAT(result.checks,
                        Contains(HasSubstr(fmt::format(
                            "lengths: those of camera{} '{}' are in another unit than the others'",
                            names.size() > 1 ? "s" : "",
                            fmt::join(names, "' and '")))))
                << seed;
        }
        EXPECT_GE(num_mended, mix.at_least) << mix.factor;
    }
}

TEST_F(OddCameras, OfAnotherWayToWritePosesAreNamed) {
    int num_named = 0;
    for (int seed = 1; seed <= kNumRooms; ++seed) {
        Room room(seed);
        auto& odd = room.cameras[room.chosen()];
        odd.camera_from_site = odd.camera_from_site.inverse();
        const Conclusion result = conclusion_of(room.cameras, 1000.0);
        if (result.problems.empty()) continue;  // some look at the room in both ways
        ++num_named;
        EXPECT_THAT(result.problems,
                    ElementsAre(AllOf(HasSubstr("camera '" + odd.name + "'"),
                                      HasSubstr("it would if its pose were site_from_camera"))))
            << seed;
    }
    EXPECT_GE(num_named, kNumRooms * 3 / 4);
}

TEST_F(OddCameras, AMovedOneIsNoOtherUnit) {
    for (int seed = 1; seed <= kNumRooms; ++seed) {
        Room room(seed);
        auto& pose = room.cameras[room.chosen()].camera_from_site;
        const Eigen::AngleAxisd turn(atrium::test::between(room.random, 0.9, 3.1),
                                     atrium::test::random_direction(room.random));
        pose = geometry::RigidTransform{Eigen::Quaterniond(turn),
                                        atrium::test::random_in_cube(room.random, 1.0)} *
               pose;
        const Conclusion result = conclusion_of(room.cameras, 1000.0);
        EXPECT_THAT(result.checks, Not(Contains(HasSubstr("another unit")))) << seed;
    }
}

// Coordinates of a surveyor, or of a whole hall.
TEST_F(OddCameras, AllOfThemFarFromTheOriginMoveIt) {
    for (int seed = 2; seed <= 20; seed += 2) {
        Room room(seed);
        const Conclusion near = conclusion_of(room.cameras, 1.0);
        EXPECT_THAT(near.checks, Not(Contains(HasSubstr("origin:")))) << seed;
        for (const Eigen::Vector3d& origin : {Eigen::Vector3d(1000.0, 2000.0, 0.0),
                                              Eigen::Vector3d(-40.0, 3.0, 0.0),
                                              Eigen::Vector3d(1000.0, 2000.0, 112.0)}) {
            test::Cameras cameras = room.cameras;
            for (auto& camera : cameras) {
                auto& pose = camera.camera_from_site;
                pose.translation -= pose.rotation * origin;
            }
            const Conclusion far = conclusion_of(cameras, 1.0);
            EXPECT_THAT(far.problems, IsEmpty()) << seed;
            EXPECT_THAT(
                far.checks,
                Contains(HasSubstr("too far for a world, so it was moved below that place")))
                << seed;
            Eigen::Vector3d off = Eigen::Vector3d::Zero();
            for (std::size_t i = 0; i < cameras.size(); ++i)
                off += (far.rig.cameras[i].centre_site() - near.rig.cameras[i].centre_site()) /
                       static_cast<double>(cameras.size());
            EXPECT_LT(off.head<2>().norm(), 1.0) << seed;
            // the floor of the file stays, or is a metre below what the cameras look at
            EXPECT_LT(std::abs(off.z()), origin.z() == 0.0 ? 1e-6 : 0.5) << seed;
        }
    }
}

TEST_F(OddCameras, AllOfThemWithAWrongPitchAreDoubted) {
    int num_doubted = 0;
    for (int seed = 1; seed <= kNumRooms; ++seed) {
        Room room(seed);
        EXPECT_THAT(conclusion_of(room.cameras, 1.0).checks,
                    Not(Contains(HasSubstr("optical axes pass"))))
            << seed;
        for (auto& camera : room.cameras) {
            auto& pose = camera.camera_from_site;
            const Eigen::Vector3d centre = camera.centre_site();
            const Eigen::Vector3d ahead = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
            // as if it were pitched the other way, and further: by 20 degrees up
            const double pitch_rad = 2.0 * std::asin(ahead.z()) - 0.35;
            pose.rotation = Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()) * pose.rotation;
            pose.translation = -(pose.rotation * centre);
        }
        const Conclusion turned = conclusion_of(room.cameras, 1.0);
        if (std::ranges::any_of(turned.checks, [](const std::string& text) {
                return text.find("may have the wrong sign, such as the pitch") != text.npos;
            }))
            ++num_doubted;
        else
            EXPECT_TRUE(!turned.problems.empty() || !turned.checks.empty()) << seed;
    }
    EXPECT_GE(num_doubted, 10) << "rooms in which cameras hang at several heights";
}

}  // namespace
}  // namespace atrium::calibrate
