#include "site_node/segmentation/steady_picture.hpp"

#include "tests/unit/segmentation/test_room.hpp"

#include <functional>
#include <vector>

namespace atrium::segmentation {
namespace {

using test::Colour;

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr image::PixelRect kWhole{0, 0, kWidth, kHeight};
constexpr Colour kJacket{60, 150, 110};
constexpr Colour kShirt{110, 90, 190};
constexpr image::PixelRect kSpot{100, 40, 30, 90};

void paint(image::YuvImage& picture, const image::PixelRect& area, Colour colour) {
    const image::YuvImage patch = test::plain(2, 2, colour);
    for (int y = area.y; y < area.y + area.height; ++y) {
        for (int x = area.x; x < area.x + area.width; ++x) {
            picture.y.row(y)[x] = patch.y.data[0];
            picture.u.row(y / 2)[x / 2] = patch.u.data[0];
            picture.v.row(y / 2)[x / 2] = patch.v.data[0];
        }
    }
}

// Stripes and squares on the wall.
image::YuvImage patterned_room() {
    image::YuvImage picture = test::room(kWidth, kHeight);
    for (int x = 8; x < kWidth - 8; x += 24) test::scale_light(picture, {x, 100, 8, 50}, 0.8);
    for (int x = 20; x < kWidth - 30; x += 60) paint(picture, {x, 12, 16, 16}, kShirt);
    return picture;
}

// Light that a lamp throws: strongest at (x, y), without an edge.
void add_lamp(image::YuvImage& picture, double x0, double y0, double strength) {
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            const double distance = std::hypot(x - x0, y - y0) / 40.0;
            const double factor = 1.0 + strength * std::exp(-distance * distance);
            std::uint8_t& luma = picture.y.row(y)[x];
            luma = static_cast<std::uint8_t>(std::min(250L, std::lround(factor * luma)));
        }
    }
}

class SteadyPictureTest : public ::testing::Test {
protected:
    using Change = std::function<void(image::YuvImage&, int)>;

    // A take of 24 pictures, which `change` makes from the room.
    SteadyPicture take(const Change& change) {
        std::vector<image::YuvImage> pictures;
        for (int i = 0; i < 24; ++i) {
            pictures.push_back(patterned_room());
            change(pictures.back(), i);
            test::add_noise(pictures.back(), 2.0, 1.0, random_);
        }
        return find_steady_picture(pictures);
    }
    // One picture of the empty room, changed.
    BackgroundStatistics plate(const std::function<void(image::YuvImage&)>& change) {
        image::YuvImage picture = patterned_room();
        change(picture);
        return test::learn(picture, 1, random_);
    }
    // Walks through kSpot and back.
    static void walk(image::YuvImage& picture, int i) {
        const int x = 20 + 8 * (i < 12 ? 2 * i : 47 - 2 * i);
        paint(picture, {x & ~1, 40, 30, 90}, kJacket);
    }

    std::mt19937 random_{5};
};

TEST_F(SteadyPictureTest, ShowsTheRoomBehindSomebodyWhoWalks) {
    const SteadyPicture steady = take(walk);
    const image::YuvImage room = patterned_room();
    int num_wrong = 0;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            if (steady.is_steady.at(x, y) != 0)
                num_wrong += std::abs(steady.picture.y.at(x, y) - room.y.at(x, y)) > 5 ? 1 : 0;
        }
    }
    EXPECT_EQ(num_wrong, 0);
    EXPECT_GT(test::foreground_part(steady.is_steady, kWhole), 0.95);
}

TEST_F(SteadyPictureTest, IsNotSteadyWhereSomebodyComesAndGoes) {
    const SteadyPicture steady = take([](image::YuvImage& picture, int i) {
        if (i % 2 == 0) paint(picture, kSpot, kJacket);
    });
    EXPECT_EQ(test::foreground_part(steady.is_steady, kSpot), 0.0);
}

TEST_F(SteadyPictureTest, FindsAGhostWhereSomebodyWalks) {
    const auto room = plate([](image::YuvImage& picture) { paint(picture, kSpot, kJacket); });
    const auto ghost = find_ghost(room, take(walk), {});
    ASSERT_TRUE(ghost);
    EXPECT_NEAR(ghost->x, kSpot.x + kSpot.width / 2, 4);
    EXPECT_NEAR(ghost->y, kSpot.y + kSpot.height / 2, 8);
}

