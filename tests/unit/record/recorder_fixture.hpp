#pragma once

#include "site_node/capture/recording_source.hpp"
#include "site_node/record/raw_recorder.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/unit/record/raw_pictures.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <fstream>
#include <iterator>
#include <limits>
#include <mutex>
#include <string>
#include <vector>

namespace atrium::record::test {

constexpr int kSide_px = 32;
constexpr std::size_t kBytes = kSide_px * kSide_px;  // of a picture

/// A recorder of two cameras with Bayer pictures at 50 Hz, and a disk that can be shut.
class RecorderOnDisk : public OwnFolder {
protected:
    RecorderOnDisk() {
        options_.codec = capture::RawCodec::kHuffYuv;
        options_.rate_hz = 50.0;
        options_.bytes_per_instant = 2 * kBytes;
        options_.min_free_bytes = 1000;
        calls_.free_bytes = [this](const std::filesystem::path&) {
            const std::lock_guard lock(mutex_);
            return free_bytes_;
        };
        calls_.write = [this](int file, const iovec* parts, int num_parts) {
            std::unique_lock lock(mutex_);
            opened_.wait(lock, [this] { return is_open_; });
            return ::writev(file, parts, num_parts);
        };
    }

    static capture::CameraFrame frame(std::size_t camera, int instant) {
        const auto seed = static_cast<std::uint64_t>(2 * instant) + camera;
        return {camera,
                {kBegin_ns + instant * 20'000'000LL + static_cast<int>(camera) * 1'000'000},
                make_picture(image::PixelFormat::kBayerGB, kSide_px, kSide_px, seed),
                nullptr};
    }
    static void add(RawRecorder& recorder, int first, int end) {
        for (int i = first; i < end; ++i) {
            for (const std::size_t camera : {0U, 1U}) recorder.add(frame(camera, i));
        }
    }

    std::unique_ptr<RawRecorder> make_recorder() {
        auto recorder = RawRecorder::create(
            {"lab", make_rig(2, kSide_px, kSide_px, 50.0), {}, "key = value\n"}, options_, calls_);
        EXPECT_TRUE(recorder) << recorder.error().message;
        return std::move(*recorder);
    }

    void shut_disk() {
        const std::lock_guard lock(mutex_);
        is_open_ = false;
    }
    void open_disk() {
        {
            const std::lock_guard lock(mutex_);
            is_open_ = true;
        }
        opened_.notify_all();
    }
    void set_free_bytes(std::uint64_t bytes) {
        const std::lock_guard lock(mutex_);
        free_bytes_ = bytes;
    }

    static std::unique_ptr<capture::RecordingSource> open(const std::filesystem::path& folder) {
        auto source = capture::RecordingSource::open({.folder = folder});
        EXPECT_TRUE(source) << source.error().message;
        return source ? std::move(*source) : nullptr;
    }
    static std::string text_of(const std::filesystem::path& file) {
        std::ifstream stream(file);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    static constexpr std::int64_t kBegin_ns = 1'800'000'000'000'000'000;
    RecorderOptions options_;
    FileCalls calls_ = system_calls();
    std::mutex mutex_;
    std::condition_variable opened_;
    bool is_open_ = true;
    std::uint64_t free_bytes_ = std::numeric_limits<std::uint64_t>::max() / 2;
};

}  // namespace atrium::record::test
