#include "site_node/rig_check/rig_watch.hpp"

#include "tests/support/random.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::rig_check {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A person of 1.7 m before eight cameras, in another pose at every look.
Look person(std::uint64_t seed) {
    Look look;
    test::SceneOptions options;
    options.num_views = 6;
    for (const hull::SilhouetteView& view : test::make_scene(options, 1 + seed % 5))
        look.views.push_back({"cam" + std::to_string(look.views.size()), view});
    look.hull_extent = {{-0.3, -0.3, 0.0}, {0.3, 0.3, 1.7}};
    look.hull_volume_m3 = 0.07;
    return look;
}

struct WatchRun {
    RigWatch watch{AgreementOptions{}};
    RigWatch::Clock::time_point now{};
    std::vector<std::string> lines;

    void look(const Look& seen) {
        for (std::string& line : watch.look(seen, now)) lines.push_back(std::move(line));
        now += seconds(1);
    }
};

TEST(RigWatch, IsSilentAboutAGoodSite) {
    WatchRun run;
    for (std::uint64_t i = 0; i < 30; ++i) run.look(person(i));
    EXPECT_THAT(run.lines, IsEmpty());
    EXPECT_EQ(run.watch.num_good_looks(), 30u);
    EXPECT_THAT(run.watch.finish(), IsEmpty());
    EXPECT_THAT(run.watch.summary(), HasSubstr("silhouettes looks=30 explained=0.99 fit=good"));
    EXPECT_EQ(run.watch.standing_reason(), "");
    EXPECT_THAT(run.watch.summary(true), HasSubstr("silhouettes looks=30 explained=0.99 fit=fair"));
}

TEST(RigWatch, IsSilentAboutAnEmptyRoom) {
    WatchRun run;
    Look empty = person(0);
    for (auto& view : empty.views) view.view.contours.clear();
    empty.hull_extent = {};
    for (int i = 0; i < 30; ++i) run.look(empty);
    EXPECT_THAT(run.lines, IsEmpty());
    EXPECT_EQ(run.watch.summary(), "");
}

// A host that computes regions is missing: what is not there says nothing about the rig.
TEST(RigWatch, JudgesNoSizeOfAHullThatIsNotWhole) {
    for (const bool is_whole : {true, false}) {
        WatchRun run;
        for (std::uint64_t i = 0; i < 12; ++i) {
            Look look = person(i);
            look.hull_extent = {};
            look.hull_volume_m3 = 0.0;
            look.is_hull_whole = is_whole;
            run.look(look);
        }
        EXPECT_EQ(run.lines.empty(), !is_whole);
        for (const std::string& line : run.lines) EXPECT_THAT(line, HasSubstr("hull_empty"));
    }
}

TEST(RigWatch, NamesSwappedCamerasOnceAndAgainAfterTenMinutes) {
    WatchRun run;
    const auto swapped = [&](std::uint64_t seed) {
        Look look = person(seed);
        std::swap(look.views[1].view.contours, look.views[2].view.contours);
        return look;
    };
    const std::uint64_t num_looks = test::kSanitized ? 20 : 60;
    for (std::uint64_t i = 0; i < num_looks; ++i) run.look(swapped(i));
    ASSERT_EQ(run.lines.size(), 1u);
    EXPECT_THAT(run.lines.front(), HasSubstr("cam1 and cam2 look swapped"));
    EXPECT_EQ(run.watch.num_good_looks(), 0u);
    run.now += RigWatch::kRepeat;
    for (std::uint64_t i = 0; i < 30; ++i) run.look(swapped(i));
    EXPECT_EQ(run.lines.size(), 2u);
}

TEST(RigWatch, HoldsAFindingUntilItDoesNotComeBack) {
    WatchRun run;
    for (std::uint64_t i = 0; i < 6; ++i) {
        Look look = person(i);
        std::swap(look.views[1].view.contours, look.views[2].view.contours);
        EXPECT_EQ(run.watch.standing_reason().empty(), run.lines.empty());
        EXPECT_EQ(run.watch.is_explained(), i > 0) << "before it is certain";
        run.look(look);
    }
    EXPECT_THAT(run.watch.standing_reason(), HasSubstr("cam1 and cam2 look swapped: exchange"));
    // nobody is there for a while
    Look empty = person(0);
    for (auto& view : empty.views) view.view.contours.clear();
    empty.hull_extent = {};
    for (int i = 0; i < 200; ++i) run.look(empty);
    for (std::size_t i = 0; i < RigWatch::kStandingLooks; ++i) run.look(person(i));
    EXPECT_THAT(run.watch.standing_reason(), HasSubstr("cam1 and cam2 look swapped"));
    EXPECT_TRUE(run.watch.is_explained());
    run.look(person(1));
    EXPECT_EQ(run.watch.standing_reason(), "");
    EXPECT_FALSE(run.watch.is_explained());
}

