#include "site_node/record_orders.hpp"

#include "core/app/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atrium::site_node {
namespace {

constexpr std::chrono::milliseconds kPeriod{1000};

// A line for the bus: what it cannot carry becomes '?'.
std::string bus_line(std::string text) {
    if (text.size() > bus::kMaxTextLength) text.resize(bus::kMaxTextLength);
    std::ranges::replace_if(
        text, [](char c) { return c < 0x20 || c > 0x7e; }, '?');
    return text;
}

}  // namespace

RecordOrders::RecordOrders(std::string site,
                           std::filesystem::path folder,
                           record::RawRecorder& recorder,
                           bus::Waiter waiter,
                           bus::Reader<bus::RoomRecordOrder> orders,
                           bus::Writer<bus::RoomRecording> states)
    : site_(std::move(site)),
      folder_(std::move(folder)),
      recorder_(recorder),
      waiter_(std::move(waiter)),
      orders_(std::move(orders)),
      states_(std::move(states)) {
    state_.site = site_;
    if (recorder_.is_recording()) {  // --record
        state_.state = bus::RoomRecordingState::kRunning;
        begun_ = Clock::now();
    }
}

Expected<std::unique_ptr<RecordOrders>> RecordOrders::create(const bus::Participant& participant,
                                                             std::string site,
                                                             std::filesystem::path folder,
                                                             record::RawRecorder& recorder) {
    auto waiter = bus::Waiter::create(participant);
    if (!waiter) return tl::unexpected(waiter.error());
    auto orders = bus::Reader<bus::RoomRecordOrder>::create(participant);
    if (!orders) return tl::unexpected(orders.error());
    auto states = bus::Writer<bus::RoomRecording>::create(participant);
    if (!states) return tl::unexpected(states.error());
    waiter->add(*orders);
    return std::unique_ptr<RecordOrders>(new RecordOrders(std::move(site),
                                                          std::move(folder),
                                                          recorder,
                                                          std::move(*waiter),
                                                          std::move(*orders),
                                                          std::move(*states)));
}

Expected<void> RecordOrders::start(const std::string& name) {
    if (name.empty() || name == "." || name == "..") {
        return make_error(ErrorKind::kConfiguration,
                          "the order names no folder: a name of A-Z a-z 0-9 _ . -");
    }
    if (recorder_.is_recording()) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("it is recording already, into {}; record --site {} --stop ends it",
                        current_.empty() ? "--record" : current_.string(),
                        site_));
    }
    const std::filesystem::path folder = folder_ / name;
    if (auto started = recorder_.start(folder); !started) return started;
    current_ = folder;
    begun_ = Clock::now();
    return {};
}

void RecordOrders::obey(const bus::RoomRecordOrder& order) {
    const bool starts = order.kind == bus::RecordOrderKind::kStart;
    const bool was_recording = recorder_.is_recording();
    Expected<void> done;
    if (starts)
        done = start(order.folder);
    else if (was_recording)
        done = recorder_.stop();
    else
        done = make_error(ErrorKind::kConfiguration, "nothing is recorded");
    state_.sender = order.sender;
    state_.number = order.number;
    state_.is_refused = !done && (starts || !was_recording);
    if (state_.is_refused) {
        app::log::warn(
            "record_order_refused by={} reason=\"{}\"", order.sender, done.error().message);
        state_.text = bus_line(done.error().message);
    } else {
        app::log::info("record_order by={} kind={} folder={}",
                       order.sender,
                       starts ? "start" : "stop",
                       current_.string());
        if (starts) state_.state = bus::RoomRecordingState::kRunning;
        has_stopped_ = !starts;
        state_.text = bus_line(current_.string());
    }
}

// What became of the recording since the last look.
void RecordOrders::look() {
    if (state_.state == bus::RoomRecordingState::kRunning) {
        // A fault may be known only a moment after the end that it caused.
        const Expected<void> result = recorder_.result();
        if (!recorder_.is_recording() && !result) {
            state_.state = bus::RoomRecordingState::kEnded;
            state_.text = bus_line(result.error().message);
        } else if (!recorder_.is_recording() && has_stopped_) {
            state_.state = bus::RoomRecordingState::kComplete;
        }
        state_.seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
    }
    state_.num_pictures = state_.num_dropped = state_.num_bytes = 0;
    for (const record::RecordedPictures& camera : recorder_.counters()) {
        state_.num_pictures += camera.num_written;
        state_.num_dropped += camera.num_dropped;
        state_.num_bytes += camera.num_bytes;
    }
}

void RecordOrders::publish() {
    look();
    state_.time = Timestamp::now();
    if (const auto written = states_.write(state_); !written)
        app::log::warn("record_state_failed {}", written.error().message);
}

void RecordOrders::run(std::stop_token stop) {
    const std::stop_callback wake(stop, [this] { waiter_.wake(); });
    Clock::time_point due = Clock::now();
    while (!stop.stop_requested()) {
        const Clock::time_point now = Clock::now();
        if (now >= due) {
            due = now + kPeriod;
            publish();
        }
        waiter_.wait(std::chrono::ceil<std::chrono::milliseconds>(due - Clock::now()));
        bool has_obeyed = false;
        orders_.take([&](bus::RoomRecordOrder&& order) {
            if (order.site != site_) return;
            obey(order);
            has_obeyed = true;
        });
        if (has_obeyed) publish();
    }
}

}  // namespace atrium::site_node
