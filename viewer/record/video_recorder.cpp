#include "viewer/record/video_recorder.hpp"

#include "core/app/log.hpp"
#include "core/base/thread_priority.hpp"
#include "viewer/record/picture_file.hpp"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <system_error>

namespace atrium::viewer {
namespace {

// Refers to the picture's memory.
cv::Mat rgba_of(const renderer::RenderedPicture& picture) {
    return {picture.height, picture.width, CV_8UC4, const_cast<std::uint8_t*>(picture.rgba.data())};
}

// Scales the picture to `size`. One of another shape lies in the middle, between black bars.
void fit(const cv::Mat& rgba, const cv::Size& size, cv::Mat& fitted) {
    constexpr int kNarrowestBars = 3;  // the size of a video is rounded to even numbers
    const double scale = std::min(static_cast<double>(size.width) / rgba.cols,
                                  static_cast<double>(size.height) / rgba.rows);
    cv::Size inner(std::clamp(cvRound(scale * rgba.cols), 1, size.width),
                   std::clamp(cvRound(scale * rgba.rows), 1, size.height));
    if (size.width - inner.width < kNarrowestBars) inner.width = size.width;
    if (size.height - inner.height < kNarrowestBars) inner.height = size.height;
    fitted.create(size, CV_8UC4);
    if (inner != size) fitted.setTo(cv::Scalar(0, 0, 0, 255));
    const cv::Point corner((size.width - inner.width) / 2, (size.height - inner.height) / 2);
    cv::Mat middle = fitted(cv::Rect(corner, inner));
    cv::resize(rgba, middle, inner, 0, 0, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
}

// Leaves room to finish the video: one picture and the index of all pictures.
bool is_nearly_full(const std::filesystem::path& file) {
    if (file.empty()) return false;  // a stream
    constexpr std::uintmax_t kLeast = 8'000'000;
    std::error_code failure;
    const auto space = std::filesystem::space(file, failure);
    return !failure && space.available < kLeast;
}

}  // namespace

struct VideoRecorder::Impl {
    VideoFormat format;
    std::unique_ptr<VideoFile> file;
    cv::Mat fitted;
    Expected<void> written;  // the first error; owned by the recording thread until it ends
};

VideoRecorder::VideoRecorder(std::unique_ptr<Impl> impl)
    : impl_(std::move(impl)),
      period_(std::chrono::duration_cast<Clock::duration>(
          std::chrono::duration<double>(1.0 / impl_->format.fps))),
      thread_([this](std::stop_token stop) { record(std::move(stop)); }) {
    pthread_setname_np(thread_.native_handle(), "video");
}

VideoRecorder::~VideoRecorder() {
    if (thread_.joinable()) static_cast<void>(finish());
}

Expected<void> VideoRecorder::finish() {
    thread_.request_stop();
    thread_.join();
    const Expected<void> ended = impl_->file->finish();
    const std::string file = impl_->format.file.string();
    if (is_disk_full_) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("video {} ends after {:.1f} s: the disk is full",
                                      file,
                                      static_cast<double>(num_written_) / impl_->format.fps));
    }
    if (!impl_->written) return impl_->written;
    if (!ended) return ended;
    // OpenCV reports no write errors for .mp4, so try to read the file; without a backend it would
    // try cameras too
    if (num_written_ > 0 && !file.empty() && !cv::VideoCapture(file, cv::CAP_FFMPEG).grab())
        return make_error(ErrorKind::kUnavailable, "video " + file + " cannot be read back");
    return {};
}

Expected<std::unique_ptr<VideoRecorder>> VideoRecorder::create(const VideoFormat& format) {
    // check first: the libraries' messages for a file that cannot be written name no reason
    if (const auto ready = prepare_file(format.file); !ready) return tl::unexpected(ready.error());
    auto file = create_video_file(format);
    if (!file) return tl::unexpected(file.error());
    return start(format, std::move(*file));
}

std::unique_ptr<VideoRecorder> VideoRecorder::start(const VideoFormat& format,
                                                    std::unique_ptr<VideoFile> target) {
    auto impl = std::make_unique<Impl>();
    impl->format = format;
    impl->file = std::move(target);
    return std::unique_ptr<VideoRecorder>(new VideoRecorder(std::move(impl)));
}

