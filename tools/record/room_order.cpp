#include "tools/record/room_order.hpp"

#include "core/app/log.hpp"
#include "core/presence/membership.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <random>
#include <set>
#include <utility>

namespace atrium::record_tool {
namespace {

using RoomClock = std::chrono::steady_clock;
using bus::RoomRecordingState;
constexpr std::chrono::seconds kAnswer{5};
constexpr std::chrono::seconds kEnd{30};  // to write what waits
constexpr std::chrono::seconds kRoomTellPeriod{10};
constexpr std::chrono::milliseconds kRoomLook{100};

// In a world with keys the name must begin with that of the keys.
std::string sender_of(const bus::Participant& participant) {
    if (const keys::Member* member = participant.member()) return member->name;
    return fmt::format("record-{}-{}", presence::host_name().substr(0, 40), ::getpid());
}

class RoomOrder {
public:
    RoomOrder(const RoomOrderConfig& config,
              bus::Participant participant,
              bus::Waiter waiter,
              bus::Reader<bus::RoomRecording> states,
              bus::Writer<bus::RoomRecordOrder> orders)
        : config_(config),
          participant_(std::move(participant)),
          waiter_(std::move(waiter)),
          states_(std::move(states)),
          orders_(std::move(orders)),
          sender_(sender_of(participant_)) {}

    Expected<void> run(const std::stop_token& stop) {
        // Once the site's state is here, its reader of orders is known, too.
        if (!wait(
                [this] { return state_.has_value() && orders_.num_readers() > 0; }, kAnswer, stop))
            return no_answer(stop);
        if (auto done = order(bus::RecordOrderKind::kStart, kAnswer, stop); !done) return done;
        app::log::info("recording_room site={} folder={}", config_.site, state_->text);
        const RoomClock::time_point begin = RoomClock::now();
        RoomClock::time_point due = begin + kRoomTellPeriod;
        const auto is_over = [&] {
            return stop.stop_requested() || state_->state != RoomRecordingState::kRunning ||
                   (config_.seconds > 0.0 &&
                    std::chrono::duration<double>(RoomClock::now() - begin).count() >=
                        config_.seconds);
        };
        while (!is_over()) {
            take();
            if (RoomClock::now() < due) continue;
            due += kRoomTellPeriod;
            tell("recording_room");
        }
        const std::string folder = state_->text;
        if (state_->state == RoomRecordingState::kRunning) {
            if (auto done = order(bus::RecordOrderKind::kStop, kEnd, {}); !done) return done;
        }
        tell("recorded_room");
        if (state_->state == RoomRecordingState::kEnded) {
            return make_error(
                ErrorKind::kInternal,
                fmt::format("site {}: the recording ended: {}", config_.site, state_->text));
        }
        return {};
    }

    // Ends what is recorded.
    Expected<void> end(const std::stop_token& stop) {
        if (!wait(
                [this] { return state_.has_value() && orders_.num_readers() > 0; }, kAnswer, stop))
            return no_answer(stop);
        if (auto done = order(bus::RecordOrderKind::kStop, kEnd, stop); !done) return done;
        tell("recorded_room");
        return {};
    }

private:
    void take() {
        waiter_.wait(kRoomLook);
        states_.take([this](bus::RoomRecording&& state) {
            sites_.insert(state.site);
            if (state.site == config_.site) state_ = std::move(state);
        });
    }

    template <typename Condition>
    bool wait(const Condition& is_met, RoomClock::duration longest, const std::stop_token& stop) {
        const RoomClock::time_point end = RoomClock::now() + longest;
        while (!is_met() && RoomClock::now() < end && !stop.stop_requested()) take();
        return is_met();
    }

    Expected<void> order(bus::RecordOrderKind kind,
                         RoomClock::duration longest,
                         const std::stop_token& stop) {
        const std::uint32_t number = ++number_;
        auto written = orders_.write({sender_, config_.site, number, kind, config_.folder});
        if (!written) return tl::unexpected(written.error());
        const auto is_answered = [&] {
            return state_->sender == sender_ && state_->number == number;
        };
        if (!wait(is_answered, longest, stop)) return no_answer(stop);
        if (state_->is_refused) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("site {} refused: {}", config_.site, state_->text));
        }
        return {};
    }

    Expected<void> no_answer(const std::stop_token& stop) const {
        if (stop.stop_requested()) return {};
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format("site '{}' takes no orders to record ({}): start it with --record.orders "
                        "FOLDER, in this world; sites that take orders: {}",
                        config_.site,
                        participant_.place(),
                        sites_.empty() ? "none" : fmt::format("{}", fmt::join(sites_, ", "))));
    }

    void tell(const char* what) const {
        app::log::info("{} site={} seconds={:.1f} pictures={} mb={:.1f} dropped={}",
                       what,
                       config_.site,
                       state_->seconds,
                       state_->num_pictures,
                       static_cast<double>(state_->num_bytes) / 1e6,
                       state_->num_dropped);
    }

    const RoomOrderConfig& config_;
    bus::Participant participant_;
    bus::Waiter waiter_;
    bus::Reader<bus::RoomRecording> states_;
    bus::Writer<bus::RoomRecordOrder> orders_;
    std::string sender_;
    // by chance: not that of an earlier program with this process id
    std::uint32_t number_ = std::random_device()();
    std::optional<bus::RoomRecording> state_;
    std::set<std::string> sites_;  // that take orders
};

Expected<RoomOrder> open_order(const RoomOrderConfig& config) {
    auto participant = bus::Participant::create(config.bus);
    if (!participant) return tl::unexpected(participant.error());
    auto waiter = bus::Waiter::create(*participant);
    if (!waiter) return tl::unexpected(waiter.error());
    auto states = bus::Reader<bus::RoomRecording>::create(*participant);
    if (!states) return tl::unexpected(states.error());
    auto orders = bus::Writer<bus::RoomRecordOrder>::create(*participant);
    if (!orders) return tl::unexpected(orders.error());
    waiter->add(*states);
    return RoomOrder(
        config, *participant, std::move(*waiter), std::move(*states), std::move(*orders));
}

}  // namespace

Expected<void> record_room(const RoomOrderConfig& config, std::stop_token stop) {
    auto order = open_order(config);
    return order ? order->run(stop) : tl::unexpected(order.error());
}

Expected<void> stop_room(const RoomOrderConfig& config, std::stop_token stop) {
    auto order = open_order(config);
    return order ? order->end(stop) : tl::unexpected(order.error());
}

}  // namespace atrium::record_tool
