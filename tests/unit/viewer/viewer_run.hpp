#pragma once

#include "tests/unit/viewer/test_site.hpp"
#include "viewer/viewer.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <thread>

namespace atrium::viewer {

using namespace std::chrono_literals;

/// A headless viewer on its own thread, with a site and a world on this one.
class ViewerRun : public testing::Test {
protected:
    void SetUp() override {
        std::filesystem::create_directories(folder_);
        config_.bus.world = "viewer_test_" + std::to_string(getpid());
        config_.headless = true;
        config_.view.width = 320;
        config_.view.height = 180;
        config_.view.position_m = "3,0,1.2";
        config_.view.target_m = "0,0,1.2";
        config_.output = folder_ / "last.png";
        auto participant = bus::Participant::create(config_.bus);
        ASSERT_TRUE(participant) << participant.error().message;
        participant_.emplace(std::move(*participant));
    }
    void TearDown() override {
        finish();
        std::filesystem::remove_all(folder_);
    }

    void start() {
        auto viewer = Viewer::create(config_);
        ASSERT_TRUE(viewer) << viewer.error().message;
        viewer_ = std::move(*viewer);
        thread_ = std::jthread([this](std::stop_token stop) { result_ = viewer_->run(stop); });
    }
    void finish() {
        if (!thread_.joinable()) return;
        thread_.request_stop();
        thread_.join();
    }
    // Waits for the other side, for a limited time.
    static bool eventually(const std::function<bool()>& condition) {
        const auto deadline = std::chrono::steady_clock::now() + 20s;
        while (std::chrono::steady_clock::now() < deadline) {
            if (condition()) return true;
            std::this_thread::sleep_for(20ms);
        }
        return false;
    }
    template <typename Message>
    bus::Writer<Message> writer() {
        auto created = bus::Writer<Message>::create(*participant_);
        EXPECT_TRUE(created) << created.error().message;
        return std::move(*created);
    }
    // A source of the frames of alice. It announces itself when created; each `send` is a frame.
    class Site {
    public:
        explicit Site(ViewerRun& run)
            : descriptions_(run.writer<bus::SiteDescription>()),
              meshes_(run.writer<bus::SiteMesh>()),
              textures_(run.writer<bus::CameraTexture>()) {
            EXPECT_TRUE(descriptions_.write(test_site::description("alice")));
        }
        void send() {
            const test_site::Frame frame = test_site::frame("alice", ++frame_id_, 230);
            EXPECT_TRUE(meshes_.write(frame.mesh));
            for (const auto& texture : frame.textures) EXPECT_TRUE(textures_.write(texture));
        }

    private:
        bus::Writer<bus::SiteDescription> descriptions_;
        bus::Writer<bus::SiteMesh> meshes_;
        bus::Writer<bus::CameraTexture> textures_;
        std::uint64_t frame_id_ = 0;
    };
    // Sends frames until that many more are shown.
    bool show(Site& site, std::uint64_t num) {
        const std::uint64_t until = viewer_->status().num_pairs_shown + num;
        return eventually([&] {
            site.send();
            return viewer_->status().num_pairs_shown >= until;
        });
    }
    cv::Vec3b centre_of_output() const {
        const cv::Mat picture = cv::imread(config_.output.string());
        EXPECT_EQ(picture.size(), cv::Size(320, 180));
        return picture.empty() ? cv::Vec3b() : picture.at<cv::Vec3b>(90, 160);
    }

    const std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("atrium_viewer_run_" + std::to_string(getpid()));
    ViewerConfig config_;
    std::optional<bus::Participant> participant_;
    std::unique_ptr<Viewer> viewer_;
    Expected<void> result_;
    std::jthread thread_;
};

}  // namespace atrium::viewer
