#include "core/base/thread_pool.hpp"
#include "core/config/rig.hpp"
#include "site_node/pipeline.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/segmentation_worker/fake_worker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace atrium::site_node {
namespace {

using atrium::test::FakeConnection;
using atrium::test::FakeWorker;
using segmentation_worker::WorkerCounts;

constexpr std::size_t kNumCameras = 3;
constexpr int kBodyLeft = 300, kBodyTop = 200, kBodySize = 60;  // of what the worker finds [px]

// Cameras in an empty grey room.
class GreyRoom final : public capture::FrameSource {
public:
    GreyRoom()
        : rig_(config::load_rig(atrium::test::source_dir() + "/deploy/rigs/full_body.toml")
                   .value()) {
        rig_.cameras.resize(kNumCameras);
        const auto& lens = rig_.cameras[0].intrinsics;
        picture_ = std::make_shared<image::YuvImage>(
            image::YuvImage{image::Plane(lens.width, lens.height, 120),
                            image::Plane(lens.width / 2, lens.height / 2, 128),
                            image::Plane(lens.width / 2, lens.height / 2, 128)});
    }
    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token) override {
        for (const std::size_t camera : cameras) sink(camera, *picture_);
        return std::vector<Expected<void>>(cameras.size());
    }
    Expected<void> run(std::stop_token, const Sink&) override { return {}; }

    capture::Metaframe take(std::int64_t time_ns) const {
        capture::Metaframe metaframe;
        for (std::size_t camera = 0; camera < kNumCameras; ++camera)
            metaframe.frames.push_back({camera, {time_ns}, image::RawImage(picture_), nullptr});
        return metaframe;
    }

private:
    config::Rig rig_;
    std::shared_ptr<const image::YuvImage> picture_;
};

// A worker that answers when it has the pictures of all cameras, as one that makes a batch of them.
class BatchWorker {
public:
    explicit BatchWorker(const std::filesystem::path& path) : worker_(path) {
        thread_ = std::jthread([this] { serve(); });
    }

private:
    void serve() const {
        std::vector<std::unique_ptr<FakeConnection>> cameras;
        while (cameras.size() < kNumCameras) {
            cameras.push_back(worker_.accept());
            cameras.back()->ready();
        }
        for (;;) {
            std::vector<std::uint64_t> numbers;
            for (const auto& camera : cameras) {
                const auto picture = camera->receive();
                if (!picture) return;
                numbers.push_back(picture->number);
            }
            for (std::size_t i = 0; i < kNumCameras; ++i) answer(*cameras[i], numbers[i]);
        }
    }
    static void answer(const FakeConnection& camera, std::uint64_t number) {
        const auto alpha = camera.plane(56, 1);
        std::ranges::fill(alpha, std::uint8_t{0});
        for (int y = kBodyTop; y < kBodyTop + kBodySize; ++y)
            std::fill_n(alpha.begin() + y * static_cast<std::ptrdiff_t>(camera.width()) + kBodyLeft,
                        kBodySize,
                        std::uint8_t{255});
        camera.send(camera.message(2, number));
    }

    FakeWorker worker_;
    std::jthread thread_;
};

class PipelineWithWorker : public testing::Test {
protected:
    Expected<Pipeline> make(double deadline_ms) {
        PipelineOptions options;
        options.worker = {path_, deadline_ms, std::chrono::milliseconds(0)};
        return Pipeline::create(room_, options, {});
    }

    atrium::test::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "worker";
    GreyRoom room_;
};

TEST_F(PipelineWithWorker, GivesThePicturesOfAnInstantTogetherWhateverTheThreads) {
    for (const std::size_t num_threads : {1, 2, 4}) {
        const BatchWorker worker(path_);
        auto pipeline = make(60'000.0);
        ASSERT_TRUE(pipeline) << pipeline.error().message;
        ThreadPool pool(num_threads);
        Pipeline::Silhouettes silhouettes;
        for (std::uint64_t instant = 1; instant <= 5; ++instant) {
            const auto found = pipeline->find_silhouettes(
                room_.take(std::int64_t(instant)), pool.background(), silhouettes);
            ASSERT_TRUE(found) << found.error().message;
            for (std::size_t camera = 0; camera < kNumCameras; ++camera) {
                const auto outlines = silhouettes.delivered_outlines(camera);
                ASSERT_EQ(outlines.size(), 1u);
                for (const Eigen::Vector2d& at : outlines[0]) {
                    EXPECT_NEAR(at.x(), kBodyLeft + 0.5 * (kBodySize - 1), 0.5 * kBodySize + 1);
                    EXPECT_NEAR(at.y(), kBodyTop + 0.5 * (kBodySize - 1), 0.5 * kBodySize + 1);
                }
            }
            EXPECT_EQ(pipeline->worker()->counts(),
                      (WorkerCounts{.num_answered = instant * kNumCameras}));
        }
    }
}

// The time limits of all cameras begin together, so an instant waits for one of them, not for
// three.
TEST_F(PipelineWithWorker, WaitsForATimeLimitOnceInAnInstant) {
    constexpr double kDeadline_ms = 2000.0;
    const FakeWorker worker(path_);
    std::vector<std::unique_ptr<FakeConnection>> cameras;
    std::jthread process([&] {
        while (cameras.size() < kNumCameras) {
            cameras.push_back(worker.accept());
            cameras.back()->ready();
        }
    });
    auto pipeline = make(kDeadline_ms);
    process.join();
    ASSERT_TRUE(pipeline) << pipeline.error().message;
    SerialExecutor executor;
    Pipeline::Silhouettes silhouettes;
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_TRUE(pipeline->find_silhouettes(room_.take(1), executor, silhouettes));
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    EXPECT_EQ(pipeline->worker()->counts(), (WorkerCounts{.num_late = kNumCameras}));
    EXPECT_GE(took.count(), kDeadline_ms);
    EXPECT_LT(took.count(), 2.5 * kDeadline_ms);
    EXPECT_TRUE(silhouettes.delivered_outlines(0).empty());  // the built-in mask
}

TEST_F(PipelineWithWorker, HasNoTallyWithoutAWorker) {
    auto pipeline = Pipeline::create(room_, {}, {});
    ASSERT_TRUE(pipeline) << pipeline.error().message;
    EXPECT_EQ(pipeline->worker(), nullptr);
}

TEST_F(PipelineWithWorker, RefusesAPathThatNoSocketHas) {
    path_ = std::string(120, 'x');
    const auto pipeline = make(20.0);
    ASSERT_FALSE(pipeline);
    EXPECT_EQ(pipeline.error().kind, ErrorKind::kConfiguration);
}

}  // namespace
}  // namespace atrium::site_node
