#include "core/gl/offscreen_context.hpp"
#include "tests/golden/golden_file.hpp"
#include "tests/golden/golden_scenes.hpp"
#include "tests/golden/picture_difference.hpp"
#include "tests/support/skips.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>

// Compares pictures drawn with OSMesa with stored pictures that somebody has checked.
// ATRIUM_RENEW_GOLDEN=1 renews pictures that changed on purpose. Check them before you commit them
// (tests/README.md).
namespace atrium::golden {
namespace {

using renderer::ObjectLook;
using renderer::RenderedPicture;

class GoldenTest : public testing::Test {
protected:
    void SetUp() override {
        auto context = gl::OffscreenContext::create(16, 16);
        ASSERT_TRUE(context) << context.error().message;
        context_.emplace(std::move(*context));
    }
    static RenderedPicture drawn(const Scene& scene) {
        auto picture = draw(scene);
        EXPECT_TRUE(picture) << picture.error().message;
        return picture ? std::move(*picture) : RenderedPicture{};
    }
    std::optional<gl::OffscreenContext> context_;
};

class GoldenPicture : public GoldenTest, public testing::WithParamInterface<Scene> {};

TEST_P(GoldenPicture, IsDrawnUnchanged) {
    const RenderedPicture picture = drawn(GetParam());
    if (std::getenv("ATRIUM_RENEW_GOLDEN") != nullptr) {
        renew_golden(GetParam().name, picture);
        GTEST_SKIP() << atrium::test::skip::kRenewed << golden_file(GetParam().name);
    }
    expect_golden(GetParam().name, picture, {});
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         GoldenPicture,
                         testing::ValuesIn(all_scenes()),
                         [](const auto& scene) { return scene.param.name; });

// Tests of the comparison itself, with changes of the scene "shapes".
class GoldenComparison : public GoldenTest {
protected:
    void SetUp() override {
        GoldenTest::SetUp();
        scene_ = all_scenes().front();
        picture_ = drawn(scene_);
    }
    // Draws the scene with one more change.
    RenderedPicture drawn_with(const std::function<void(renderer::SceneRenderer&)>& change) const {
        Scene changed = scene_;
        changed.fill = [&](renderer::SceneRenderer& renderer) {
            scene_.fill(renderer);
            change(renderer);
        };
        return drawn(changed);
    }
    RenderedPicture drawn_with(std::uint32_t number, const ObjectLook& look) const {
        return drawn_with([&](auto& renderer) { renderer.set_object(number, look); });
    }
    // Adds a value to each byte of red, green and blue.
    RenderedPicture with_added(const std::function<int()>& next) const {
        RenderedPicture result = picture_;
        for (std::size_t i = 0; i < result.rgba.size(); ++i) {
            if (i % 4 == 3) continue;
            result.rgba[i] =
                static_cast<std::uint8_t>(std::clamp(int{result.rgba[i]} + next(), 0, 255));
        }
        return result;
    }
    bool passes(const RenderedPicture& picture) const {
        last_ = picture_difference(picture_, picture);
        return is_within(last_);
    }
    std::string measured() const { return describe(last_); }

    Scene scene_;
    RenderedPicture picture_;
    mutable PictureDifference last_;
};

TEST_F(GoldenComparison, IgnoresInvisibleChanges) {
    EXPECT_TRUE(passes(picture_));
    EXPECT_EQ(last_.mean, 0.0);
    std::mt19937 random(1);
    std::uniform_int_distribution<int> grey_levels(-1, 1);
    EXPECT_TRUE(passes(with_added([&] { return grey_levels(random); }))) << measured();
}

TEST_F(GoldenComparison, NoticesADifferentExposure) {
    EXPECT_FALSE(passes(with_added([] { return 2; }))) << measured();
}

TEST_F(GoldenComparison, NoticesAMissingShadow) {
    for (const auto& [number, look] : shapes()) {
        if (!look.texture.empty()) continue;  // the texture hides its colour
        ObjectLook black = look;
        black.colour.setZero();
        const RenderedPicture other = drawn_with(number, black);
        const RenderedPicture without =
            drawn_with([&](auto& renderer) { renderer.remove_object(number); });
        // compares only outside the object, as if the object did not exist
        RenderedPicture no_shadow = picture_;
        for (std::size_t i = 0; i < no_shadow.rgba.size(); i += 4) {
            if (std::equal(&other.rgba[i], &other.rgba[i] + 3, &picture_.rgba[i]))
                std::copy_n(&without.rgba[i], 3, &no_shadow.rgba[i]);
        }
        EXPECT_FALSE(passes(no_shadow)) << number << ": " << measured();
    }
}

TEST_F(GoldenComparison, NoticesAnObjectThatMovedByTwoPixels) {
    const renderer::ViewCamera camera = shapes_camera();
    const Eigen::Vector3d forward = (camera.target_m - camera.position_m).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    const double focal_px = 0.5 * kHeight / std::tan(camera.fov_deg * M_PI / 360.0);
    for (auto [number, look] : shapes()) {
        Eigen::Vector3d& at = look.world_from_object.translation;
        at += 2.0 / focal_px * (at - camera.position_m).dot(forward) * right;
        EXPECT_FALSE(passes(drawn_with(number, look))) << number << ": " << measured();
    }
}

TEST_F(GoldenComparison, NoticesAColourThatChangedByATenth) {
    for (auto [number, look] : shapes()) {
        if (!look.texture.empty()) continue;
        look.colour *= 0.9;
        EXPECT_FALSE(passes(drawn_with(number, look))) << number << ": " << measured();
    }
}

TEST_F(GoldenComparison, WritesAPictureOfTheDifferences) {
    ObjectLook look = shapes().at(2);
    look.colour = {0.1, 0.15, 0.8};
    const RenderedPicture changed = drawn_with(2, look);
    testing::TestPartResultArray failures;
    {
        const testing::ScopedFakeTestPartResultReporter taking(&failures);
        expect_golden("shapes", changed, {});
    }
    ASSERT_EQ(failures.size(), 1);
    const auto folder = std::filesystem::path(testing::TempDir()) / "atrium_golden";
    EXPECT_THAT(failures.GetTestPartResult(0).message(), testing::HasSubstr(folder.string()));
    EXPECT_TRUE(std::filesystem::remove(folder / "shapes_actual.png"));
    EXPECT_TRUE(std::filesystem::remove(folder / "shapes_difference.png"));
}

}  // namespace
}  // namespace atrium::golden
