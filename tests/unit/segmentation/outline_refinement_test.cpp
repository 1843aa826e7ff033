#include "site_node/segmentation/outline_refinement.hpp"

#include "site_node/segmentation/edge_width.hpp"
#include "tests/unit/segmentation/test_room.hpp"

#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace atrium::segmentation {
namespace {

using namespace test;

// Part of a pixel that an ellipse with a hole covers, with an edge of `width_px`.
struct Ring {
    double x, y;      // centre [px]
    double a, b;      // semi-axes
    double hole;      // radius of a round hole in the middle; 0: none
    double width_px;  // of the edge

    double cover(double px, double py) const {
        const double u = (px - x) / a;
        const double v = (py - y) / b;
        const double r = std::hypot(u, v);
        // distance from the ellipse, to first order
        const double slope = std::hypot(u / a, v / b) / std::max(r, 1e-9);
        const double inside_px = (1.0 - r) / std::max(slope, 1e-9);
        const double outside_hole_px = hole > 0.0 ? std::hypot(px - x, py - y) - hole : 1e9;
        return std::clamp(std::min(inside_px, outside_hole_px) / width_px + 0.5, 0.0, 1.0);
    }
};

// Puts a person of one colour, shaded by up to `shading` towards the right, into a picture.
image::Mask paint(const Ring& ring, Colour colour, double shading, image::YuvImage& frame) {
    const int width = frame.width();
    const int height = frame.height();
    image::Mask truth(width, height);
    std::vector<double> cover(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto mix = [](double share, double person, std::uint8_t room) {
        return static_cast<std::uint8_t>(
            std::clamp(std::lround(share * person + (1.0 - share) * room), 0L, 255L));
    };
    const auto at = [&](int x, int y) -> double& {
        return cover[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x)];
    };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            at(x, y) = ring.cover(x, y);
            truth.row(y)[x] = at(x, y) >= 0.5 ? 255 : 0;
            const double light = 1.0 - shading * (x - ring.x + ring.a) / (2.0 * ring.a);
            frame.y.row(y)[x] = mix(at(x, y), colour.y * light, frame.y.at(x, y));
        }
    }
    for (int y = 0; y < height / 2; ++y) {
        for (int x = 0; x < width / 2; ++x) {
            const double share = (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) +
                                  at(2 * x + 1, 2 * y + 1)) /
                                 4.0;
            frame.u.row(y)[x] = mix(share, colour.u, frame.u.at(x, y));
            frame.v.row(y)[x] = mix(share, colour.v, frame.v.at(x, y));
        }
    }
    return truth;
}

struct Errors {
    double iou;
    double bias_px;  // how much too wide
};

Errors compare(const image::Mask& mask, const image::Mask& truth) {
    double both = 0, either = 0, extra = 0, missing = 0, outline = 0;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            const bool a = mask.at(x, y) != 0;
            const bool b = truth.at(x, y) != 0;
            both += a && b;
            either += a || b;
            extra += a && !b;
            missing += b && !a;
            outline += b && x > 0 && truth.at(x - 1, y) == 0;
            outline += b && x + 1 < mask.width && truth.at(x + 1, y) == 0;
        }
    }
    // a boundary of any direction has about so many steps to the side per pixel of length
    return {both / either, (extra - missing) / (outline * 1.57)};
}

