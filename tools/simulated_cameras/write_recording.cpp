#include "tools/simulated_cameras/write_recording.hpp"

#include "core/base/write_check.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <system_error>
#include <vector>

namespace atrium::simulated_cameras {
namespace {

namespace fs = std::filesystem;

constexpr int kJpegQuality = 95;
constexpr std::uint64_t kLeastSpace = 64U << 20;

bool write_picture(std::span<const std::uint8_t> rgb,
                   const geometry::PinholeCamera& sensor,
                   const fs::path& file) {
    const int width = sensor.width & ~1, height = sensor.height & ~1;
    assert(rgb.size() == static_cast<std::size_t>(3 * width * height));
    cv::Mat bgr(height, width, CV_8UC3);
    for (std::size_t i = 0; i < rgb.size(); i += 3)
        for (std::size_t k = 0; k < 3; ++k) bgr.data[i + k] = rgb[i + 2 - k];
    try {
        return cv::imwrite(file.string(), bgr, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
    } catch (const cv::Exception&) {
        return false;
    }
}

Expected<void> write_text(const std::string& text, const fs::path& file) {
    errno = 0;
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) return tl::unexpected(cannot_write(file, "write", errno));
    return {};
}

}  // namespace

Expected<void> check_recording_folder(const fs::path& folder) {
    std::error_code failure;
    if (fs::exists(folder, failure) && !fs::is_empty(folder, failure))
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("write_recording: '{}' exists and is not empty; give a new "
                                      "folder",
                                      folder.string()));
    return check_folder_writable(folder, kLeastSpace, "write_recording");
}

Expected<void> write_recording(const ShownPictures& shown,
                               const fs::path& rig_file,
                               double seconds,
                               const fs::path& folder,
                               Executor& executor,
                               const std::function<void(std::size_t, std::size_t)>& progress,
                               const std::stop_token& stop) {
    assert(shown.format == image::PixelFormat::kRgb);
    const std::vector<geometry::CalibratedCamera>& cameras = shown.rig.cameras;
    std::error_code failure;
    if (auto usable = check_recording_folder(folder); !usable) return usable;
    for (const geometry::CalibratedCamera& camera : cameras)
        for (const char* kind : {"background", "frames"})
            if (!fs::create_directories(folder / camera.name / kind, failure) || failure)
                return tl::unexpected(
                    cannot_write(folder / camera.name / kind, "create", failure.value()));
    if (!fs::copy_file(rig_file, folder / "rig.toml", failure))
        return tl::unexpected(cannot_write(folder / "rig.toml", "write", failure.value()));

    std::atomic<bool> fails = false;
    const auto write_all = [&](const ShowSchedule::Choice& choice, std::size_t number) {
        const char* kind = choice.is_empty_room ? "background" : "frames";
        const auto write_one = [&](std::size_t camera, std::size_t) {
            std::vector<std::uint8_t> memory;
            const fs::path file =
                folder / cameras[camera].name / kind / fmt::format("{:06d}.jpg", number);
            if (!write_picture(
                    picture_of(shown, camera, choice, memory), cameras[camera].intrinsics, file))
                fails = true;
        };
        executor.parallel_for(cameras.size(), write_one);
    };
    for (std::size_t shot = 0; shot < shown.empty.front().size(); ++shot)
        write_all({true, shot, 0.0}, shot);
    const double rate_hz = shown.rig.rate_hz;
    const auto num = static_cast<std::size_t>(std::max(1L, std::lround(seconds * rate_hz)));
    std::string times = "frame,camera,capture_time_ns\n";
    for (std::size_t i = 0; i < num && !fails; ++i) {
        if (stop.stop_requested())
            return make_error(ErrorKind::kUnavailable,
                              fmt::format("write_recording: stopped after {} instants", i));
        const double time_s = static_cast<double>(i) / rate_hz;
        write_all({false, i % shown.num_instants(), time_s}, i);
        for (const geometry::CalibratedCamera& camera : cameras)
            times += fmt::format("{},{},{}\n", i, camera.name, std::llround(1e9 * time_s));
        if (progress) progress(i + 1, num);
    }
    if (fails)
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("write_recording: cannot write pictures into '{}'; is the "
                                      "disk full?",
                                      folder.string()));
    return write_text(times, folder / "times.csv");
}

}  // namespace atrium::simulated_cameras
