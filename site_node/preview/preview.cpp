#include "site_node/preview/preview.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <utility>

namespace atrium::preview {
namespace {

constexpr auto kPeriod = std::chrono::seconds(1);
constexpr int kLowestPriority = 19;  // of nice(2); on Linux it is the thread's own

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

Preview::Preview(std::filesystem::path file, std::vector<std::string> camera_names)
    : file_(std::move(file)),
      camera_names_(std::move(camera_names)),
      num_pictures_(camera_names_.size(), 0),
      rates_(camera_names_.size()),
      thread_([this](std::stop_token stop) { write_pictures(stop); }) {
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

void Preview::measure_rates(Shot& shot) {
    for (std::size_t i = 0; i < shot.views.size(); ++i) {
        View& view = shot.views[i];
        view.frames_per_s = rates_[i].update(shot.num_pictures[i], shot.time);
        if (view.image.empty()) continue;
        view.foreground_share = enclosed_area_px(view.outlines_px) /
                                (static_cast<double>(view.image.width) * view.image.height);
    }
}

void Preview::write_pictures(std::stop_token stop) {
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kLowestPriority);
    std::mutex mutex;
    std::condition_variable_any never;
    auto due = Clock::now();
    while (auto shot = slot_.take(stop)) {
        measure_rates(*shot);
        draw(shot->views, picture_);
        shot.reset();  // camera buffers go back before the slow part
        if (auto written = write_png(file_, picture_); written) {
            ++num_written_;
        } else {
            complaints_.warn(written.error().message);
        }
        due = std::max(due + kPeriod, Clock::now());
        std::unique_lock lock(mutex);
        never.wait_until(lock, stop, due, [] { return false; });
        wants_shot_ = true;
    }
}

}  // namespace atrium::preview
