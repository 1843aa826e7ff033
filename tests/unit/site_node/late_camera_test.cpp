#include "core/base/thread_pool.hpp"
#include "site_node/capture/metaframe_assembler.hpp"
#include "site_node/pipeline.hpp"
#include "site_node/segmentation/background_file.hpp"
#include "tests/unit/capture/aravis_fixture.hpp"

#include <filesystem>

namespace atrium::site_node {
namespace {

namespace fs = std::filesystem;
using capture::test::AravisSourceTest;
using std::chrono::milliseconds;

class LateCamera : public AravisSourceTest {
protected:
    void SetUp() override {
        AravisSourceTest::SetUp();
        folder_ =
            fs::path(testing::TempDir()) / ("atrium_late_camera_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    // A plain grey picture, as the cameras of the fixture see it.
    void keep_background(const std::string& camera) const {
        segmentation::BackgroundLearner learner;
        image::YuvImage grey(
            image::Plane(capture::test::kWidth, capture::test::kHeight, 90),
            image::Plane(capture::test::kWidth / 2, capture::test::kHeight / 2, 128),
            image::Plane(capture::test::kWidth / 2, capture::test::kHeight / 2, 128));
        for (int i = 0; i < 5; ++i) ASSERT_TRUE(learner.add(grey));
        ASSERT_TRUE(segmentation::save_background(*learner.finish(), folder_, camera));
    }

    // Three cameras side by side. A wall of noise fills their pictures.
    static config::Rig rig() {
        config::Rig rig = capture::test::rig_of(3, 20.0);
        for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
            auto& camera = rig.cameras[i];
            camera.intrinsics.fx = camera.intrinsics.fy = 100.0;
            camera.intrinsics.cx = 47.5;
            camera.intrinsics.cy = 31.5;
            camera.camera_from_site.translation.x() = 0.2 * static_cast<double>(i);
        }
        return rig;
    }

    fs::path folder_;
};

TEST_F(LateCamera, JoinsOnAppearanceIfItsBackgroundWasKept) {
    for (const char* camera : {"cam0", "cam1", "cam2"}) keep_background(camera);
    add_fake(capture::test::fake_options(0));
    add_fake(capture::test::fake_options(1));
    capture::CamerasOptions cameras = capture::test::options_of(3);
    cameras.min_cameras = 2;
    const auto source = capture::AravisSource::open(rig(), cameras, {}, {});
    ASSERT_TRUE(source) << source.error().message;
    PipelineOptions options;
    options.background.folder = folder_;
    options.hull.bounds = geometry::Aabb{{-1.0, -1.0, 1.0}, {1.0, 1.0, 3.0}};
    auto pipeline = Pipeline::create(**source, options, {});
    ASSERT_TRUE(pipeline) << pipeline.error().message;
    EXPECT_TRUE(pipeline->cameras_without_background().empty());

    capture::MetaframeAssembler assembler(3, {milliseconds(12), milliseconds(100), 2});
    ThreadPool pool(1);
    SiteFrame frame;
    bool was_without = false;
    std::atomic<bool> took_part{false};
    const auto work = [&](capture::CameraFrame picture) {
        const auto metaframe = assembler.add(std::move(picture), std::chrono::steady_clock::now());
        if (!metaframe) return;
        const auto done = pipeline->process(*metaframe, pool, frame);
        EXPECT_TRUE(done) << done.error().message;
        was_without = was_without || frame.losses.cameras == 1;
        if (was_without && frame.losses.cameras == 0) took_part = true;
    };
    capture::test::Player player(**source, work);
    ASSERT_TRUE(player.wait_for_pictures(0, 5));
    EXPECT_FALSE(took_part);
    add_fake(capture::test::fake_options(2));
    EXPECT_TRUE(player.wait([&](const auto&) { return took_part.load(); }));
}

}  // namespace
}  // namespace atrium::site_node

int main(int argc, char** argv) {
    atrium::test_support::enter_own_network(10);
    testing::InitGoogleMock(&argc, argv);
    return RUN_ALL_TESTS();
}
