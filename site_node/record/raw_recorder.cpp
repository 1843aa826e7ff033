#include "site_node/record/raw_recorder.hpp"

#include "core/app/log.hpp"
#include "core/base/named_thread.hpp"
#include "core/base/next_second.hpp"
#include "core/base/thread_priority.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <numeric>
#include <string>
#include <utility>

namespace atrium::record {
namespace {

namespace fs = std::filesystem;

constexpr int kNicer = 10;  // the writers than the site

double megabytes(std::uint64_t bytes) { return 1e-6 * static_cast<double>(bytes); }

std::uint64_t whole(double value) { return static_cast<std::uint64_t>(std::max(value, 0.0)); }

RecordedPictures sum_of_all(const std::vector<RecordedPictures>& cameras) {
    RecordedPictures sum;
    for (const RecordedPictures& camera : cameras) {
        sum.num_written += camera.num_written;
        sum.num_dropped += camera.num_dropped;
        sum.num_lost += camera.num_lost;
        sum.num_bytes += camera.num_bytes;
        sum.num_raw_bytes += camera.num_raw_bytes;
    }
    return sum;
}

fs::path existing_parent(const fs::path& folder) {
    std::error_code failure;
    fs::path existing = fs::absolute(folder, failure);
    while (!fs::exists(existing, failure) && existing.has_relative_path())
        existing = existing.parent_path();
    return existing;
}

std::string disk_full_text(const fs::path& folder, std::uint64_t free, std::uint64_t min_free) {
    return fmt::format(
        "{}: the disk is nearly full: {:.0f} MB are free, record.min_free_mb keeps {:.0f} MB; free "
        "some space there, or record to another disk",
        folder.string(),
        megabytes(free),
        megabytes(min_free));
}

}  // namespace

Expected<void> check_memory(const RecorderOptions& options, std::size_t num_cameras) {
    const double bytes_per_s = static_cast<double>(options.bytes_per_instant) * options.rate_hz;
    const double wanted = bytes_per_s * (options.queue_s + options.pre_roll_s);
    const auto memory = static_cast<double>(options.memory_bytes);
    if (wanted <= memory) return {};
    const double possible_s = memory / bytes_per_s - options.queue_s;
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format("record.memory_mb: {} cameras deliver {:.0f} MB/s: a queue of {:g} s and a "
                    "pre-roll of {:g} s need {:.0f} MB, allowed are {:.0f} MB; raise "
                    "record.memory_mb, or lower record.pre_roll_s to {:.1f}",
                    num_cameras,
                    1e-6 * bytes_per_s,
                    options.queue_s,
                    options.pre_roll_s,
                    std::ceil(1e-6 * wanted),
                    std::floor(1e-6 * memory),
                    std::max(0.0, std::floor(10.0 * possible_s) / 10.0)));
}

Expected<std::unique_ptr<RawRecorder>> RawRecorder::create(RecordedRoom room,
                                                           const RecorderOptions& options,
                                                           FileCalls calls) {
    if (auto fits = check_memory(options, room.rig.cameras.size()); !fits)
        return tl::unexpected(fits.error());
    PictureQueue::Options queue;
    queue.num_writers = static_cast<std::size_t>(std::max(options.num_threads, 1));
    queue.queue_bytes =
        whole(static_cast<double>(options.bytes_per_instant) * options.rate_hz * options.queue_s);
    queue.ring_bytes = options.memory_bytes - queue.queue_bytes;
    queue.ring_time = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * options.pre_roll_s));
    // a limit of the user (ulimit -f) is reported as a full disk, instead of ending the site
    std::signal(SIGXFSZ, SIG_IGN);
    return std::unique_ptr<RawRecorder>(
        new RawRecorder(std::move(room), options, std::move(calls), queue));
}

RawRecorder::RawRecorder(RecordedRoom room,
                         const RecorderOptions& options,
                         FileCalls calls,
                         const PictureQueue::Options& queue)
    : room_(std::move(room)),
      options_(options),
      calls_(std::move(calls)),
      queue_(queue),
      numbers_(room_.rig.cameras.size(),
               std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / options.rate_hz))),
      next_(room_.rig.cameras.size()),
      picture_bytes_(room_.rig.cameras.size()) {
    for (std::size_t i = 0; i < queue.num_writers; ++i) {
        threads_.push_back(named_thread(
            "record", [this, i](const std::stop_token& stop) { write_pictures(i, stop); }));
    }
    threads_.push_back(
        named_thread("recorder", [this](const std::stop_token& stop) { look_after(stop); }));
}

RawRecorder::~RawRecorder() {
    if (auto stopped = stop(); !stopped) app::log::debug("{}", stopped.error().message);
}

std::uint64_t RawRecorder::bytes_per_s() const {
    return whole(static_cast<double>(options_.bytes_per_instant) * options_.rate_hz);
}

