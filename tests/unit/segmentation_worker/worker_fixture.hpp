#pragma once

#include "site_node/segmentation_worker/worker_client.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/segmentation_worker/fake_worker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>

namespace atrium::segmentation_worker {

inline constexpr int kRoomWidth = 64, kRoomHeight = 48;
inline constexpr double kShort_ms = 5.0;      // of workers that do not answer
inline constexpr double kLong_ms = 60'000.0;  // of workers that do

inline image::YuvImage grey(std::uint8_t luma) {
    return {image::Plane(kRoomWidth, kRoomHeight, luma),
            image::Plane(kRoomWidth / 2, kRoomHeight / 2, 100),
            image::Plane(kRoomWidth / 2, kRoomHeight / 2, 140)};
}

inline segmentation::BackgroundModel learned_room() {
    segmentation::BackgroundLearner learner;
    EXPECT_TRUE(learner.add(grey(90)));
    return learner.finish(segmentation::SegmentationOptions{}).value();
}

// A camera of a site. The tests are worker and site in turn, in one thread: nothing of either
// waits for the other.
class Site {
public:
    Site(const std::filesystem::path& socket,
         double deadline_ms,
         std::shared_ptr<WorkerTally> tally = nullptr,
         std::chrono::milliseconds retry_after = std::chrono::milliseconds(0))
        : tally_(tally ? std::move(tally) : std::make_shared<WorkerTally>(deadline_ms)),
          client_(WorkerClient::create({socket, deadline_ms, retry_after},
                                       {"north", kRoomWidth, kRoomHeight, {}},
                                       {},
                                       tally_)
                      .value()) {
        mask_.mask = image::Mask(kRoomWidth, kRoomHeight, kBuiltIn);
    }

    WorkerClient& client() { return *client_; }
    WorkerCounts counts() const { return tally_->counts(); }
    WorkerTally& tally() { return *tally_; }

    // Returns whether the worker got it.
    bool offer(std::uint8_t luma = 120) {
        if (!client_->wants_picture()) return false;
        picture_ = grey(luma);
        const auto image = std::make_shared<image::YuvImage>(picture_);
        client_->offer(image::RawImage(image), *image, {1000 + luma}, model_, {});
        return true;
    }
    // Returns whether the mask is the worker's.
    bool take() {
        mask_.mask = image::Mask(kRoomWidth, kRoomHeight, kBuiltIn);
        mask_.forget();
        const bool has_alpha = client_->take({}, mask_);
        client_->keep_last(mask_.mask);
        if (!has_alpha) {
            EXPECT_THAT(mask_.mask.data, testing::Each(kBuiltIn));
        }
        return has_alpha;
    }
    const image::Mask& mask() const { return mask_.mask; }
    const image::YuvImage& picture() const { return picture_; }
    const segmentation::BackgroundModel& model() const { return model_; }

    static constexpr std::uint8_t kBuiltIn = 7;  // no value of a worker's mask

private:
    std::shared_ptr<WorkerTally> tally_;
    std::unique_ptr<WorkerClient> client_;
    segmentation::BackgroundModel model_ = learned_room();
    image::YuvImage picture_;
    image::SparseMask mask_;
};

class Worker : public testing::Test {
protected:
    // A site whose worker is ready.
    std::unique_ptr<test::FakeConnection> connect(Site& site, const test::FakeWorker& worker) {
        EXPECT_FALSE(site.client().is_ready());
        auto connection = worker.accept();
        connection->ready();
        EXPECT_TRUE(site.client().is_ready());
        return connection;
    }

    test::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "worker";
};

}  // namespace atrium::segmentation_worker
