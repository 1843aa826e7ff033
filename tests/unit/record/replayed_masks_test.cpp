#include "core/base/thread_pool.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"
#include "tests/unit/record/recorder_fixture.hpp"

#include <gtest/gtest.h>

// Recording and replay give the same masks, bit for bit.
namespace atrium::record {
namespace {

namespace fs = std::filesystem;
using site_node::SilhouetteStage;

constexpr int kSize_px = 96;
constexpr int kNumInstants = 12;

// Bayer pictures of an empty room with noise; or with
// a part that moves, under light that grows.
image::RawImage shot(std::size_t camera, int index, bool has_person) {
    const auto seed = static_cast<std::uint64_t>(1000 * (has_person ? 1 : 2) + 10 * index) + camera;
    image::RawImage room =
        test::make_picture(image::PixelFormat::kBayerRG, kSize_px, kSize_px, seed * 32);
    auto bytes = test::bytes_of(room);
    for (int y = 0; y < kSize_px && has_person; ++y) {
        for (int x = 0; x < kSize_px; ++x) {
            auto& byte = bytes[static_cast<std::size_t>(y * kSize_px + x)];
            byte = static_cast<std::uint8_t>(byte + index / 4);
            const bool is_person = x > 20 + index && x < 50 + index && y > 15 && y < 85;
            if (is_person) byte = static_cast<std::uint8_t>(255 - byte / 2);
        }
    }
    return capture::unpack(capture::layout_of(room), std::move(bytes));
}

// A room that is there once: pictures of the empty room, then of a person.
class LiveRoom final : public capture::FrameSource {
public:
    explicit LiveRoom(config::Rig rig) : rig_(std::move(rig)) {}
    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override {
        return capture::one_after_another(
            cameras,
            [&](std::size_t camera) -> Expected<void> {
                image::YuvImage buffer;
                for (int i = 0; i < 8; ++i)
                    sink(camera, image::working_view(shot(camera, i, false), buffer));
                return {};
            },
            stop);
    }
    Expected<void> run(std::stop_token /*stop*/, const Sink& sink) override {
        for (int i = 0; i < kNumInstants; ++i) {
            for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera)
                sink({camera, {i * 20'000'000LL}, shot(camera, i, true), nullptr});
        }
        return {};
    }

private:
    config::Rig rig_;
};

std::vector<SilhouetteStage> stages_of(capture::FrameSource& source) {
    std::vector<SilhouetteStage> stages;
    for (auto& stage :
         site_node::make_silhouette_stages(source, site_node::all_cameras(source), {}, {})) {
        EXPECT_TRUE(stage) << stage.error().message;
        if (stage) stages.push_back(std::move(*stage));
    }
    return stages;
}

using Masks = std::vector<image::Mask>;

image::Mask mask_of(SilhouetteStage& stage, capture::CameraFrame frame) {
    site_node::PictureSilhouette found;
    EXPECT_TRUE(stage.find(frame, {}, found));
    return found.mask.mask;
}

TEST(ReplayedRecording, GivesTheSameMasksBitForBit) {
    const fs::path folder =
        fs::path(testing::TempDir()) / ("atrium_replayed_" + std::to_string(getpid()));
    fs::remove_all(folder);
    LiveRoom room(test::make_rig(2, kSize_px, kSize_px, 50.0));
    std::vector<SilhouetteStage> stages = stages_of(room);
    ASSERT_EQ(stages.size(), 2u);

    RecorderOptions options;
    options.rate_hz = 50.0;
    options.bytes_per_instant = std::size_t{2} * kSize_px * kSize_px;
    options.min_free_bytes = 0;
    auto recorder = RawRecorder::create(
        {"lab", room.rig(), {&stages[0].room(), &stages[1].room()}, ""}, options);
    ASSERT_TRUE(recorder) << recorder.error().message;
    ASSERT_TRUE((*recorder)->start(folder));
    Masks live;
    ASSERT_TRUE(room.run({}, [&](const capture::CameraFrame& frame) {
        (*recorder)->add(frame);
        live.push_back(mask_of(stages[frame.camera], frame));
    }));
    ASSERT_TRUE((*recorder)->stop());

    const auto source = capture::RecordingSource::open({.folder = folder});
    ASSERT_TRUE(source) << source.error().message;
    std::vector<SilhouetteStage> replayed_stages = stages_of(**source);
    ASSERT_EQ(replayed_stages.size(), 2u);
    Masks replayed;
    ASSERT_TRUE((*source)->run({}, [&](const capture::CameraFrame& frame) {
        replayed.push_back(mask_of(replayed_stages[frame.camera], frame));
    }));
    ASSERT_EQ(replayed.size(), live.size());
    std::size_t num_foreground = 0;
    for (std::size_t i = 0; i < live.size(); ++i) {
        EXPECT_EQ(replayed[i].data, live[i].data) << "picture " << i;
        num_foreground += static_cast<std::size_t>(std::ranges::count(live[i].data, 255));
    }
    EXPECT_GT(num_foreground, live.size() * 1000);  // there is a person, and not everywhere
    EXPECT_LT(num_foreground, live.size() * 5000);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace atrium::record