void RawRecorder::add(const capture::CameraFrame& frame) {
    const auto arrival = std::chrono::steady_clock::now();
    if (frame.found != nullptr) return;  // of a camera node, which has the picture
    PictureToWrite picture;
    picture.camera = frame.camera;
    picture.capture_time = frame.capture_time;
    Session session;
    std::optional<std::chrono::nanoseconds> step_back;
    const std::lock_guard adding(add_mutex_);
    {
        const std::lock_guard lock(mutex_);
        session = session_;
        if (session == nullptr && options_.pre_roll_s <= 0.0) return;
        if (frame.is_lost()) {
            numbers_.note_lost(frame.capture_time, arrival);
            return;
        }
        picture.number = numbers_.number(frame.camera, frame.capture_time, arrival);
        step_back = numbers_.take_step_back();
        const std::uint64_t expected = std::max(next_[frame.camera], base_);
        next_[frame.camera] = picture.number + 1;
        if (session != nullptr) {
            if (picture.number < base_) return;  // of an instant before the start
            if (picture.number > expected)
                session->note_lost(frame.camera, picture.number - expected);
            picture.number -= base_;
        }
    }
    if (step_back) {
        app::log::warn(
            "clock_set_back by_s={:.3f} advice=\"the recording goes on, its times step back, too\"",
            1e-3 * milliseconds(*step_back));
    }
    picture.layout = capture::layout_of(frame.image);
    std::optional<std::vector<std::uint8_t>> memory;
    if (capture::is_valid(picture.layout) && (session == nullptr || is_kept(picture)))
        memory = queue_.reserve(capture::packed_bytes(picture.layout));
    if (!memory) {
        if (session) session->note_dropped(picture.camera, picture.number, picture.capture_time);
        return;
    }
    picture.packed = std::move(*memory);
    // a copy: drivers have few buffers
    capture::pack(frame.image, picture.packed);
    queue_.add(std::move(picture), std::move(session));
}

// Of an instant all pictures are kept or none: parts of many instants are worth less than some
// whole ones.
bool RawRecorder::is_kept(const PictureToWrite& picture) {
    constexpr std::size_t kMostDecided = 64;
    picture_bytes_[picture.camera] = capture::packed_bytes(picture.layout);
    if (!newest_instant_ || picture.number > *newest_instant_) {
        newest_instant_ = picture.number;
        const std::size_t bytes =
            std::accumulate(picture_bytes_.begin(), picture_bytes_.end(), std::size_t{0});
        if (!queue_.has_room(bytes)) {
            if (dropped_instants_.size() == kMostDecided) dropped_instants_.pop_front();
            dropped_instants_.push_back(picture.number);
        }
    }
    return std::ranges::find(dropped_instants_, picture.number) == dropped_instants_.end();
}

Expected<void> RawRecorder::start(const fs::path& folder) {
    const std::lock_guard control(control_mutex_);
    if (is_recording()) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("--record: '{}': already recording into '{}'",
                                      folder.string(),
                                      last_session_->folder().string()));
    }
    const std::uint64_t free = calls_.free_bytes(existing_parent(folder));
    if (free < options_.min_free_bytes + bytes_per_s()) {
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format(
                "--record: {}: the disk is nearly full: {:.0f} MB are free, at least {:.0f} "
                "MB are needed: record.min_free_mb and one second; free some space there, "
                "or record to another disk",
                folder.string(),
                megabytes(free),
                std::ceil(megabytes(options_.min_free_bytes + bytes_per_s()))));
    }
    auto created = RecordingSession::create(folder, room_, options_.codec, calls_);
    if (!created) return tl::unexpected(created.error());
    const Session session = std::move(*created);
    {
        const std::scoped_lock lock(add_mutex_, mutex_);
        begin_numbers(session);
        newest_instant_.reset();
        dropped_instants_.clear();
        session_ = last_session_ = session;
    }
    app::log::info(
        "recording folder={} codec={} cameras={} raw_mb_per_s={:.0f} free_mb={:.0f} "
        "enough_for_s={:.0f}",
        folder.string(),
        capture::name_of(options_.codec),
        room_.rig.cameras.size(),
        megabytes(bytes_per_s()),
        megabytes(free),
        static_cast<double>(free - options_.min_free_bytes) /
            static_cast<double>(std::max<std::uint64_t>(bytes_per_s(), 1)));
    return {};
}

// The pre-roll counts, too. Called with `mutex_`.
void RawRecorder::begin_numbers(const Session& session) {
    const auto ring = queue_.give_ring_to(session);
    base_ = ring ? ring->first : numbers_.next();
    std::vector<std::uint64_t> num_in_ring(next_.size());
    if (ring) {
        for (const std::size_t camera : ring->cameras) ++num_in_ring[camera];
    }
    for (std::size_t camera = 0; camera < next_.size(); ++camera) {
        const std::uint64_t num_passed = next_[camera] > base_ ? next_[camera] - base_ : 0;
        if (num_passed > num_in_ring[camera])
            session->note_lost(camera, num_passed - num_in_ring[camera]);
    }
}