double uniform(std::mt19937& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

image::Mask found(const BackgroundStatistics& learned,
                  const image::YuvImage& frame,
                  bool refine_outline) {
    SegmentationOptions options;
    options.refine_outline = refine_outline;
    Segmenter segmenter(learned, options);
    image::Mask mask;
    EXPECT_TRUE(segmenter.segment(frame, mask).has_value());
    return mask;
}

TEST(OutlineRefinement, PutsTheOutlineWhereAPersonCoversHalf) {
    std::mt19937 random(5);
    const image::YuvImage scene = room(240, 160);
    const auto learned = learn(scene, 20, random);
    double bias_before = 0.0;
    double bias_after = 0.0;
    double iou_before = 0.0;
    double iou_after = 0.0;
    constexpr int kRounds = 40;
    for (int round = 0; round < kRounds; ++round) {
        const Ring ring{uniform(random, 60, 180),
                        uniform(random, 50, 110),
                        uniform(random, 12, 40),
                        uniform(random, 20, 45),
                        0.0,
                        uniform(random, 1.0, 3.0)};
        // bright or dark, of another hue than the room
        const Colour colour{round % 2 == 0 ? uniform(random, 20, 50) : uniform(random, 215, 240),
                            uniform(random, 90, 160),
                            uniform(random, 140, 190)};
        image::YuvImage frame = scene;
        const image::Mask truth = paint(ring, colour, 0.2, frame);
        add_noise(frame, 2.0, 1.0, random);
        const Errors before = compare(found(learned, frame, false), truth);
        const Errors after = compare(found(learned, frame, true), truth);
        EXPECT_GT(after.iou, before.iou - 0.002) << round;
        EXPECT_GT(after.iou, 0.955) << round;
        iou_before += before.iou / kRounds;
        iou_after += after.iou / kRounds;
        bias_before += before.bias_px / kRounds;
        bias_after += after.bias_px / kRounds;
    }
    EXPECT_GT(bias_before, 0.3);  // the test of single pixels takes a tenth of a person for one
    EXPECT_NEAR(bias_after, 0.0, 0.15);
    EXPECT_GT(iou_after, 0.98);
    EXPECT_LT(1.0 - iou_after, 0.6 * (1.0 - iou_before));
}

// The gap between an arm and the trunk.
TEST(OutlineRefinement, HolesStayOpen) {
    std::mt19937 random(6);
    const image::YuvImage scene = room(240, 160);
    const auto learned = learn(scene, 20, random);
    for (int round = 0; round < 20; ++round) {
        const double hole = uniform(random, 7.0, 14.0);
        const Ring ring{uniform(random, 80, 160),
                        uniform(random, 60, 100),
                        hole + uniform(random, 6, 20),
                        hole + uniform(random, 6, 30),
                        hole,
                        uniform(random, 1.0, 2.0)};
        image::YuvImage frame = scene;
        const image::Mask truth = paint(ring, {30, 120, 160}, 0.0, frame);
        add_noise(frame, 2.0, 1.0, random);
        const image::Mask mask = found(learned, frame, true);
        double open = 0.0;
        for (int y = 0; y < mask.height; ++y) {
            for (int x = 0; x < mask.width; ++x)
                open += mask.at(x, y) == 0 && std::hypot(x - ring.x, y - ring.y) < hole;
        }
        EXPECT_NEAR(open / (3.1416 * hole * hole), 1.0, 0.12) << hole;
        EXPECT_GT(compare(mask, truth).iou, 0.93) << hole;
    }
}

// Light that falls by 30 % within 30 pictures, more than the compensation of the light alone
// permits: nobody gets a hole, and the room does not become a person.
TEST(OutlineRefinement, FallingLightMakesNoHole) {
    std::mt19937 random(7);
    const image::YuvImage scene = room(240, 160);
    image::YuvImage person = scene;
    const image::Mask truth = paint({120, 80, 30, 50, 0.0, 1.5}, {35, 110, 165}, 0.2, person);
    Segmenter segmenter(learn(scene, 20, random), {});
    image::Mask mask;
    for (int i = 0; i <= 40; ++i) {
        image::YuvImage frame = person;
        scale_light(frame, kWhole, 1.0 - 0.3 * std::min(i, 30) / 30.0);
        add_noise(frame, 2.0, 1.0, random);
        ASSERT_TRUE(segmenter.segment(frame, mask).has_value());
        EXPECT_GT(compare(mask, truth).iou, 0.96) << i;
        for (int y = 50; y < 110; ++y) {
            for (int x = 105; x < 135; ++x) ASSERT_NE(mask.at(x, y), 0) << i;
        }
    }
}

// Nothing can be decided by colours that are alike.
TEST(OutlineRefinement, KeepsTheMaskWhereColoursAreAlike) {
    std::mt19937 random(8);
    const image::YuvImage scene = plain(240, 160, {150, 120, 130});
    const BackgroundModel model = make_model(learn(scene, 20, random), {});
    image::YuvImage frame = scene;
    image::SparseMask mask;
    mask.mask = paint({120, 80, 30, 50, 0.0, 1.0}, {152, 121, 131}, 0.0, frame);
    mask.forget();
    const image::Mask before = mask.mask;
    add_noise(frame, 1.0, 0.5, random);
    OutlineRefinement refinement;
    refinement.refine(frame, model, kUnitGain, {}, mask);
    EXPECT_GT(compare(mask.mask, before).iou, 0.995);
}

TEST(OutlineRefinement, AllInstructionSetsGiveTheSameBits) {
    std::mt19937 random(9);
    for (const auto& [width, height] : {std::pair{240, 160}, {66, 50}, {130, 38}, {30, 22}}) {
        const image::YuvImage scene = room(width, height);
        for (int round = 0; round < 30; ++round) {
            image::YuvImage frame = scene;
            const Ring ring{uniform(random, 0, width),
                            uniform(random, 0, height),
                            uniform(random, 3, width / 2),
                            uniform(random, 3, height / 2),
                            round % 3 == 0 ? 2.5 : 0.0,
                            1.5};
            paint(ring,
                  {uniform(random, 0, 255), uniform(random, 90, 160), uniform(random, 90, 160)},
                  0.5,
                  frame);
            add_noise(frame, 4.0, 2.0, random);
            image::YuvView view(frame);
            BackgroundStatistics learned = learn(scene, 5, random);
            if (round % 2 == 1) view.mosaic = learned.mosaic = image::Mosaic::kRG;
            const BackgroundModel model = make_model(std::move(learned), {});
            image::SparseMask masks[2];
            masks[0].mask = image::Mask(width, height);
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x)
                    masks[0].mask.row(y)[x] = ring.cover(x + 0.7, y - 0.6) > 0.3 ? 255 : 0;
            }
            masks[0].forget();
            masks[1] = masks[0];
            const auto gain = static_cast<std::int16_t>(uniform(random, 0.8, 1.3) * kUnitGain);
            OutlineRefinement refinement;
            refinement.refine(view, model, gain, {}, masks[0], InstructionSet::kBaseline);
            refinement.refine(view, model, gain, {}, masks[1], best_instruction_set());
            EXPECT_EQ(masks[0].mask.data, masks[1].mask.data) << width << ", " << round;
        }
    }
}

