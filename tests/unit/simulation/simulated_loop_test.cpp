#include "simulation/simulated_loop.hpp"

#include "simulation/loop_cache.hpp"
#include "simulation/mapped_file.hpp"
#include "simulation/render_lock.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <future>
#include <iterator>
#include <string>
#include <thread>

namespace atrium::simulation {
namespace {

namespace fs = std::filesystem;

RoomOptions short_loop() {
    RoomOptions options;
    options.loop_s = 0.2;
    options.rate_hz = 20.0;
    options.num_empty_frames = 2;
    return options;
}

bool same(const image::PlaneView& a, const image::PlaneView& b) {
    if (a.width != b.width || a.height != b.height) return false;
    for (int y = 0; y < a.height; ++y) {
        if (!std::equal(a.row(y), a.row(y) + a.width, b.row(y))) return false;
    }
    return true;
}

bool same(const Picture& a, const Picture& b) {
    const image::YuvView p = view_of(a);
    const image::YuvView q = view_of(b);
    return same(p.y, q.y) && same(p.u, q.u) && same(p.v, q.v);
}

bool same(const SimulatedLoop& a, const SimulatedLoop& b) {
    const auto same_pictures = [](const auto& x, const auto& y) {
        return std::equal(
            x.begin(), x.end(), y.begin(), y.end(), [](const Picture& p, const Picture& q) {
                return same(p, q);
            });
    };
    return std::equal(
               a.frames.begin(), a.frames.end(), b.frames.begin(), b.frames.end(), same_pictures) &&
           std::equal(a.empty_room.begin(),
                      a.empty_room.end(),
                      b.empty_room.begin(),
                      b.empty_room.end(),
                      same_pictures);
}

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write_bytes(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

class LoopCache : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(testing::TempDir()) /
                  (std::string("atrium_loop_") + test->name() + std::to_string(::getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    CachedLoop get(const RoomOptions& options = short_loop()) {
        auto result = load_or_render_loop(cameras_, options, folder_);
        EXPECT_TRUE(result) << result.error().message;
        return result ? *std::move(result) : CachedLoop{};
    }
    fs::path file() const { return cache_file(cameras_, short_loop(), folder_); }

    std::vector<geometry::CalibratedCamera> cameras_ = ring(2, 64, 48);
    fs::path folder_;
};

TEST(SimulatedLoop, HasAllPicturesOfAllCamerasAndReportsProgress) {
    const auto cameras = ring(2, 64, 48);
    std::size_t last = 0;
    std::size_t all = 0;
    const auto loop =
        render_loop(cameras, short_loop(), [&](std::size_t num_done, std::size_t num_pictures) {
            EXPECT_EQ(num_done, last + 1);
            last = num_done;
            all = num_pictures;
        });
    ASSERT_TRUE(loop) << loop.error().message;
    ASSERT_EQ(loop->frames.size(), 4u);
    for (const auto& instant : loop->frames) EXPECT_EQ(instant.size(), 2u);
    ASSERT_EQ(loop->empty_room.size(), 2u);
    for (const auto& shots : loop->empty_room) EXPECT_EQ(shots.size(), 2u);
    EXPECT_EQ(last, 12u);
    EXPECT_EQ(all, 12u);
    EXPECT_FALSE(same(loop->frames[0][0], loop->frames[1][0]));
}

TEST(SimulatedLoop, StopsOnRequest) {
    std::stop_source stop;
    std::size_t done = 0;
    const auto loop = render_loop(
        ring(2, 64, 48),
        short_loop(),
        [&](std::size_t num_done, std::size_t) {
            done = num_done;
            if (num_done == 3) stop.request_stop();
        },
        stop.get_token());
    ASSERT_FALSE(loop);
    EXPECT_EQ(loop.error().kind, ErrorKind::kUnavailable);
    EXPECT_EQ(done, 3u);
}

TEST_F(LoopCache, RoundTripIsExact) {
    const CachedLoop rendered = get();
    EXPECT_FALSE(rendered.from_cache);
    EXPECT_FALSE(rendered.cache_problem);
    EXPECT_TRUE(std::filesystem::exists(rendered.written));
    const CachedLoop loaded = get();
    EXPECT_TRUE(loaded.from_cache);
    EXPECT_TRUE(same(rendered.loop, loaded.loop));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1)
        << "a partial file is left";
}

TEST_F(LoopCache, SharesTheFileBetweenBothSites) {
    get();
    const CachedLoop one = get();
    const CachedLoop other = get();
    ASSERT_TRUE(one.loop.file != nullptr && other.loop.file != nullptr);
    EXPECT_FALSE(one.loop.file->is_wanted());
    EXPECT_TRUE(same(one.loop, other.loop));
}

TEST_F(LoopCache, OneOfTwoRendersAndTheOtherWaits) {
    std::promise<void> first_renders;
    std::promise<void> second_waits;
    std::future<void> waits = second_waits.get_future();
    auto first = std::async(std::launch::async, [&] {
        return load_or_render_loop(
            cameras_, short_loop(), folder_, [&](std::size_t num_done, auto) {
                if (num_done != 1) return;
                first_renders.set_value();
                waits.wait();
            });
    });
    first_renders.get_future().wait();
    std::size_t num_rendered = 0;
    const auto second =
        load_or_render_loop(cameras_, short_loop(), folder_, [&](auto, std::size_t num_pictures) {
            if (num_pictures == 0)
                second_waits.set_value();
            else
                ++num_rendered;
        });
    ASSERT_TRUE(second);
    EXPECT_TRUE(second->from_cache);
    EXPECT_EQ(num_rendered, 0u);
    const auto rendered = first.get();
    ASSERT_TRUE(rendered);
    EXPECT_FALSE(rendered->from_cache);
    EXPECT_TRUE(same(rendered->loop, second->loop));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(LoopCache, WaitingEndsOnRequest) {
    const RenderLock held = RenderLock::wait(file(), {}, {});
    std::stop_source stop;
    const auto second = load_or_render_loop(
        cameras_,
        short_loop(),
        folder_,
        [&](auto, auto) { stop.request_stop(); },
        stop.get_token());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
}

TEST_F(LoopCache, OutlivesReplacingAndRemovingTheFile) {
    const CachedLoop rendered = get();
    const CachedLoop loaded = get();
    write_bytes(folder_ / "new", "other content");
    fs::rename(folder_ / "new", file());
    EXPECT_FALSE(loaded.loop.file->is_wanted());
    EXPECT_TRUE(same(rendered.loop, loaded.loop));
    fs::remove(file());
    EXPECT_TRUE(same(rendered.loop, loaded.loop));
}

// A process that truncates the file must wait until the loop has been copied into memory.
TEST_F(LoopCache, CopiesThePicturesToMemoryBeforeTruncation) {
    const CachedLoop rendered = get();
    CachedLoop loaded = get();
    EXPECT_FALSE(copy_to_memory_if_wanted(loaded.loop));
    std::atomic<bool> is_cut{false};
    std::jthread cutter([&] {
        fs::resize_file(file(), 40);
        is_cut = true;
    });
    while (!loaded.loop.file->is_wanted()) std::this_thread::yield();
    EXPECT_FALSE(is_cut);
    EXPECT_TRUE(same(rendered.loop, loaded.loop)) << "the loop must be intact";
    {
        const Picture in_use = loaded.loop.frames.front().front();
        EXPECT_TRUE(copy_to_memory_if_wanted(loaded.loop));
        EXPECT_TRUE(loaded.loop.file == nullptr);
        EXPECT_FALSE(is_cut) << "a picture of the file is still in use";
        EXPECT_TRUE(same(in_use, rendered.loop.frames.front().front()));
    }
    cutter.join();
    EXPECT_EQ(fs::file_size(file()), 40u);
    EXPECT_TRUE(same(rendered.loop, loaded.loop));
    EXPECT_FALSE(copy_to_memory_if_wanted(loaded.loop));
}

TEST_F(LoopCache, ReadsAFileThatCannotBeLeased) {
    const CachedLoop rendered = get();
    const std::ofstream writer(file(), std::ios::binary | std::ios::app);  // prevents leases
    const CachedLoop loaded = get();
    EXPECT_TRUE(loaded.from_cache);
    EXPECT_TRUE(loaded.loop.file == nullptr);
    EXPECT_TRUE(same(rendered.loop, loaded.loop));
}

TEST_F(LoopCache, RendersAgainIfTheFileIsTruncatedDamagedOrForeign) {
    const CachedLoop rendered = get();
    const std::string good = bytes_of(file());
    ASSERT_GT(good.size(), 1000u);
    const auto flipped = [&](std::size_t at) {
        std::string bytes = good;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x40);
        return bytes;
    };
    const std::vector<std::pair<std::string, std::string>> broken = {
        {"empty", ""},
        {"header alone", good.substr(0, 32)},
        {"one byte short", good.substr(0, good.size() - 1)},
        {"one byte long", good + "x"},
        {"magic", flipped(3)},
        {"version", flipped(15)},
        {"key", flipped(17)},
        {"size", flipped(25)},
        {"first pixel", flipped(32)},
        {"a pixel", flipped(good.size() / 2)},
        {"checksum", flipped(good.size() - 3)},
        {"foreign", std::string(good.size(), 'x')}};
    for (const auto& [what, bytes] : broken) {
        write_bytes(file(), bytes);
        EXPECT_FALSE(read_cached_loop(file(), cameras_, short_loop())) << what;
    }
    const CachedLoop again = get();
    EXPECT_FALSE(again.from_cache);
    EXPECT_TRUE(same(rendered.loop, again.loop));
    EXPECT_EQ(bytes_of(file()), good) << "the good file must be restored";
}

TEST_F(LoopCache, SeparatesLoopsByRoomAndRig) {
    const fs::path original = file();
    std::vector<fs::path> others;
    const auto with = [&](auto change) {
        RoomOptions options = short_loop();
        change(options);
        others.push_back(cache_file(cameras_, options, folder_));
    };
    with([](auto& o) { o.num_people = 2; });
    with([](auto& o) { o.look = "ben"; });
    with([](auto& o) { o.motion = "push"; });
    with([](auto& o) { o.loop_s = 0.25; });
    with([](auto& o) { o.rate_hz = 25.0; });
    with([](auto& o) { o.noise_lsb = 1.0; });
    with([](auto& o) { o.seed = 9; });
    with([](auto& o) { o.position_m.x() = 0.1; });
    with([](auto& o) { o.heading_rad = 0.1; });
    with([](auto& o) { o.num_empty_frames = 3; });
    auto moved = cameras_;
    moved[1].camera_from_site.translation.z() += 0.001;
    others.push_back(cache_file(moved, short_loop(), folder_));
    auto distorted = cameras_;
    distorted[0].intrinsics.distortion[4] = 0.01;
    others.push_back(cache_file(distorted, short_loop(), folder_));
    others.push_back(original);
    std::sort(others.begin(), others.end());
    EXPECT_EQ(std::adjacent_find(others.begin(), others.end()), others.end());
}

TEST_F(LoopCache, KeepsOnlyAFewLoops) {
    fs::create_directories(folder_);
    for (int i = 0; i < 9; ++i) {
        const fs::path old = folder_ / ("old" + std::to_string(i) + ".atriumloop");
        write_bytes(old, "x");
        fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(24 - i));
    }
    write_bytes(folder_ / "of_someone_else.txt", "x");
    get();
    std::size_t num_loops = 0;
    for (const auto& entry : fs::directory_iterator(folder_))
        num_loops += entry.path().extension() == ".atriumloop";
    EXPECT_EQ(num_loops, kMaxCachedLoops);
    EXPECT_TRUE(fs::exists(file()));
    EXPECT_TRUE(fs::exists(folder_ / "of_someone_else.txt"));
    EXPECT_FALSE(fs::exists(folder_ / "old0.atriumloop"));
}

TEST_F(LoopCache, RendersWithoutAWritableCache) {
    write_bytes(folder_, "a file where the folder should be");
    const CachedLoop rendered = get();
    EXPECT_FALSE(rendered.from_cache);
    ASSERT_TRUE(rendered.cache_problem);
    EXPECT_THAT(rendered.cache_problem->message, testing::HasSubstr(folder_.string()));
    EXPECT_EQ(rendered.loop.frames.size(), 4u);
}

}  // namespace
}  // namespace atrium::simulation
