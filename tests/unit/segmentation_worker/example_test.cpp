#include "core/base/thread_pool.hpp"
#include "core/config/rig.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/pipeline.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <iostream>

// The example worker in Python at a simulated room.
namespace atrium::site_node {
namespace {

using testing::HasSubstr;

const std::string kScript =
    atrium::test::source_dir() + "/tools/segmentation_worker/opencv_worker.py";

// A Python that has OpenCV; empty: there is none.
std::string find_python() {
    for (const std::string python : {ATRIUM_PYTHON, "/usr/bin/python3"}) {
        if (test_support::run_program(python + " -c 'import cv2, numpy'", 60).exit_code == 0)
            return python;
    }
    return {};
}

// The worker as a process.
class WorkerProcess {
public:
    // Returns once it serves, or has ended.
    WorkerProcess(const std::string& python, const std::filesystem::path& socket) {
        std::array<int, 2> ends{};
        EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
        pid_ = fork();
        if (pid_ == 0) {
            dup2(ends[1], STDERR_FILENO);
            execlp(python.c_str(),
                   python.c_str(),
                   kScript.c_str(),
                   socket.c_str(),
                   static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        output_ = ends[0];
        while (text_.find("serving at") == std::string::npos && read_on()) continue;
    }
    ~WorkerProcess() {
        end(SIGKILL);
        close(output_);
    }

    // Returns its exit code; 128 if a signal ended it, -1 if it has ended before.
    int end(int signal) {
        if (pid_ <= 0) return -1;
        kill(pid_, signal);
        return wait();
    }
    int wait() {
        while (read_on()) continue;
        int status = 0;
        waitpid(std::exchange(pid_, 0), &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    }
    const std::string& text() const { return text_; }

private:
    bool read_on() {
        std::array<char, 4096> bytes;
        const ssize_t num = read(output_, bytes.data(), bytes.size());
        if (num > 0) text_.append(bytes.data(), static_cast<std::size_t>(num));
        return num > 0;
    }

    pid_t pid_ = 0;
    int output_ = -1;
    std::string text_;  // of its stderr
};

// A room of three cameras with a person in it.
class SimulatedPictures final : public capture::FrameSource {
public:
    SimulatedPictures(config::Rig rig, simulation::RoomRenderer renderer)
        : rig_(std::move(rig)), renderer_(std::move(renderer)) {}

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token) override {
        image::YuvImage picture;
        for (const std::size_t camera : cameras) {
            for (std::uint32_t shot = 0; shot < 16; ++shot) {
                renderer_.render(0.0, camera, simulation::Scene::kEmptyRoom, shot, picture);
                if (!sink(camera, picture)) break;
            }
        }
        return std::vector<Expected<void>>(cameras.size());
    }
    Expected<void> run(std::stop_token, const Sink&) override { return {}; }

    capture::CameraFrame take(std::size_t camera, int index, image::Mask* truth) {
        auto picture = std::make_shared<image::YuvImage>();
        renderer_.render(0.7 + index / rig_.rate_hz,
                         camera,
                         simulation::Scene::kPerson,
                         static_cast<std::uint32_t>(100 + index),
                         *picture,
                         truth);
        return {camera, {index}, image::RawImage(std::move(picture)), nullptr};
    }

private:
    config::Rig rig_;
    simulation::RoomRenderer renderer_;
};

double iou(const image::Mask& a, const image::Mask& b) {
    double both = 0.0;
    double either = 0.0;
    for (std::size_t i = 0; i < a.data.size(); ++i) {
        both += a.data[i] != 0 && b.data[i] != 0;
        either += a.data[i] != 0 || b.data[i] != 0;
    }
    return either > 0.0 ? both / either : 1.0;
}

class ExampleWorker : public testing::Test {
protected:
    void SetUp() override {
        python_ = find_python();
        if (python_.empty()) GTEST_SKIP() << atrium::test::skip::kNoPythonOpenCv;
    }

    std::unique_ptr<SimulatedPictures> make_room() {
        auto rig = config::load_rig(atrium::test::source_dir() + "/deploy/rigs/full_body.toml");
        EXPECT_TRUE(rig);
        rig->cameras.resize(3);
        auto renderer = simulation::RoomRenderer::create(rig->cameras, {});
        EXPECT_TRUE(renderer) << renderer.error().message;
        return std::make_unique<SimulatedPictures>(std::move(*rig), std::move(*renderer));
    }
    PipelineOptions options() const {
        PipelineOptions made;
        made.worker = {path_, 30'000.0, std::chrono::milliseconds(0)};
        return made;
    }

    std::string python_;
    atrium::test::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "worker";
};

TEST_F(ExampleWorker, FindsThePersonInASimulatedRoom) {
    constexpr int kNumPictures = 6;
    WorkerProcess worker(python_, path_);
    const auto room = make_room();
    const auto tally = std::make_shared<segmentation_worker::WorkerTally>(30'000.0);
    auto stages = make_silhouette_stages(*room, all_cameras(*room), options(), {}, tally);
    double sum = 0.0;
    for (std::size_t camera = 0; camera < stages.size(); ++camera) {
        ASSERT_TRUE(stages[camera]) << stages[camera].error().message;
        PictureSilhouette found;
        for (int i = 0; i < kNumPictures; ++i) {
            image::Mask truth;
            const capture::CameraFrame frame = room->take(camera, i, &truth);
            ASSERT_TRUE(stages[camera]->find(frame, {}, found));
            const double agreement = iou(found.mask.mask, truth);
            EXPECT_GT(agreement, 0.85) << room->rig().cameras[camera].name << " picture " << i;
            sum += agreement;
        }
    }
    const double mean = sum / static_cast<double>(kNumPictures * stages.size());
    EXPECT_GT(mean, 0.9);
    const segmentation_worker::WorkerCounts expected{.num_answered = kNumPictures * stages.size()};
    EXPECT_EQ(tally->counts(), expected) << worker.text();
    std::cout << "IoU " << mean << ", " << tally->line() << "\n";
    stages.clear();
    EXPECT_EQ(worker.end(SIGINT), 0);
    EXPECT_FALSE(std::filesystem::exists(path_));
    EXPECT_THAT(worker.text(), testing::Not(HasSubstr("Traceback")));
}

TEST_F(ExampleWorker, MayBeKilledAndStartedAgainWhileASiteRuns) {
    auto worker = std::make_unique<WorkerProcess>(python_, path_);
    const auto room = make_room();
    auto pipeline = Pipeline::create(*room, options(), {});
    ASSERT_TRUE(pipeline) << pipeline.error().message;
    capture::Metaframe metaframe;
    for (std::size_t camera = 0; camera < 3; ++camera)
        metaframe.frames.push_back(room->take(camera, 0, nullptr));
    ThreadPool pool(2);
    Pipeline::Silhouettes silhouettes;
    const auto find = [&] {
        const auto found = pipeline->find_silhouettes(metaframe, pool.background(), silhouettes);
        ASSERT_TRUE(found) << found.error().message;
        for (std::size_t camera = 0; camera < 3; ++camera)
            EXPECT_GE(silhouettes.delivered_outlines(camera).size(), 1u);
    };
    using segmentation_worker::WorkerCounts;
    const segmentation_worker::WorkerTally& tally = *pipeline->worker();
    find();
    EXPECT_EQ(tally.counts(), (WorkerCounts{.num_answered = 3}));
    EXPECT_EQ(worker->end(SIGKILL), 128);
    find();
    EXPECT_EQ(tally.counts(), (WorkerCounts{.num_answered = 3, .num_absent = 3}));
    worker.reset();
    ASSERT_TRUE(std::filesystem::exists(path_));  // the next one replaces it
    worker = std::make_unique<WorkerProcess>(python_, path_);
    std::uint64_t num = 2;
    while (tally.counts().num_answered < 6 && num < 100'000) {
        find();
        EXPECT_EQ(tally.counts().num_pictures(), 3 * ++num);
    }
    EXPECT_EQ(tally.counts().num_invalid + tally.counts().num_late, 0u);
    EXPECT_GE(tally.counts().num_answered, 6u) << worker->text();
}

TEST_F(ExampleWorker, SaysWhatItCannotDo) {
    const WorkerProcess first(python_, path_);
    WorkerProcess second(python_, path_);
    EXPECT_EQ(second.wait(), 1);
    EXPECT_THAT(second.text(), HasSubstr("another worker serves there"));
    WorkerProcess elsewhere(python_, folder_ / "no folder/worker");
    EXPECT_EQ(elsewhere.wait(), 1);
    EXPECT_THAT(elsewhere.text(), HasSubstr("No such file or directory"));
    WorkerProcess at_script(python_, kScript);
    EXPECT_EQ(at_script.wait(), 1);
    EXPECT_THAT(at_script.text(), HasSubstr("is there already, and no socket"));
    EXPECT_TRUE(std::filesystem::exists(kScript));
    const auto help = test_support::run_program(python_ + " " + kScript + " --help", 60);
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.output, HasSubstr("segmentation.worker"));
}

}  // namespace
}  // namespace atrium::site_node
