#include "site_node/segmentation_worker/worker_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <thread>
#include <utility>

namespace atrium::segmentation_worker {

Expected<void> check(const WorkerOptions& options) {
    const std::size_t num_bytes = options.socket.native().size();
    if (num_bytes <= kMaxPathBytes) return {};
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("segmentation.worker: the path of a socket has at most {} bytes, "
                                  "got {}",
                                  kMaxPathBytes,
                                  num_bytes));
}

Expected<std::unique_ptr<WorkerClient>> WorkerClient::create(
    const WorkerOptions& options,
    const Camera& camera,
    const segmentation::SegmentationOptions& segmentation,
    std::shared_ptr<WorkerTally> tally) {
    auto shared = SharedPictures::create(layout_of(camera.width, camera.height),
                                         static_cast<std::uint32_t>(options.deadline_ms * 1e3),
                                         camera.name);
    if (!shared) return tl::unexpected(shared.error());
    return std::unique_ptr<WorkerClient>(
        new WorkerClient(options, camera, segmentation, std::move(tally), std::move(*shared)));
}

WorkerClient::WorkerClient(const WorkerOptions& options,
                           const Camera& camera,
                           const segmentation::SegmentationOptions& segmentation,
                           std::shared_ptr<WorkerTally> tally,
                           SharedPictures shared)
    : options_(options),
      name_(camera.name),
      segmentation_(segmentation),
      tally_(std::move(tally)),
      shared_(std::move(shared)),
      last_mask_(camera.width, camera.height) {
    if (!camera.areas.everywhere())
        areas_ = segmentation::rasterise(camera.areas, camera.width, camera.height);
}

bool WorkerClient::is_ready() {
    connect();
    while (socket_ && receive() != News::kNothing) continue;
    return is_ready_;
}

void WorkerClient::connect() {
    const auto now = Clock::now();
    if (socket_ || now < next_attempt_) return;
    next_attempt_ = now + options_.retry_after;
    auto made = WorkerSocket::connect(options_.socket, shared_.descriptor());
    if (!made) {
        lose(made.error());
        return;
    }
    socket_.emplace(std::move(*made));
    num_shown_ = 0;
    std::fill(last_mask_.data.begin(), last_mask_.data.end(), std::uint8_t{0});
    is_last_mask_due_ = true;
}

// Ends the connection. Says why, unless it said so last time.
WorkerClient::News WorkerClient::lose(const Error& reason) {
    socket_.reset();
    is_ready_ = false;
    asked_.reset();
    next_attempt_ = Clock::now() + options_.retry_after;
    if (reason.message != std::exchange(last_reason_, reason.message)) {
        tally_->log_missing(fmt::format(
            "segmentation_worker_missing camera={} socket={} reason=\"{}\" advice=\"the built-in "
            "segmentation serves until it is there: docs/segmentation_worker.md\"",
            name_,
            options_.socket.string(),
            reason.message));
    }
    return reason.kind == ErrorKind::kInvalidData ? News::kInvalid : News::kGone;
}

// Takes the next message.
WorkerClient::News WorkerClient::receive() {
    const auto message = socket_->receive();
    if (!message) return lose(message.error());
    if (!*message) return News::kNothing;
    if (auto fits = check(**message, shared_.layout(), is_ready_, asked_); !fits)
        return lose(fits.error());
    if ((*message)->kind == WorkerMessage::Kind::kReady) {
        is_ready_ = true;
        last_reason_.clear();
        tally_->log_there(fmt::format(
            "segmentation_worker_there camera={} socket={}", name_, options_.socket.string()));
        return News::kNone;
    }
    tally_->add_latency(Clock::now() - asked_at_);
    asked_.reset();
    return (*message)->kind == WorkerMessage::Kind::kAlpha ? News::kAlpha : News::kNone;
}

void WorkerClient::show_background(const segmentation::BackgroundModel& model,
                                   const GiveWay& give_way) {
    if (num_shown_++ % kBackgroundEvery != 0) return;
    bgr_.write(model, give_way, shared_.background());
    ++background_number_;
}

bool WorkerClient::wants_picture() {
    is_offered_ = false;
    answer_.reset();
    connect();
    News news = News::kNothing;
    while (socket_ && (news = receive()) != News::kNothing) continue;
    if (news == News::kInvalid) return count(news);
    if (!is_ready_) return count(News::kGone);
    return !asked_ || count(News::kLate);
}

void WorkerClient::offer(const image::RawImage& raw,
                         const image::YuvView& working,
                         Timestamp capture_time,
                         const segmentation::BackgroundModel& model,
                         const GiveWay& give_way) {
    assert(is_ready_ && !asked_);
    assert(working.width() == last_mask_.width && working.height() == last_mask_.height);
    assert(model.width() == working.width() && model.height() == working.height());
    show_background(model, give_way);
    bgr_.write(raw, working, give_way, shared_.picture());
    if (std::exchange(is_last_mask_due_, false))
        std::ranges::copy(last_mask_.data, shared_.last_mask());
    const SiteMessage message{
        SiteMessage::Kind::kPicture, ++number_, capture_time.ns, background_number_};
    if (auto sent = socket_->send(message); !sent) {
        count(lose(sent.error()));
        return;
    }
    asked_ = number_;
    asked_at_ = Clock::now();
    is_offered_ = true;
}

void WorkerClient::await() {
    if (!is_offered_ || answer_) return;
    const auto end = asked_at_ + from_milliseconds(options_.deadline_ms);
    for (;;) {
        // looks once more after the end: more urgent work may have taken the time
        const bool is_over = Clock::now() >= end;
        const News news = receive();
        if (news != News::kNothing || is_over) {
            answer_ = news != News::kNothing ? news : News::kLate;
            return;
        }
        socket_->wait(end - Clock::now());
    }
}

bool WorkerClient::take(const GiveWay& give_way, image::SparseMask& out) {
    if (!is_offered_) return false;
    await();
    is_offered_ = false;
    if (!count(*std::exchange(answer_, std::nullopt))) return false;
    mask_of_alpha(shared_.alpha(), areas_, segmentation_, give_way, clean_, out);
    return true;
}

// Returns whether the picture has an alpha.
bool WorkerClient::count(News news) {
    if (news == News::kAlpha)
        tally_->count_answered();
    else if (news == News::kGone)
        tally_->count_absent();
    else if (news == News::kLate)
        tally_->count_late();
    else
        tally_->count_invalid();
    return news == News::kAlpha;
}

void WorkerClient::keep_last(const image::Mask& mask) {
    if (!socket_) return;
    assert(mask.width == last_mask_.width && mask.height == last_mask_.height);
    is_last_mask_due_ = asked_.has_value();  // the worker may be reading the one before
    std::ranges::copy(mask.data, asked_ ? last_mask_.data.data() : shared_.last_mask());
}

void connect_at_start(const std::vector<WorkerClient*>& clients,
                      std::chrono::milliseconds patience,
                      const std::stop_token& stop) {
    constexpr std::chrono::milliseconds kBetweenLooks{10};
    const auto end = std::chrono::steady_clock::now() + patience;
    const auto is_awaited = [](WorkerClient* client) {
        return !client->is_ready() && client->is_connected();
    };
    while (!stop.stop_requested() && std::ranges::any_of(clients, is_awaited) &&
           std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(kBetweenLooks);
}

}  // namespace atrium::segmentation_worker
