#pragma once

#include "core/app/log.hpp"
#include "core/base/latest_slot.hpp"
#include "core/base/statistics.hpp"
#include "site_node/capture/metaframe.hpp"
#include "site_node/preview/preview_picture.hpp"
#include "site_node/preview/preview_window.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace atrium::preview {

/// The target that means a window instead of a file.
inline constexpr const char* kWindow = "window";

/// Shows all views with their silhouettes, in a file once a second or in a window. Runs on its own
/// thread of lowest priority. Metaframes in between cost only a count.
class Preview {
public:
    /// `target` is a PNG, or kWindow; if no window can be opened, preview.png in the current
    /// folder.
    Preview(std::filesystem::path target, std::vector<std::string> camera_names);
    ~Preview();

    /// True if something new may be shown: the last picture is drawn, and a second has passed, of a
    /// window a tenth.
    bool wants_shot() const { return wants_shot_; }

    /// Shows views with captions; newest wins. Shares the pictures without copies.
    void show(std::vector<View> views);

    /// Counts the pictures of a metaframe. Returns true if `show` should follow with it.
    bool count(const capture::Metaframe& metaframe);

    /// Shows a metaframe; newest wins. `outlines_px[camera]` as in View; ignored for cameras
    /// without a picture. Shares the pictures without copies.
    void show(const capture::Metaframe& metaframe,
              std::vector<std::vector<std::vector<Eigen::Vector2d>>> outlines_px);

    std::uint64_t num_written() const { return num_written_; }

private:
    using Clock = std::chrono::steady_clock;
    struct Shot {
        std::vector<View> views;
        std::vector<std::uint64_t> num_pictures;  // per camera, since the start
        Clock::time_point time;
    };
    void run(std::stop_token stop);
    void write_pictures(std::stop_token stop);
    void show_in(PreviewWindow& window, std::stop_token stop);
    void draw_shot(std::optional<Shot>& shot);

    std::filesystem::path target_;
    std::vector<std::string> camera_names_;
    std::vector<std::uint64_t> num_pictures_;  // per camera; only the counting thread uses it
    std::vector<RateMeter> rates_;             // per camera; only the drawing thread uses it
    std::atomic<bool> wants_shot_{true};
    std::atomic<std::uint64_t> num_written_{0};
    LatestSlot<Shot> slot_;
    Picture picture_;
    app::log::OncePerSecond complaints_;
    std::jthread thread_;  // last member: stops before the others are destroyed
};

/// Returns the area inside closed outlines by the even-odd rule [px^2]. Blobs must run
/// counter-clockwise (with +Y up) and holes clockwise.
double enclosed_area_px(const std::vector<std::vector<Eigen::Vector2d>>& outlines_px);

}  // namespace atrium::preview
