#include "core/gl/offscreen_context.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/world/load_world.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/scene/scene_view.hpp"
#include "world_server/world_server.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

// A model and a texture change while the viewer stays open and the world server is started again.
namespace atrium {
namespace {

namespace fs = std::filesystem;
using test_support::comes_true;

constexpr double kSmall_m = 0.21;
constexpr double kLarge_m = 0.57;

bus::BusOptions changed_files_bus() {
    bus::BusOptions options;
    options.world = "changed-files-test-" + std::to_string(getpid());
    options.domain = 173;  // used by this test only
    return options;
}

class ChangedFiles : public testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(of_server_);
        write_kettle(of_server_, kSmall_m);
        write_lid(of_server_, 10);
        std::ofstream(of_server_ / "world.toml")
            << "[[object]]\nname = \"kettle\"\nshape = \"convex\"\nmodel = \"kettle.obj\"\n"
               "mass_kg = 1\nposition_m = [0, 0, 1]\ntexture = \"lid.png\"\n"
               "[[scenery]]\nname = \"stage\"\nmodel = \"kettle.obj\"\nscale = 2\n";
        context_.emplace(gl::OffscreenContext::create(16, 16).value());
        renderer_.emplace(renderer::SceneRenderer::create({.width = 64, .height = 48}).value());
    }
    void TearDown() override {
        stop_server();
        receiver_ = {};
        renderer_.reset();
        fs::remove_all(root_);
    }

    // A tetrahedron of that height.
    static void write_kettle(const fs::path& folder, double height_m) {
        std::ofstream(folder / "kettle.obj") << "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 0 0 " << height_m
                                             << "\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    }
    static void write_lid(const fs::path& folder, int grey) {
        ASSERT_TRUE(
            cv::imwrite((folder / "lid.png").string(), cv::Mat(4, 4, CV_8UC3, cv::Scalar(grey))));
    }
    void start_server() {
        auto config = test_support::load_world(of_server_ / "world.toml");
        ASSERT_TRUE(config) << config.error().message;
        config->bus = changed_files_bus();
        auto server = world_server::WorldServer::create(*config);
        ASSERT_TRUE(server) << server.error().message;
        server_ = std::move(*server);
        running_ =
            std::jthread([this](const std::stop_token& stop) { EXPECT_TRUE(server_->run(stop)); });
    }
    void stop_server() {
        running_ = {};
        server_.reset();
    }
    void open_viewer(const fs::path& models) {
        session_ = viewer::Session::create(changed_files_bus(), "onlooker").value();
        receiver_ = std::jthread([this](const std::stop_token& stop) { session_->receive(stop); });
        view_.emplace(models);
    }
    // Draws until it is true.
    bool shows(const std::function<bool()>& condition) {
        return comes_true([&] {
            view_->update(session_->take_scene(),
                          viewer::SceneTimeline::Clock::now(),
                          std::nullopt,
                          *renderer_);
            return condition();
        });
    }
    // Height of the drawn kettle; 0: none.
    double drawn_m() const {
        for (const auto& [id, object] : view_->objects()) {
            const auto mesh = view_->mesh_of(object);
            if (object.name != "kettle" || !mesh) continue;
            float height_m = 0.0F;
            for (const auto& corner : mesh->corners)
                height_m = std::max(height_m, corner.position_object.z());
            return static_cast<double>(height_m);
        }
        return 0.0;
    }
    // Height of the kettle in the physics; 0: none.
    double physical_m() const {
        for (const auto& [id, object] : view_->objects())
            if (object.name == "kettle") return object.size_m.z();
        return 0.0;
    }
    static bool is_about(double a, double b) { return std::abs(a - b) < 1e-3; }

    const fs::path root_ =
        fs::temp_directory_path() / ("atrium-changed-files-" + std::to_string(getpid()));
    const fs::path of_server_ = root_ / "server";
    std::unique_ptr<world_server::WorldServer> server_;
    std::jthread running_;
    std::unique_ptr<viewer::Session> session_;
    std::jthread receiver_;
    std::optional<gl::OffscreenContext> context_;
    std::optional<renderer::SceneRenderer> renderer_;  // destroyed before its context
    std::optional<viewer::SceneView> view_;
};

TEST_F(ChangedFiles, AreShownByAnOpenViewerOnceTheWorldIsStartedAgain) {
    open_viewer(of_server_);
    start_server();
    if (HasFatalFailure()) return;
    ASSERT_TRUE(shows([&] { return is_about(drawn_m(), kSmall_m) && view_->is_complete(); }));
    EXPECT_TRUE(is_about(physical_m(), kSmall_m));
    stop_server();
    ASSERT_TRUE(shows([&] { return view_->objects().empty(); }));
    write_kettle(of_server_, kLarge_m);
    write_lid(of_server_, 200);
    start_server();
    if (HasFatalFailure()) return;
    ASSERT_TRUE(shows([&] { return is_about(physical_m(), kLarge_m); }));
    EXPECT_TRUE(shows([&] { return is_about(drawn_m(), kLarge_m); }));
    EXPECT_EQ(view_->bad_files().differing, "");
}

TEST_F(ChangedFiles, OfAnOlderCopyAreNamedUntilTheyAreReplaced) {
    const fs::path of_viewer = root_ / "viewer";
    fs::create_directories(of_viewer);
    write_kettle(of_viewer, kLarge_m);
    write_lid(of_viewer, 200);
    open_viewer(of_viewer);
    start_server();
    if (HasFatalFailure()) return;
    EXPECT_TRUE(shows([&] { return view_->bad_files().differing == "model kettle.obj"; }));
    EXPECT_TRUE(is_about(drawn_m(), kLarge_m));
    EXPECT_TRUE(is_about(physical_m(), kSmall_m));
    const auto copy = [&](const char* file) {
        fs::copy_file(of_server_ / file, of_viewer / file, fs::copy_options::overwrite_existing);
    };
    copy("kettle.obj");
    EXPECT_TRUE(shows([&] { return is_about(drawn_m(), kSmall_m); }));
    EXPECT_TRUE(shows([&] { return view_->bad_files().differing == "texture lid.png"; }));
    copy("lid.png");
    EXPECT_TRUE(shows([&] { return view_->bad_files().differing.empty(); }));
    EXPECT_EQ(view_->bad_files().missing, "");
}

// The viewer's folder lacks the file at first.
TEST_F(ChangedFiles, ThatWereMissingAreShownOnceTheyAreThere) {
    const fs::path of_viewer = root_ / "viewer";
    fs::create_directories(of_viewer);
    write_lid(of_viewer, 10);
    open_viewer(of_viewer);
    start_server();
    if (HasFatalFailure()) return;
    EXPECT_TRUE(shows([&] { return view_->bad_files().missing == "model kettle.obj"; }));
    EXPECT_EQ(view_->bad_files().differing, "");
    write_kettle(of_viewer, kSmall_m);
    EXPECT_TRUE(shows([&] { return is_about(drawn_m(), kSmall_m); }));
    EXPECT_TRUE(shows([&] { return view_->bad_files().missing.empty(); }));
}

}  // namespace
}  // namespace atrium
