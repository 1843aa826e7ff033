#include "site_node/preview/preview.hpp"

#include "core/base/thread_priority.hpp"

#include <pthread.h>

#include <condition_variable>
#include <mutex>
#include <utility>

namespace atrium::preview {
namespace {

constexpr auto kFilePeriod = std::chrono::seconds(1);
constexpr auto kWindowPeriod = std::chrono::milliseconds(100);
constexpr const char* kFileInsteadOfWindow = "preview.png";

class Alarm {
public:
    void wait_until(std::chrono::steady_clock::time_point due, const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        never_.wait_until(lock, stop, due, [] { return false; });
    }

private:
    std::mutex mutex_;
    std::condition_variable_any never_;
};

}  // namespace

double enclosed_area_px(const std::vector<std::vector<Eigen::Vector2d>>& outlines_px) {
    double twice = 0.0;
    for (const auto& outline : outlines_px) {
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const Eigen::Vector2d& a = outline[i];
            const Eigen::Vector2d& b = outline[i + 1 < outline.size() ? i + 1 : 0];
            twice += a.x() * b.y() - a.y() * b.x();
        }
    }
    return 0.5 * twice;
}

Preview::Preview(std::filesystem::path target, std::vector<std::string> camera_names)
    : target_(std::move(target)),
      camera_names_(std::move(camera_names)),
      num_pictures_(camera_names_.size(), 0),
      rates_(camera_names_.size()),
      thread_([this](std::stop_token stop) { run(stop); }) {
    pthread_setname_np(thread_.native_handle(), "preview");
}

Preview::~Preview() {
    thread_.request_stop();
    thread_.join();
}

bool Preview::count(const capture::Metaframe& metaframe) {
    for (const capture::CameraFrame& frame : metaframe.frames)
        num_pictures_[frame.camera] += frame.image.empty() ? 0 : 1;
    return wants_shot_;
}

void Preview::show(const capture::Metaframe& metaframe,
                   std::vector<std::vector<std::vector<Eigen::Vector2d>>> outlines_px) {
    Shot shot;
    shot.time = Clock::now();
    shot.num_pictures = num_pictures_;
    for (const capture::CameraFrame& frame : metaframe.frames) {
        View& view = shot.views.emplace_back();
        view.name = camera_names_[frame.camera];
        view.image = frame.image;
        if (!frame.image.empty()) view.outlines_px = std::move(outlines_px[frame.camera]);
    }
    wants_shot_ = false;
    slot_.put(std::move(shot));
}

void Preview::show(std::vector<View> views) {
    Shot shot;
    shot.time = Clock::now();
    shot.num_pictures = num_pictures_;
    shot.views = std::move(views);
    wants_shot_ = false;
    slot_.put(std::move(shot));
}

// Releases the camera buffers before the slow part.
void Preview::draw_shot(std::optional<Shot>& shot) {
    for (std::size_t i = 0; i < shot->views.size(); ++i) {
        View& view = shot->views[i];
        if (!view.caption.empty()) continue;
        view.frames_per_s = rates_[i].update(shot->num_pictures[i], shot->time);
        if (view.image.empty()) continue;
        view.foreground_share = enclosed_area_px(view.outlines_px) /
                                (static_cast<double>(view.image.width) * view.image.height);
    }
    draw(shot->views, picture_);
    shot.reset();
}

void Preview::run(std::stop_token stop) {
    lower_thread_priority();
    if (target_ != kWindow) return write_pictures(stop);
    const auto window = PreviewWindow::open("Atrium: views of the site");
    if (window) return show_in(**window, stop);
    target_ = kFileInsteadOfWindow;
    app::log::info("{}; written to {}", window.error().message, target_.string());
    write_pictures(stop);
}

void Preview::write_pictures(std::stop_token stop) {
    Alarm alarm;
    auto due = Clock::now();
    while (auto shot = slot_.take(stop)) {
        draw_shot(shot);
        if (auto written = write_png(target_, picture_); written) {
            ++num_written_;
        } else {
            complaints_.warn(written.error().message);
        }
        due = std::max(due + kFilePeriod, Clock::now());
        alarm.wait_until(due, stop);
        wants_shot_ = true;
    }
}

// Requests no further shots once the window is closed.
void Preview::show_in(PreviewWindow& window, std::stop_token stop) {
    Alarm alarm;
    while (!stop.stop_requested() && window.stays_open()) {
        const auto due = Clock::now() + kWindowPeriod;
        if (auto shot = slot_.try_take()) {
            draw_shot(shot);
            window.show(picture_);
            wants_shot_ = true;
        }
        alarm.wait_until(due, stop);
    }
    wants_shot_ = false;
}

}  // namespace atrium::preview