// Each piece is too small to be a person.
TEST_F(SteadyPictureTest, FindsThePiecesThatStandOutBehindSomebody) {
    const auto arms = [](image::YuvImage& picture) {
        paint(picture, {88, 60, 12, 18}, kJacket);
        paint(picture, {130, 60, 12, 18}, kJacket);
    };
    const SteadyPicture steady =
        take([](image::YuvImage& picture, int) { paint(picture, kSpot, kJacket); });
    const auto ghost = find_ghost(plate([&](image::YuvImage& picture) {
                                      paint(picture, kSpot, kJacket);
                                      arms(picture);
                                  }),
                                  steady,
                                  {});
    ASSERT_TRUE(ghost);
    EXPECT_NEAR(ghost->x, kSpot.x + kSpot.width / 2, 4);
    EXPECT_NEAR(ghost->y, 69, 4);
    // without a ghost behind, the edges of the person outnumber them
    EXPECT_FALSE(find_ghost(plate(arms), steady, {}));
}

TEST_F(SteadyPictureTest, IsQuietAboutSomebodyWhoStandsStill) {
    const auto room = plate([](image::YuvImage&) {});
    EXPECT_FALSE(find_ghost(
        room, take([](image::YuvImage& picture, int) { paint(picture, kSpot, kJacket); }), {}));
}

TEST_F(SteadyPictureTest, IsQuietAboutAThingThatCame) {
    const auto room = plate([](image::YuvImage&) {});
    EXPECT_FALSE(find_ghost(room,
                            take([](image::YuvImage& picture, int i) {
                                paint(picture, {30, 60, 40, 40}, kShirt);
                                walk(picture, i);
                            }),
                            {}));
}

TEST_F(SteadyPictureTest, IsQuietAboutOtherLight) {
    const SteadyPicture steady = take(walk);
    const auto quiet = [&](const std::function<void(image::YuvImage&)>& change) {
        return !find_ghost(plate(change), steady, {});
    };
    EXPECT_TRUE(quiet([](image::YuvImage&) {}));
    for (const double factor : {0.8, 0.92, 1.08, 1.2}) {
        EXPECT_TRUE(quiet([&](image::YuvImage& picture) {
            test::scale_light(picture, kWhole, factor);
        })) << factor;
    }
    // a lamp that was moved, and a shadow with a sharp edge
    EXPECT_TRUE(quiet([](image::YuvImage& picture) { add_lamp(picture, 60.0, 60.0, 0.5); }));
    EXPECT_TRUE(quiet([](image::YuvImage& picture) { add_lamp(picture, 60.0, 60.0, -0.5); }));
    EXPECT_TRUE(quiet([](image::YuvImage& picture) { test::scale_light(picture, kSpot, 0.7); }));
}

// As after another white balance: a colour cast that fades away, except at one edge.
TEST_F(SteadyPictureTest, IsQuietAboutOtherColours) {
    const auto room = plate([](image::YuvImage& picture) {
        constexpr int kEdge = 60;  // [half pixels]
        for (int y = 0; y < kHeight / 2; ++y) {
            for (int x = kEdge; x < kWidth / 2; ++x) {
                const double across = (x - kEdge) / 25.0;
                const double down = y / 40.0;
                picture.v.row(y)[x] = static_cast<std::uint8_t>(std::lround(
                    picture.v.at(x, y) + 50.0 * std::exp(-across * across - down * down)));
            }
        }
    });
    EXPECT_FALSE(find_ghost(room, take(walk), {}));
}

TEST_F(SteadyPictureTest, IsQuietAboutAShadowThatCame) {
    const auto room = plate([](image::YuvImage&) {});
    EXPECT_FALSE(find_ghost(
        room,
        take([](image::YuvImage& picture, int) { test::scale_light(picture, kSpot, 0.7); }),
        {}));
}

TEST_F(SteadyPictureTest, IsQuietAboutACameraThatWasMovedALittle) {
    const SteadyPicture steady = take(walk);
    for (const int shift : {2, 4, 6}) {
        const auto room = plate([&](image::YuvImage& picture) {
            const image::YuvImage before = picture;
            for (int y = 0; y < kHeight; ++y)
                std::copy_n(before.y.row(y) + shift, kWidth - shift, picture.y.row(y));
            for (int y = 0; y < kHeight / 2; ++y) {
                const int num = (kWidth - shift) / 2;
                std::copy_n(before.u.row(y) + shift / 2, num, picture.u.row(y));
                std::copy_n(before.v.row(y) + shift / 2, num, picture.v.row(y));
            }
        });
        EXPECT_FALSE(find_ghost(room, steady, {})) << shift;
    }
}

TEST_F(SteadyPictureTest, IsQuietAboutAnotherView) {
    const auto room = plate([](image::YuvImage& picture) {
        paint(picture, {0, 0, kWidth, kHeight}, kJacket);
        paint(picture, kSpot, kShirt);
    });
    EXPECT_FALSE(find_ghost(room, take(walk), {}));
}

}  // namespace
}  // namespace atrium::segmentation
