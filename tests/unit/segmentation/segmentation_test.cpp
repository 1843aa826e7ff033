#include "site_node/segmentation/segmentation.hpp"

#include "tests/support/shapes/whole_mask.hpp"
#include "tests/unit/segmentation/test_room.hpp"

#include <gmock/gmock.h>

namespace atrium::segmentation {
namespace {

using namespace test;
using testing::HasSubstr;

image::Mask segmented(const image::YuvImage& frame, const BackgroundStatistics& learned) {
    Segmenter segmenter(learned, {});
    image::Mask mask;
    EXPECT_TRUE(segmenter.segment(frame, mask).has_value());
    return mask;
}

TEST(BackgroundLearner, NamesTheReasonWhyItCannotLearn) {
    BackgroundLearner learner;
    EXPECT_THAT(learner.finish().error().message, HasSubstr("no picture"));
    image::YuvImage odd = plain(8, 8, {1, 2, 3});
    odd.u = image::Plane(3, 4);
    EXPECT_THAT(learner.add(odd).error().message, HasSubstr("4:2:0"));
    EXPECT_THAT(learner.add(image::YuvImage{}).error().message, HasSubstr("4:2:0"));
    ASSERT_TRUE(learner.add(plain(8, 8, {1, 2, 3})).has_value());
    EXPECT_THAT(learner.add(plain(8, 10, {1, 2, 3})).error().message, HasSubstr("8x8, then 8x10"));
    EXPECT_EQ(learner.num_frames(), 1);
}

TEST(Segmentation, RejectsAFrameOfAnotherSize) {
    std::mt19937 random(1);
    const BackgroundStatistics model = learn(room(240, 160), 2, random);
    Segmenter segmenter(model, {});
    image::Mask mask;
    const auto result = segmenter.segment(room(160, 160), mask);
    ASSERT_FALSE(result.has_value());
    EXPECT_THAT(result.error().message, HasSubstr("160x160"));
}

TEST(Segmentation, EmptyRoomIsEmptyAfterOneFrameAndMany) {
    for (const int num_frames : {1, 30}) {
        std::mt19937 random(2);
        const image::YuvImage scene = room(240, 160);
        const BackgroundStatistics model = learn(scene, num_frames, random);
        for (int i = 0; i < 5; ++i) {
            image::YuvImage frame = scene;
            add_noise(frame, 2.0, 1.0, random);
            EXPECT_EQ(foreground_part(segmented(frame, model), kWhole), 0.0)
                << num_frames << " frames";
        }
    }
}

TEST(Segmentation, ShadowsAndHighlightsAreBackground) {
    std::mt19937 random(3);
    const image::YuvImage scene = room(240, 160);
    const BackgroundStatistics model = learn(scene, 20, random);
    for (const double light : {0.65, 0.75, 0.9, 1.08}) {
        image::YuvImage frame = scene;
        scale_light(frame, kPatch, light);
        add_noise(frame, 2.0, 1.0, random);
        EXPECT_EQ(foreground_part(segmented(frame, model), kWhole), 0.0) << "light " << light;
    }
}

TEST(Segmentation, SlightlyDarkerRoomStaysEmpty) {
    std::mt19937 random(4);
    const image::YuvImage scene = room(240, 160);
    const BackgroundStatistics model = learn(scene, 20, random);
    image::YuvImage frame = scene;
    scale_light(frame, kWhole, 0.85);
    add_noise(frame, 2.0, 1.0, random);
    EXPECT_EQ(foreground_part(segmented(frame, model), kWhole), 0.0);
}

TEST(Segmentation, FindsObjectsOfOtherHueOrTooDarkOrTooBright) {
    std::mt19937 random(5);
    const image::YuvImage scene = room(240, 160);
    const BackgroundStatistics model = learn(scene, 20, random);
    // same luma, other hue
    image::YuvImage hue = scene;
    for (int y = kPatch.y / 2; y < (kPatch.y + kPatch.height) / 2; ++y) {
        for (int x = kPatch.x / 2; x < (kPatch.x + kPatch.width) / 2; ++x) hue.v.row(y)[x] += 40;
    }
    image::YuvImage dark = scene;
    scale_light(dark, kPatch, 0.35);
    image::YuvImage bright = scene;
    scale_light(bright, kPatch, 1.5);
    for (image::YuvImage* frame : {&hue, &dark, &bright}) {
        add_noise(*frame, 2.0, 1.0, random);
        const image::Mask mask = segmented(*frame, model);
        EXPECT_EQ(foreground_part(mask, kPatchCore), 1.0);
        const double all = foreground_part(mask, kWhole) * kWhole.width * kWhole.height;
        EXPECT_NEAR(all,
                    kPatch.width * kPatch.height,
                    40.0);  // the majority rounds corners, plus some noise
    }
}

TEST(Segmentation, ClippedAndBlackSurfacesDoNotFlicker) {
    std::mt19937 random(6);
    for (const Colour colour : {Colour{255, 128, 128}, Colour{4, 128, 128}, Colour{12, 126, 131}}) {
        const image::YuvImage scene = plain(240, 160, colour);
        const BackgroundStatistics model = learn(scene, 1, random);
        image::YuvImage frame = scene;
        add_noise(frame, 2.5, 2.0, random);
        EXPECT_EQ(foreground_part(segmented(frame, model), kWhole), 0.0) << colour.y;
        for (int y = kPatch.y; y < kPatch.y + kPatch.height; ++y)
            std::fill_n(frame.y.row(y) + kPatch.x, kPatch.width, 120);
        EXPECT_EQ(foreground_part(segmented(frame, model), kPatchCore), 1.0) << colour.y;
    }
}

// The samples of a mosaic take the place of luma in other formats.
TEST(Segmentation, DoesNotCompareAMosaicWithColourPictures) {
    const image::YuvImage scene = plain(64, 48, {100, 120, 130});
    BackgroundLearner learner;
    image::YuvView mosaic(scene);
    mosaic.mosaic = image::Mosaic::kRG;
    ASSERT_TRUE(learner.add(mosaic).has_value());
    EXPECT_THAT(learner.add(scene).error().message, HasSubstr("mosaic"));
    Segmenter segmenter(learner.finish().value(), {});
    image::Mask mask;
    EXPECT_TRUE(segmenter.segment(mosaic, mask).has_value());
    EXPECT_THAT(segmenter.segment(scene, mask).error().message, HasSubstr("mosaic"));
}

// A green floor in deep shadow and a black object on it are equally dark, but differ in hue. On a
// grey wall the hue does not differ, so the luma limit stays there.
TEST(Segmentation, DeepShadowsAreBackgroundOnlyIfTheHueMatches) {
    std::mt19937 random(8);
    for (const bool coloured : {true, false}) {
        const image::YuvImage scene =
            plain(240, 160, coloured ? Colour{110, 80, 70} : Colour{110, 127, 129});
        const auto learned = learn(scene, 20, random);
        image::YuvImage shadow = scene;
        scale_light(shadow, kPatch, 0.5);
        image::YuvImage thing = scene;
        scale_light(thing, kPatch, 0.5);
        for (image::Plane* plane : {&thing.u, &thing.v}) {
            for (int y = kPatch.y / 2; y < (kPatch.y + kPatch.height) / 2; ++y)
                std::fill_n(plane->row(y) + kPatch.x / 2, kPatch.width / 2, 128);
        }
        add_noise(shadow, 2.0, 1.0, random);
        add_noise(thing, 2.0, 1.0, random);
        EXPECT_EQ(foreground_part(segmented(shadow, learned), kPatchCore), coloured ? 0.0 : 1.0);
        EXPECT_EQ(foreground_part(segmented(thing, learned), kPatchCore), 1.0);
    }
}

// The colour of a clipped sample is wrong, and a dark sample has none.
TEST(Segmentation, IgnoresColoursOfClippedAndDarkPixels) {
    std::mt19937 random(9);
    const image::YuvImage bright = plain(240, 160, {238, 128, 128});
    image::YuvImage clipped = bright;
    for (int y = 0; y < 160; ++y) std::fill_n(clipped.y.row(y), 240, 252);
    for (std::uint8_t& v : clipped.v.data) v = 150;
    EXPECT_EQ(foreground_part(segmented(clipped, learn(bright, 20, random, 1.0)), kWhole), 0.0);

    const image::YuvImage dark = plain(240, 160, {14, 128, 128});
    image::YuvImage tinted = dark;
    for (std::uint8_t& v : tinted.v.data) v = 160;
    EXPECT_EQ(foreground_part(segmented(tinted, learn(dark, 20, random, 1.0)), kWhole), 0.0);
    // the same tint in the light is a person
    const image::YuvImage lit = plain(240, 160, {90, 128, 128});
    image::YuvImage lit_tinted = lit;
    for (std::uint8_t& v : lit_tinted.v.data) v = 160;
    EXPECT_EQ(foreground_part(segmented(lit_tinted, learn(lit, 20, random, 1.0)), kWhole), 1.0);
}

// The noise of U and V is correlated. A deviation along it is noise, and one of the same length
// across it is a person.
TEST(Segmentation, ChromaIsTestedWithItsFullCovariance) {
    std::mt19937 random(10);
    std::normal_distribution<double> noise(0.0, 5.0);
    const image::YuvImage scene = plain(64, 48, {120, 128, 128});
    BackgroundLearner learner;
    for (int i = 0; i < 200; ++i) {
        image::YuvImage frame = scene;
        for (std::size_t k = 0; k < frame.u.data.size(); ++k) {
            const auto both =
                static_cast<std::uint8_t>(std::clamp(128.0 + noise(random), 0., 255.));
            frame.u.data[k] = frame.v.data[k] = both;
        }
        ASSERT_TRUE(learner.add(frame).has_value());
    }
    const BackgroundStatistics learned = learner.finish().value();
    for (const int across : {1, -1}) {
        image::YuvImage frame = scene;
        for (std::uint8_t& u : frame.u.data) u = 128 + 15;
        for (std::uint8_t& v : frame.v.data) v = static_cast<std::uint8_t>(128 + 15 * across);
        EXPECT_EQ(foreground_part(segmented(frame, learned), {0, 0, 64, 48}),
                  across == 1 ? 0.0 : 1.0);
    }
}

// Compares the mask of a Segmenter with a reference that tests every pixel and cleans the whole
// picture.
TEST(Segmentation, FindsTheSameAsATestOfEveryPixel) {
    std::mt19937 random(21);
    for (const auto& [width, height] :
         {std::pair{240, 160}, {96, 34}, {50, 66}, {30, 22}, {642, 82}}) {
        const image::YuvImage scene = room(width, height);
        const BackgroundStatistics learned = learn(scene, 20, random);
        SegmentationOptions options;
        options.max_gain_change = 0.0;
        options.drift_frames = 0.0;
        options.refine_outline = false;
        const BackgroundModel model = make_model(learned, options);
        Segmenter segmenter(learned, options);
        image::SparseMask sparse;
        for (int round = 0; round < 30; ++round) {
            image::YuvImage frame = scene;
            // blobs, also at the picture's border, slanted rows of blobs, and holes in them
            for (unsigned i = random() % 4; i > 0; --i) {
                const int x = static_cast<int>(random() % static_cast<unsigned>(width - 8)) & ~1;
                const int y = static_cast<int>(random() % static_cast<unsigned>(height - 8)) & ~1;
                const int right = std::min(x + 4 + static_cast<int>(random() % 60) * 2, width);
                const int bottom = std::min(y + 4 + static_cast<int>(random() % 30) * 2, height);
                scale_light(frame, {x, y, right - x, bottom - y}, 0.25);
                if (right - x > 20 && bottom - y > 20)
                    scale_light(frame, {x + 6, y + 6, 8, 4}, 4.0);
            }
            add_noise(frame, 2.0, 1.0, random);
            image::Mask raw(width, height);
            test::test_rows(
                frame, model, kUnitGain, InstructionSet::kBaseline, {0, height}, raw.data.data());
            CleanScratch scratch;
            image::Mask expected;
            test::majority_3x3(raw, scratch, expected);
            test::remove_small_parts(expected, options.min_area_px, options.max_hole_px, scratch);
            image::WorkingPicture picture(frame);
            ASSERT_TRUE(segmenter.segment(picture, sparse).has_value());
            EXPECT_EQ(sparse.mask.data, expected.data) << width << "x" << height << ", " << round;
            for (int y = 0; y < height; ++y) {
                const image::PixelSpan span = sparse.rows[static_cast<std::size_t>(y)];
                for (int x = 0; x < width; ++x) {
                    if (x < span.begin || x >= span.end) {
                        ASSERT_EQ(sparse.mask.at(x, y), 0);
                    }
                }
            }
        }
    }
}

TEST(Segmentation, LooksForPeopleOnlyInItsAreas) {
    std::mt19937 random(11);
    const image::YuvImage scene = room(240, 160);
    const auto learned = learn(scene, 10, random);
    image::YuvImage frame = scene;
    scale_light(frame, kPatch, 0.3);
    SegmentationAreas areas;
    areas.include.push_back({{59.5, -10}, {99.5, -10}, {99.5, 200}, {59.5, 200}});  // x in 60 .. 99
    areas.exclude.push_back({{-5, 59.5}, {300, 59.5}, {300, 79.5}, {-5, 79.5}});    // y in 60 .. 79
    Segmenter segmenter(learned, {}, areas);
    image::Mask mask;
    ASSERT_TRUE(segmenter.segment(frame, mask).has_value());
    EXPECT_EQ(foreground_part(mask, {64, 44, 36, 16}), 1.0);
    EXPECT_EQ(foreground_part(mask, {64, 80, 36, 16}), 1.0);
    EXPECT_EQ(foreground_part(mask, {60, 60, 80, 20}), 0.0);
    EXPECT_EQ(foreground_part(mask, {100, 40, 40, 60}), 0.0);
}

TEST(SegmentationAreas, FillByTheEvenOddRule) {
    SegmentationAreas areas;
    EXPECT_TRUE(areas.everywhere());
    EXPECT_EQ(foreground_part(rasterise(areas, 20, 10), {0, 0, 20, 10}), 1.0);
    // a triangle with its corner outside
    areas.include.push_back({{-0.5, -0.5}, {20.5, -0.5}, {-0.5, 20.5}});
    const image::Mask mask = rasterise(areas, 20, 20);
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) {
            if (x + y == 20) continue;  // on the edge
            EXPECT_EQ(mask.at(x, y) != 0, x + y < 20) << x << ", " << y;
        }
    }
}

}  // namespace
}  // namespace atrium::segmentation