// Only arms and legs of somebody who turned on the spot while the room was learned.
TEST(RigWatch, NamesTheLearnedRoomFirstWherePeopleWereInIt) {
    for (const bool is_learned : {true, false}) {
        WatchRun run;
        AgreementOptions options;
        options.is_room_learned = is_learned;
        run.watch = RigWatch(options);
        for (std::uint64_t i = 0; i < 8; ++i) {
            Look look = person(i);
            std::mt19937_64 random(i);
            for (auto& [name, view] : look.views) {
                const Eigen::Vector2d shift(test::between(random, -80.0, 80.0),
                                            test::between(random, -80.0, 80.0));
                for (auto& contour : view.contours)
                    for (Eigen::Vector2d& pixel : contour) pixel += shift;
            }
            run.look(look);
        }
        ASSERT_THAT(run.lines, testing::Contains(HasSubstr("cameras_contradict")));
        const auto names = testing::Contains(
            HasSubstr("the empty room was learned from pictures with people in it"));
        if (is_learned) {
            EXPECT_THAT(run.lines, names);
            EXPECT_THAT(run.lines, testing::Contains(HasSubstr("calibrate import --masks")));
        } else {
            EXPECT_THAT(run.lines, testing::Not(names));
        }
    }
}

TEST(RigWatch, NamesACameraThatNeverSeesAnybody) {
    WatchRun run;
    for (std::uint64_t i = 0; i < 30; ++i) {
        Look look = person(i);
        look.views[3].view.contours.clear();
        look.hull_extent = {};
        run.look(look);
    }
    EXPECT_THAT(run.lines, ElementsAre(HasSubstr("camera_sees_nobody camera=cam3")));
    EXPECT_THAT(run.watch.summary(), HasSubstr("without_anybody=\"cam3\""));
}

TEST(RigWatch, FindsAHullOfAnotherUnit) {
    for (const double factor : {1000.0, 100.0, 1.0 / 0.3048}) {
        WatchRun run;
        for (std::uint64_t i = 0; i < 5; ++i) {
            Look look = person(i);
            look.hull_extent.min *= factor;
            look.hull_extent.max *= factor;
            look.hull_volume_m3 *= factor * factor * factor;
            run.look(look);
        }
        EXPECT_THAT(run.lines, ElementsAre(HasSubstr("hull_size_implausible"))) << factor;
    }
}

// A person in miniature: lengths in squares of 40 mm were taken for centimetres.
Look small_person(std::uint64_t seed) {
    Look look = person(seed);
    look.hull_extent = {{-0.08, -0.08, 0.0}, {0.08, 0.08, 0.44}};
    look.hull_volume_m3 = 0.0011;
    return look;
}

TEST(RigWatch, DoubtsAScaleInWhichEveryHullIsSmall) {
    WatchRun run;
    for (std::uint64_t i = 0; i < 9; ++i) run.look(small_person(i));
    EXPECT_THAT(run.lines, IsEmpty());
    for (std::uint64_t i = 0; i < 9; ++i) run.look(small_person(i));
    ASSERT_EQ(run.lines.size(), 1u);
    EXPECT_THAT(run.lines.front(), HasSubstr("hull_size_implausible"));
    EXPECT_THAT(run.lines.front(), HasSubstr("--distance CAMERA CAMERA METRES"));
}

TEST(RigWatch, IsSilentAboutASmallThingWherePeopleWereSeenOrDoNotFit) {
    WatchRun room;
    for (std::uint64_t i = 0; i < 5; ++i) room.look(small_person(i));
    room.look(person(5));
    for (std::uint64_t i = 0; i < 20; ++i) room.look(small_person(i));
    EXPECT_THAT(room.lines, IsEmpty());
    EXPECT_THAT(room.watch.finish(), IsEmpty());
    // as deploy/rigs/table.toml
    WatchRun table;
    AgreementOptions options;
    options.bounds = geometry::Aabb{{-2.0, -2.0, 0.5}, {2.0, 2.0, 1.8}};
    table.watch = RigWatch(options);
    for (std::uint64_t i = 0; i < 20; ++i) table.look(small_person(i));
    EXPECT_THAT(table.lines, testing::Not(testing::Contains(HasSubstr("hull_size_implausible"))));
}