Expected<void> RawRecorder::stop() {
    const std::lock_guard control(control_mutex_);
    Session session;
    {
        const std::lock_guard lock(mutex_);
        session = session_;
    }
    if (session != nullptr) end(session);
    return result();
}

// Called with `control_mutex_`.
void RawRecorder::end(const Session& session) {
    {
        const std::scoped_lock lock(add_mutex_, mutex_);
        session_ = nullptr;
        // of the newest instant pictures may be on their way
        for (std::size_t camera = 0; camera < next_.size(); ++camera) {
            const std::uint64_t expected = std::max(next_[camera], base_);
            if (expected + 1 < numbers_.next())
                session->note_lost(camera, numbers_.next() - 1 - expected);
        }
    }
    queue_.wait_until_done(session);
    session->finish();
    const std::string failure = session->failure();
    const RecordedPictures sum = sum_of_all(session->counters());
    const std::string counts =
        fmt::format("folder={} pictures={} dropped={} lost={} mb={:.0f} of_raw={:.2f}",
                    session->folder().string(),
                    sum.num_written,
                    sum.num_dropped,
                    sum.num_lost,
                    megabytes(sum.num_bytes),
                    static_cast<double>(sum.num_bytes) /
                        static_cast<double>(std::max<std::uint64_t>(sum.num_raw_bytes, 1)));
    if (failure.empty()) {
        const bool is_whole = sum.num_dropped == 0;
        app::log::write(is_whole ? app::log::Level::kInfo : app::log::Level::kWarn,
                        "recorded " + counts);
        return;
    }
    app::log::error("recording_ended {} reason=\"{}\"", counts, failure);
    const std::lock_guard lock(mutex_);
    if (result_) {
        result_ = make_error(ErrorKind::kInternal,
                             fmt::format("the recording ended early: {}; what was written until "
                                         "then can be played",
                                         failure));
    }
}

bool RawRecorder::is_recording() const {
    const std::lock_guard lock(mutex_);
    return session_ != nullptr;
}

std::vector<RecordedPictures> RawRecorder::counters() const {
    const std::lock_guard lock(mutex_);
    return last_session_ ? last_session_->counters() : std::vector<RecordedPictures>();
}

Expected<void> RawRecorder::result() const {
    const std::lock_guard lock(mutex_);
    return result_;
}

void RawRecorder::write_pictures(std::size_t writer, const std::stop_token& stop) {
    // the site goes first: a metaframe cannot wait, a picture in the queue can
    lower_thread_priority(kNicer);
    while (auto item = queue_.take(writer, stop)) {
        item->session->write(item->picture);
        queue_.done(std::move(*item));
    }
}

// Once a second: what was noted, the disk, and what the log should say.
void RawRecorder::look_after(const std::stop_token& stop) {
    using Clock = std::chrono::steady_clock;
    std::mutex mutex;
    std::condition_variable_any wake;
    const auto begin = Clock::now();
    while (!stop.stop_requested()) {
        std::unique_lock lock(mutex);
        wake.wait_until(lock, stop, next_second(begin, Clock::now()), [] { return false; });
        if (stop.stop_requested()) return;
        Session session;
        {
            const std::lock_guard own(mutex_);
            session = session_;
        }
        if (session != nullptr) look(session);
    }
}

void RawRecorder::look(const Session& session) {
    session->save();
    if (told_.session != session) told_ = {session};
    const std::vector<RecordedPictures> cameras = session->counters();
    const RecordedPictures sum = sum_of_all(cameras);
    const std::uint64_t num_dropped = sum.num_dropped;
    const std::uint64_t free = calls_.free_bytes(session->folder());
    // the next second must find its place, too
    const std::uint64_t last_second = sum.num_bytes - std::exchange(told_.num_bytes, sum.num_bytes);
    if (free < options_.min_free_bytes + last_second)
        session->fail(disk_full_text(session->folder(), free, options_.min_free_bytes));
    if (session->failure().empty() && num_dropped > told_.num_dropped) {
        std::string by_camera;
        for (std::size_t i = 0; i < cameras.size(); ++i) {
            if (cameras[i].num_dropped > 0)
                by_camera +=
                    fmt::format(" {}={}", room_.rig.cameras[i].name, cameras[i].num_dropped);
        }
        drops_.warn("drops",
                    fmt::format("recording_drops_pictures dropped=\"{}\" waiting_mb={:.0f} "
                                "advice=\"the disk or the processor is too slow for record.codec "
                                "{}: docs/recording_rooms.md\"",
                                by_camera.substr(1),
                                megabytes(queue_.num_bytes_waiting()),
                                capture::name_of(options_.codec)));
        told_.num_dropped = num_dropped;
    }
    if (session->failure().empty()) return;
    const std::lock_guard control(control_mutex_);
    bool is_current = false;
    {
        const std::lock_guard lock(mutex_);
        is_current = session_ == session;
    }
    if (is_current) end(session);
}

}  // namespace atrium::record