std::int64_t VideoRecorder::slot_of(Clock::time_point time) const {
    return begin_ ? std::max<std::int64_t>(0, (time - *begin_) / period_) : 0;
}

VideoRecorder::Clock::time_point VideoRecorder::end_of(std::int64_t slot) const {
    return *begin_ + (slot + 1) * period_;
}

bool VideoRecorder::wants_picture(Clock::time_point now) {
    if (is_disk_full_ || has_failed_) return false;
    const std::lock_guard lock(mutex_);
    const std::int64_t slot = slot_of(now);
    if (slot <= last_slot_) return false;
    if (waiting_.size() < kMostWaiting) return true;
    last_slot_ = slot;
    ++num_dropped_;
    return false;
}

void VideoRecorder::offer(renderer::RenderedPicture picture, Clock::time_point now) {
    {
        const std::lock_guard lock(mutex_);
        if (!begin_) begin_ = now;
        last_slot_ = slot_of(now);
        waiting_.push_back({last_slot_, std::move(picture)});
    }
    offered_.notify_one();
}

renderer::RenderedPicture VideoRecorder::spent() {
    const std::lock_guard lock(mutex_);
    if (spent_.empty()) return {};
    renderer::RenderedPicture picture = std::move(spent_.back());
    spent_.pop_back();
    return picture;
}

// Repeats the last picture up to `slot`, then writes `picture` into it. Returns false if the
// recording ends.
bool VideoRecorder::write(const renderer::RenderedPicture& picture, std::int64_t slot) {
    const auto is_done = [this](Expected<void> done) {
        if (done) return true;
        app::log::warn("video_ends {}", done.error().message);
        impl_->written = std::move(done);
        has_failed_ = true;
        return false;
    };
    const auto write_frame = [&] {
        if (!is_done(impl_->file->write())) return false;
        ++num_written_;
        if (!is_nearly_full(impl_->format.file)) return true;
        is_disk_full_ = true;
        app::log::warn("video_ends file={} the disk is full", impl_->format.file.string());
        return false;
    };
    while (static_cast<std::int64_t>(num_written_) < slot) {
        if (!write_frame()) return false;
    }
    if (picture.rgba.empty()) return true;
    cv::Mat rgba = rgba_of(picture);
    const cv::Size size(impl_->format.width, impl_->format.height);
    if (rgba.size() != size) {
        fit(rgba, size, impl_->fitted);
        rgba = impl_->fitted;
    }
    if (!is_done(impl_->file->set({rgba.data, rgba.total() * rgba.elemSize()}))) return false;
    if (static_cast<std::int64_t>(num_written_) > slot) {
        ++num_dropped_;  // too late for its slot; the next slot repeats it
        return true;
    }
    return write_frame();
}

void VideoRecorder::record(std::stop_token stop) {
    // lower priority than drawing
    constexpr int kNicer = 5;
    lower_thread_priority(kNicer);
    std::unique_lock lock(mutex_);
    const auto is_offered = [this] { return !waiting_.empty(); };
    offered_.wait(lock, stop, is_offered);
    std::optional<std::int64_t> end;  // first slot after the end of the video
    while (begin_) {
        const auto next = static_cast<std::int64_t>(num_written_);
        // a picture may arrive shortly after the end of its slot, because it is read back first
        if (waiting_.empty() && !stop.stop_requested())
            offered_.wait_until(lock, stop, end_of(next) + period_, is_offered);
        if (!end && stop.stop_requested()) end = slot_of(Clock::now());
        Entry entry;
        if (!waiting_.empty()) {
            entry = std::move(waiting_.front());
            waiting_.pop_front();
        } else {
            if (end && *end <= next) return;
            entry.slot = end ? *end : slot_of(Clock::now() - period_);
        }
        lock.unlock();
        const bool goes_on = write(entry.picture, entry.slot);
        lock.lock();
        if (!entry.picture.rgba.empty() && spent_.size() < kMostWaiting)
            spent_.push_back(std::move(entry.picture));
        if (!goes_on) return;
    }
}

}  // namespace atrium::viewer