Look person_of(double height_m, std::uint64_t seed) {
    Look look = person(seed);
    look.footing = Footing{{0.1, 0.2, 0.0}, height_m};
    return look;
}

TEST(RigWatch, DoubtsAScaleInWhichPeopleAreAlwaysTall) {
    for (const double height_m : {2.6, 2.9, 3.3}) {
        WatchRun run;
        for (std::uint64_t i = 0; i < 10; ++i) run.look(person_of(height_m, i));
        EXPECT_THAT(run.lines, IsEmpty());
        for (std::uint64_t i = 0; i < 10; ++i) run.look(person_of(height_m, i));
        ASSERT_EQ(run.lines.size(), 1u);
        EXPECT_THAT(run.lines.front(), HasSubstr("hull_size_implausible"));
        EXPECT_THAT(run.lines.front(), HasSubstr("squares of a chessboard"));
        EXPECT_THAT(run.watch.summary(),
                    HasSubstr(" height_m=" + std::to_string(height_m).substr(0, 4)));
    }
    // a short recording says it at its end
    WatchRun brief;
    for (std::uint64_t i = 0; i < 5; ++i) brief.look(person_of(2.9, i));
    EXPECT_THAT(brief.lines, IsEmpty());
    EXPECT_THAT(brief.watch.finish(), ElementsAre(HasSubstr("people are 2.90 m tall")));
}

TEST(RigWatch, IsSilentAboutPeopleWhoRaiseTheirArms) {
    WatchRun run;
    // 1.95 m; arms up, or a jump, at two of five looks
    for (std::uint64_t i = 0; i < 40; ++i) run.look(person_of(i % 5 < 2 ? 2.65 : 1.95, i));
    EXPECT_THAT(run.lines, IsEmpty());
    EXPECT_THAT(run.watch.finish(), IsEmpty());
    EXPECT_THAT(run.watch.summary(), HasSubstr(" height_m=1.95"));
}

TEST(RigWatch, SaysOnceThatNobodyIsAsTallAsAnAdult) {
    WatchRun run;
    for (std::uint64_t i = 0; i < 11; ++i) run.look(person_of(0.96, i));
    EXPECT_THAT(run.lines, IsEmpty());
    for (std::uint64_t i = 0; i < 10; ++i) run.look(person_of(0.96, i));
    ASSERT_THAT(run.lines, ElementsAre(HasSubstr("people_are_small height_m=0.96")));
    EXPECT_THAT(run.lines.front(), HasSubstr("children"));
    EXPECT_THAT(run.lines.front(), HasSubstr("by a factor of about 1.8"));
    EXPECT_EQ(run.watch.last_reason(), "");  // no reason for an empty hull
    run.now += RigWatch::kRepeat;
    for (std::uint64_t i = 0; i < 30; ++i) run.look(person_of(0.96, i));
    EXPECT_EQ(run.lines.size(), 1u);
    EXPECT_GE(run.watch.num_good_looks(), 30u);
    EXPECT_THAT(run.watch.finish(), IsEmpty());

    WatchRun brief;
    for (std::uint64_t i = 0; i < 5; ++i) brief.look(person_of(0.96, i));
    EXPECT_THAT(brief.watch.finish(), ElementsAre(HasSubstr("people_are_small")));
}

TEST(RigWatch, IsSilentAboutPeopleWhoSitMostOfTheTime) {
    WatchRun run;
    for (std::uint64_t i = 0; i < 40; ++i) run.look(person_of(i % 5 == 4 ? 1.7 : 0.9, i));
    EXPECT_THAT(run.lines, IsEmpty());
    EXPECT_THAT(run.watch.finish(), IsEmpty());
}

TEST(RigWatch, IsSilentAboutSmallPeopleWhomPicturesOrBoundsCut) {
    WatchRun pictures;
    AgreementOptions options;
    options.bounds = geometry::Aabb{{-2.0, -2.0, 0.0}, {2.0, 2.0, 1.0}};
    WatchRun bounds;
    bounds.watch = RigWatch(options);
    for (std::uint64_t i = 0; i < 20; ++i) {
        bounds.look(person_of(0.96, i));
        Look look = person_of(0.96, i);
        look.views[2].view.intrinsics.height = 100;  // ends far above the feet
        pictures.look(look);
    }
    const auto says_small = testing::Contains(HasSubstr("people_are_small"));
    EXPECT_THAT(pictures.lines, testing::Not(says_small));
    EXPECT_THAT(pictures.watch.finish(), testing::Not(says_small));
    EXPECT_THAT(bounds.lines, testing::Not(says_small));
    EXPECT_THAT(bounds.watch.finish(), testing::Not(says_small));
}

