#include "core/codec/mesh_codec.hpp"
#include "site_node/pipeline.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/unit/site_node/capsule_room.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace atrium::site_node {
namespace {

constexpr int kSize_px = 240;
constexpr std::size_t kNumCameras = 8;
constexpr std::array kFormats{image::PixelFormat::kBgr,
                              image::PixelFormat::kBayerRG,
                              image::PixelFormat::kUyvy,
                              image::PixelFormat::kMono8};

// Kept memory serves another camera or polygon each time, and grows until it has served all of
// them.
constexpr int kWarmRounds = 10;

image::PixelFormat format_of(std::size_t camera) { return kFormats[camera % kFormats.size()]; }

// Bytes of one value, a different one where a person is, with noise. Segmentation can separate the
// picture in any format.
image::RawImage take_picture(const image::Mask& person, image::PixelFormat format, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> noise(-2, 2);
    const std::size_t row = image::row_bytes(format, kSize_px);
    const std::size_t bytes_per_pixel = row / kSize_px;
    auto bytes = std::make_shared<std::vector<std::uint8_t>>(row * kSize_px);
    for (std::size_t i = 0; i < bytes->size(); ++i)
        (*bytes)[i] = static_cast<std::uint8_t>((person.data[i / bytes_per_pixel] != 0 ? 60 : 140) +
                                                noise(random));
    image::RawImage raw;
    raw.format = format;
    raw.width = raw.height = kSize_px;
    raw.planes[0] = {bytes->data(), row};
    raw.owner = std::move(bytes);
    return raw;
}

class EmptyRoom final : public capture::FrameSource {
public:
    explicit EmptyRoom(config::Rig rig) : rig_(std::move(rig)) {}
    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override {
        const auto show = [&](std::size_t camera) -> Expected<void> {
            const image::Mask nobody(kSize_px, kSize_px);
            image::YuvImage buffer;
            for (unsigned seed = 0; seed < 8; ++seed)
                sink(camera,
                     image::working_view(take_picture(nobody, format_of(camera), seed), buffer));
            return {};
        };
        return capture::one_after_another(cameras, show, stop);
    }
    Expected<void> run(std::stop_token, const Sink&) override { return {}; }

private:
    config::Rig rig_;
};

capture::Metaframe shoot(std::span<const test::Capsule> body, const config::Rig& rig) {
    capture::Metaframe metaframe;
    for (std::size_t i = 0; i < kNumCameras; ++i) {
        metaframe.frames.push_back(
            {i, {}, take_picture(test::draw(body, rig.cameras[i]), format_of(i), 100), nullptr});
    }
    return metaframe;
}

// Draco allocates freely. The test counts that by coding the same meshes a second time. Everything
// else in a metaframe, from raw pictures on, allocates nothing. (TurboJPEG uses malloc, which is
// not counted here.) People come, go and move, and cameras fail.
TEST(PipelineAllocations, AreOnlyThoseOfDraco) {
    config::Rig rig;
    rig.cameras = atrium::test::make_ring_rig({.num_cameras = kNumCameras,
                                               .radius_m = 3.0,
                                               .heights_m = {1.0, 2.2},
                                               .size_px = kSize_px,
                                               .focal_px = 250.0});
    rig.bounds_site = geometry::Aabb{{-0.9, -0.9, 0.0}, {0.9, 0.9, 1.9}};
    std::vector<capture::Metaframe> metaframes;
    for (const double x : {0.0, 0.05, 0.1})
        metaframes.push_back(shoot(test::make_body({x, 0, 0}), rig));
    metaframes.push_back(shoot({}, rig));
    metaframes.push_back(metaframes.front());
    metaframes.back().frames[3].image = {};
    metaframes.push_back(metaframes.front());

    PipelineOptions options;
    options.segmentation.drift_frames = 0.0;  // each round starts from the same state
    EmptyRoom room(rig);
    auto pipeline = Pipeline::create(room, options, {});
    ASSERT_TRUE(pipeline) << pipeline.error().message;
    SerialExecutor executor;
    SiteFrame frame;
    codec::MeshEncoder encoder;
    std::vector<std::uint8_t> draco;
    std::size_t num_hulls = 0;
    for (int round = 0; round <= kWarmRounds; ++round) {
        for (std::size_t i = 0; i < metaframes.size(); ++i) {
            const std::uint64_t before = atrium::test::num_allocations();
            const bool done = pipeline->process(metaframes[i], executor, frame).has_value();
            const std::uint64_t in_process = atrium::test::num_allocations() - before;
            ASSERT_TRUE(done);
            const bool somebody = frame.hull.status == hull::HullStatus::kOk;
            std::uint64_t in_draco = 0;
            if (somebody) {
                draco.clear();
                codec::MeshCodecOptions mesh = options.mesh;
                mesh.position_bits = codec::position_bits_for(frame.hull.mesh, rig.cameras);
                const std::uint64_t before_draco = atrium::test::num_allocations();
                ASSERT_TRUE(encoder.encode(frame.hull.mesh, mesh, draco));
                in_draco = atrium::test::num_allocations() - before_draco;
                EXPECT_EQ(draco, frame.draco);
                EXPECT_GT(in_draco, 0u);
            }
            if (round < kWarmRounds) continue;
            num_hulls += somebody ? 1 : 0;
            EXPECT_EQ(somebody, i != 3) << "metaframe " << i;
            EXPECT_EQ(in_process, in_draco) << "metaframe " << i;
        }
    }
    EXPECT_EQ(num_hulls, metaframes.size() - 1);
}

}  // namespace
}  // namespace atrium::site_node
