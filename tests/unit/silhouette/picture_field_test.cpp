#include "site_node/silhouette/picture_field.hpp"

#include "site_node/silhouette/silhouette.hpp"
#include "tests/unit/silhouette/test_masks.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace atrium::silhouette {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

geometry::PinholeCamera camera(int width, int height, std::array<double, 5> distortion = {}) {
    geometry::PinholeCamera c{width, height, 0.9 * width, 0.9 * width};
    c.cx = 0.5 * (width - 1) + 3.0;
    c.cy = 0.5 * (height - 1) - 2.0;
    c.distortion = distortion;
    return c;
}

bool is_inside(const Polygon& polygon, const Eigen::Vector2d& p) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Eigen::Vector2d& a = polygon[j];
        const Eigen::Vector2d& b = polygon[i];
        if ((a.y() > p.y()) == (b.y() > p.y())) continue;
        inside ^= p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y());
    }
    return inside;
}

TEST(PictureField, IsARectangleWithoutLensDistortion) {
    const auto field = picture_field(camera(640, 481), 2.5);
    ASSERT_TRUE(field);
    const Polygon expected{{2.0, 2.0}, {637.0, 2.0}, {637.0, 477.0}, {2.0, 477.0}};  // 480 rows
    EXPECT_EQ(*field, expected);
    EXPECT_GT(signed_area_px({*field, false}), 0.0);
}

TEST(PictureField, FollowsTheBorderOfADistortedPicture) {
    const geometry::PinholeCamera c = camera(640, 480, {-0.25, 0.06, 0.001, -0.002, 0.0});
    const auto field = picture_field(c, 2.0);
    ASSERT_TRUE(field);
    EXPECT_GT(field->size(), 12u);
    for (std::size_t i = 0; i < field->size(); ++i) {
        const Eigen::Vector2d& a = (*field)[i];
        const Eigen::Vector2d& b = (*field)[(i + 1) % field->size()];
        for (const double t : {0.0, 0.25, 0.5, 0.75}) {
            const Eigen::Vector2d p = c.distort(a + t * (b - a));
            const double to_border = std::min(std::min(p.x() + 0.5, 639.5 - p.x()),
                                              std::min(p.y() + 0.5, 479.5 - p.y()));
            EXPECT_NEAR(to_border, 2.0, 0.15);
        }
    }
}

TEST(PictureField, IsEmptyIfNothingIsLeftOrTheLensHasNoInverse) {
    EXPECT_FALSE(picture_field(camera(16, 16), 8.0));
    EXPECT_FALSE(picture_field(camera(640, 480, {-3.0, 0.0, 0.0, 0.0, 0.0}), 2.0));
}

// If the picture's border cuts a subject, the subject must be foreground on both sides of the
// field's border. Then its contour leaves the field, and no edge along the picture's border cuts
// the subject.
TEST(PictureField, IsCrossedBySilhouettesThatTouchTheBorder) {
    std::mt19937 random(5);
    const std::array<double, 5> lenses[] = {
        {}, {-0.25, 0.06, 0.001, -0.002, 0.0}, {0.2, 0.05, 0.0, 0.0, 0.0}};
    std::size_t num_foreground_tests = 0;
    for (int round = 0; round < 60; ++round) {
        const geometry::PinholeCamera c = camera(320, 240, lenses[round % 3]);
        image::Mask mask(320, 240);
        std::uniform_real_distribution<double> along(0.0, 1.0);
        for (int limb = 0; limb < 5; ++limb) {
            const double s = along(random);
            const double x = limb % 2 == 0 ? 320.0 * s : (limb % 4 == 1 ? 0.0 : 319.0);
            const double y = limb % 2 == 0 ? (limb % 4 == 0 ? 0.0 : 239.0) : 240.0 * s;
            test::draw(mask,
                       {x,
                        y,
                        60.0 + 200.0 * along(random),
                        50.0 + 140.0 * along(random),
                        8.0 + 30.0 * along(random)});
        }
        test::roughen(mask, 0.2, random);
        SilhouetteOptions options;
        options.tolerance_px = round % 2 == 0 ? 0.75 : 2.5;
        SilhouetteScratch scratch;
        std::vector<SilhouettePolygon> polygons;
        extract_silhouette(mask, c, options, scratch, polygons);
        const auto field = picture_field(c, field_inset_px(options.tolerance_px));
        ASSERT_TRUE(field);
        const int reach = 2 + static_cast<int>(2.0 * field_inset_px(options.tolerance_px));
        for (std::size_t i = 0; i < field->size(); ++i) {
            const Eigen::Vector2d& a = (*field)[i];
            const Eigen::Vector2d& b = (*field)[(i + 1) % field->size()];
            const int steps = 1 + static_cast<int>((b - a).norm());
            for (int k = 0; k < steps; ++k) {
                const Eigen::Vector2d p = a + (b - a) * k / steps;
                const Eigen::Vector2d at = c.distort(p);
                int num_on = 0;
                int num = 0;
                for (int y = static_cast<int>(at.y()) - reach; y <= at.y() + reach; ++y) {
                    for (int x = static_cast<int>(at.x()) - reach; x <= at.x() + reach; ++x) {
                        if (x < 0 || y < 0 || x >= 320 || y >= 240) continue;
                        ++num;
                        num_on += mask.at(x, y) != 0 ? 1 : 0;
                    }
                }
                if (num_on != 0 && num_on != num) continue;  // too near to an outline to decide
                bool inside = false;
                for (const SilhouettePolygon& polygon : polygons)
                    inside ^= is_inside(polygon.vertices_px, p);
                EXPECT_EQ(inside, num_on == num) << "round " << round << ", at " << at.transpose();
                num_foreground_tests += num_on == num ? 1 : 0;
            }
        }
    }
    EXPECT_GT(num_foreground_tests, 1000u);
}

}  // namespace
}  // namespace atrium::silhouette