TEST(RigWatch, TellsOfBoundsThatCutPeople) {
    WatchRun run;
    AgreementOptions options;
    options.bounds = geometry::Aabb{{-2.0, -2.0, 0.25}, {2.0, 2.0, 2.4}};
    run.watch = RigWatch(options);
    for (std::uint64_t i = 0; i < 30; ++i) run.look(person(i));
    EXPECT_THAT(run.lines, ElementsAre(HasSubstr("bounds_cut_people")));
    EXPECT_THAT(run.lines.front(), HasSubstr("where the bounds end at 0.25 m"));
    EXPECT_THAT(run.lines.front(), testing::Not(HasSubstr("--camera-height")));
}

TEST(RigWatch, DoubtsTheFloorIfBoundsCutPeopleThere) {
    WatchRun run;
    AgreementOptions options;
    options.bounds = geometry::Aabb{{-2.0, -2.0, 0.0}, {2.0, 2.0, 2.4}};
    run.watch = RigWatch(options);
    for (std::uint64_t i = 0; i < 30; ++i) {
        Look look = person(i);
        for (auto& [name, view] : look.views)
            view.camera_from_site.translation +=
                view.camera_from_site.rotation * Eigen::Vector3d(0.0, 0.0, 0.4);
        run.look(look);
    }
    EXPECT_THAT(run.lines, ElementsAre(HasSubstr("bounds_cut_people")));
    EXPECT_THAT(run.lines.front(), HasSubstr("--camera-height CAMERA METRES"));
}

Look person_with_feet(std::uint64_t seed, double feet_m) {
    Look look = person(seed);
    look.footing = Footing{{0.0, 0.0, feet_m}, 1.7};
    return look;
}

TEST(RigWatch, FindsAFloorAboveOrBelowTheFeetOnce) {
    for (const double feet_m : {-0.74, 0.4}) {
        WatchRun run;
        for (std::uint64_t i = 0; i < 9; ++i) run.look(person_with_feet(i, feet_m));
        EXPECT_THAT(run.lines, IsEmpty());
        EXPECT_THAT(run.watch.finish(), IsEmpty());
        for (std::uint64_t i = 0; i < 9; ++i) run.look(person_with_feet(i, feet_m));
        ASSERT_EQ(run.lines.size(), 1u);
        EXPECT_THAT(run.lines.front(), HasSubstr("feet_off_floor"));
        EXPECT_THAT(run.lines.front(), HasSubstr("--camera-height cam0 METRES"));
    }
    WatchRun good;
    for (std::uint64_t i = 0; i < 20; ++i) good.look(person_with_feet(i, 0.02));
    EXPECT_THAT(good.lines, IsEmpty());
}

TEST(RigWatch, IsSilentAboutFeetThatBoundsOrPicturesMayCut) {
    for (const double lowest_m : {-0.5, 0.5}) {
        WatchRun run;
        AgreementOptions options;
        options.bounds = geometry::Aabb{{-2.0, -2.0, lowest_m}, {2.0, 2.0, 2.4}};
        run.watch = RigWatch(options);
        for (std::uint64_t i = 0; i < 20; ++i) run.look(person_with_feet(i, lowest_m + 0.02));
        EXPECT_THAT(run.lines, testing::Not(testing::Contains(HasSubstr("feet_off_floor"))));
    }
    WatchRun run;
    for (std::uint64_t i = 0; i < 20; ++i) {
        Look look = person_with_feet(i, 0.5);
        look.views[2].view.intrinsics.height = 100;  // ends far above the feet
        run.look(look);
    }
    EXPECT_THAT(run.lines, testing::Not(testing::Contains(HasSubstr("feet_off_floor"))));
}

TEST(RigWatch, ReportsAtTheEndOfAShortRun) {
    WatchRun run;
    Look look = person(0);
    std::swap(look.views[0].view.contours, look.views[3].view.contours);
    run.look(look);
    EXPECT_THAT(run.lines, IsEmpty());
    EXPECT_THAT(run.watch.finish(), ElementsAre(HasSubstr("look swapped")));
}

}  // namespace
}  // namespace atrium::rig_check
