#include "tests/support/allocation_counter.hpp"
#include "tests/unit/segmentation/test_room.hpp"

namespace atrium::segmentation {
namespace {

using namespace test;

// With people who come and go, in flickering light.
TEST(Segmenter, AllocatesNothingAfterItsFirstPictures) {
    std::mt19937 random(1);
    const image::YuvImage scene = room(240, 160);
    std::vector<image::YuvImage> pictures;
    for (int i = 0; i < 8; ++i) {
        pictures.push_back(scene);
        scale_light(pictures.back(), kPatch, i % 2 == 0 ? 0.3 : 1.0);
        scale_light(pictures.back(), kWhole, 1.0 - 0.03 * (i % 4));
        add_noise(pictures.back(), 2.0, 1.0, random);
    }
    Segmenter segmenter(learn(scene, 10, random), {});
    image::Mask mask;
    bool done = true;
    for (const image::YuvImage& picture : pictures)
        done = segmenter.segment(picture, mask).has_value() && done;
    const std::uint64_t before = atrium::test::num_allocations();
    for (const image::YuvImage& picture : pictures)
        done = segmenter.segment(picture, mask).has_value() && done;
    EXPECT_EQ(atrium::test::num_allocations(), before);
    EXPECT_TRUE(done);
}

}  // namespace
}  // namespace atrium::segmentation