TEST(EdgeWidth, TellsBlurredFromSharpCameras) {
    std::mt19937 random(10);
    for (const auto& [edge_px, low, high] :
         {std::tuple{1.0, 0.9, 1.25}, {2.0, 1.3, 2.1}, {3.0, 2.0, 3.1}}) {
        image::YuvImage scene = plain(240, 160, {80, 128, 128});
        for (const double x : {20.3, 60.1, 100.8, 140.5, 180.6, 220.2}) {
            for (int y = 0; y < 160; ++y) {
                for (int column = 0; column < 240; ++column) {
                    const double share =
                        std::clamp((column - x + y * 0.01) / edge_px + 0.5, 0.0, 1.0) -
                        std::clamp((column - x - 20.0 + y * 0.01) / edge_px + 0.5, 0.0, 1.0);
                    auto& luma = scene.y.row(y)[column];
                    luma = static_cast<std::uint8_t>(luma + std::lround(80.0 * share));
                }
            }
        }
        const auto width_px = edge_width_px(learn(scene, 30, random, 1.0));
        ASSERT_TRUE(width_px.has_value());
        EXPECT_GT(*width_px, low);
        EXPECT_LT(*width_px, high);
    }
    EXPECT_FALSE(edge_width_px(learn(plain(240, 160, {80, 128, 128}), 5, random)).has_value());
}

}  // namespace
}  // namespace atrium::segmentation
