#include "core/recording/player.hpp"

#include "core/bus/messages.hpp"
#include "core/recording/renamed.hpp"
#include "core/recording/topic_roles.hpp"

#include <algorithm>
#include <thread>
#include <utility>

namespace atrium::recording {
namespace {

// A player that is later than this goes on from there: it does not hurry through the past.
constexpr std::chrono::milliseconds kLatest{250};
constexpr std::chrono::duration<double> kLongestWait{1e8};  // three years
// A loop begins anew at most so often, however near its marks are.
constexpr std::chrono::milliseconds kShortestLoop{100};

}  // namespace

Player::Player(std::shared_ptr<const WorldFile> world, PlaySelection selection)
    : world_(std::move(world)), selection_(std::move(selection)), cursor_(world_) {
    state_.duration = world_->duration();
    state_.out = state_.duration;
    wanted_time_ = std::chrono::nanoseconds(0);
}

Player::~Player() = default;

Expected<std::unique_ptr<Player>> Player::create(std::shared_ptr<const WorldFile> world,
                                                 const bus::Participant& participant,
                                                 PlaySelection selection) {
    std::unique_ptr<Player> player(new Player(std::move(world), std::move(selection)));
    for (const auto& [name, num] : player->world_->num_samples()) {
        const bus::RawTopic* const topic = bus::find_raw_topic(name);
        const PlaySelection& wanted = player->selection_;
        if (topic == nullptr || (!wanted.topics.empty() && !wanted.topics.contains(name))) continue;
        auto writer = topic->writer(participant);
        if (!writer) return tl::unexpected(writer.error());
        player->outputs_[topic].writer = std::move(*writer);
    }
    if (!player->selection_.sites.empty()) {
        auto placements =
            bus::find_raw_topic(bus::topic_name<bus::SitePlacement>())->reader(participant);
        if (!placements) return tl::unexpected(placements.error());
        player->placements_ = std::move(*placements);
    }
    return player;
}

bool Player::is_wanted(const bus::RawTopic& topic, const std::string& key) const {
    if (selection_.sites.empty()) return true;
    // the viewers of the recording are not played with its sites
    if (topic.name() == bus::topic_name<bus::StreamFeedback>()) return false;
    const auto site = site_of(topic, key);
    return site && selection_.sites.contains(*site);
}

// Beside living people the world server decides where the played ones stand: it pushes objects
// there.
bool Player::is_left_to_world_server(const bus::RawTopic& topic) const {
    if (!placements_) return false;
    const bool is_of_one = topic.name() == bus::topic_name<bus::SitePlacement>() ||
                           topic.name() == bus::topic_name<bus::PersonProxy>();
    const bus::RawTopic* const own = bus::find_raw_topic(bus::topic_name<bus::SitePlacement>());
    return is_of_one && placements_->num_writers() > (outputs_.contains(own) ? 1 : 0);
}

void Player::write(const PlayedSample& sample, bool is_known_wanted) {
    if (!outputs_.contains(sample.topic) || is_left_to_world_server(*sample.topic)) return;
    const auto key = sample.topic->key_of(sample.raw);
    if (!key) return refuse(*sample.topic, key.error());
    if (!is_known_wanted && !is_wanted(*sample.topic, *key)) return;
    bus::RawSample raw = sample.raw;
    raw.written = Timestamp::now() + (sample.raw.written - sample.time);
    const auto site = site_of(*sample.topic, *key);
    const bool is_changed =
        site && (selection_.names.contains(*site) ||
                 (sample.topic->name() == "SitePlacement" && !selection_.places.empty()));
    if (!is_changed) return write(*sample.topic, raw, *key);
    const auto changed = renamed(*sample.topic, raw, selection_.names, selection_.places);
    if (!changed) return refuse(*sample.topic, changed.error());
    raw.cdr = *changed;
    write(*sample.topic, raw, renamed_key(*sample.topic, *key, selection_.names));
}

void Player::refuse(const bus::RawTopic& topic, const Error& why) {
    const std::lock_guard lock(mutex_);
    ++state_.num_refused;
    state_.fault = std::string(topic.name()) + ": " + why.message;
}

void Player::write(const bus::RawTopic& topic,
                   const bus::RawSample& sample,
                   const std::string& key) {
    Output& output = outputs_.at(&topic);
    const auto done = output.writer->write(sample);
    if (sample.kind == bus::RawKind::kSample && done) {
        // The first sample of an instance is kept: its bytes name the instance when it ends.
        if (!output.alive.contains(key)) {
            auto bytes = topic.key_cdr(sample);
            if (bytes) output.alive.emplace(key, std::move(*bytes));
        }
    } else if (sample.kind != bus::RawKind::kSample) {
        output.alive.erase(key);
    }
    const std::lock_guard lock(mutex_);
    if (done) {
        ++state_.num_written;
    } else {
        ++state_.num_refused;
        state_.fault = done.error().message;
    }
}

// Ends the instances that are not among `alive`, and all streams: those who receive them then know
// that what follows is of another time. Keys are those on the bus.
void Player::end_all_but(const std::set<std::pair<const bus::RawTopic*, std::string>>& alive) {
    for (auto& [topic, output] : outputs_) {
        for (auto one = output.alive.begin(); one != output.alive.end();) {
            if (topic->qos_class() != "stream" && alive.contains({topic, one->first})) {
                ++one;
                continue;
            }
            static_cast<void>(
                output.writer->write({bus::RawKind::kDisposed, Timestamp::now(), one->second}));
            one = output.alive.erase(one);
        }
    }
}

void Player::show(Timestamp time) {
    if (time <= world_->begin()) {
        // What is played from here on has every sample once.
        end_all_but({});
        cursor_.seek_to(world_->begin());
        return;
    }
    show_moment(time);
}

void Player::show_moment(Timestamp time) {
    const std::vector<KeyedSample> samples = moment(world_, time);
    std::set<std::pair<const bus::RawTopic*, std::string>> alive;
    for (const KeyedSample& one : samples) {
        if (!is_wanted(*one.sample.topic, one.key)) continue;
        alive.emplace(one.sample.topic, renamed_key(*one.sample.topic, one.key, selection_.names));
    }
    end_all_but(alive);
    for (const KeyedSample& one : samples) {
        if (is_wanted(*one.sample.topic, one.key)) write(one.sample, true);
    }
    cursor_.seek_behind(time);
}

// The time of the frame that is `num` (not 0) later or earlier than `from`.
std::optional<Timestamp> Player::frame_time(Timestamp from, int num) {
    const bool has_meshes = world_->num_samples().contains("SiteMesh");
    const std::string_view counted = has_meshes ? "SiteMesh" : "SceneState";
    const auto is_frame = [&](const PlayedSample& sample) {
        return sample.topic->name() == counted && sample.raw.kind == bus::RawKind::kSample;
    };
    Cursor cursor(world_);
    if (num > 0) {
        cursor.seek_behind(from);
        std::optional<Timestamp> last;
        for (const PlayedSample* next = cursor.peek(); next != nullptr && num > 0;
             cursor.pop(), next = cursor.peek()) {
            if (!is_frame(*next)) continue;
            last = next->time;
            --num;
        }
        return last;
    }
    // Backwards: looks at longer and longer pieces in front of it.
    for (std::chrono::nanoseconds back = std::chrono::seconds(1);; back *= 4) {
        back = std::min(back, world_->duration());
        const Timestamp begin = std::max(world_->begin(), from + -back);
        cursor.seek_to(begin);
        std::vector<Timestamp> times;
        for (const PlayedSample* next = cursor.peek(); next != nullptr && next->time < from;
             cursor.pop(), next = cursor.peek()) {
            if (is_frame(*next)) times.push_back(next->time);
        }
        const auto wanted = static_cast<std::size_t>(-num);
        if (times.size() >= wanted) return times[times.size() - wanted];
        if (begin == world_->begin()) {
            if (times.empty()) return std::nullopt;
            return times.front();
        }
    }
}

// Does what was asked for; true if it did something. Called and left with the lock held.
bool Player::obey(std::unique_lock<std::mutex>& lock) {
    if (wanted_steps_ != 0) {
        const int steps = std::exchange(wanted_steps_, 0);
        const auto from = std::exchange(wanted_time_, std::nullopt);
        lock.unlock();
        const auto time = frame_time(absolute(from.value_or(state_.time)), steps);
        lock.lock();
        // Unless somebody asked for another time meanwhile.
        if (!wanted_time_) wanted_time_ = time ? *time - world_->begin() : from;
    }
    if (!wanted_time_) return false;
    const std::chrono::nanoseconds time = *std::exchange(wanted_time_, std::nullopt);
    state_.time = time;
    state_.is_at_end = false;
    is_new_pace_ = true;
    lock.unlock();
    show(absolute(time));
    lock.lock();
    return true;
}

void Player::play_on(std::unique_lock<std::mutex>& lock, const std::stop_token& stop) {
    struct Pace {
        Clock::time_point clock;
        std::chrono::nanoseconds time{0};
        double speed = 1.0;
        // Damaged files may have times of centuries.
        Clock::time_point due(std::chrono::nanoseconds at) const {
            const std::chrono::duration<double> wait = (at - time) / speed;
            return clock + std::chrono::duration_cast<Clock::duration>(
                               std::clamp(wait, -kLongestWait, kLongestWait));
        }
    } pace;
    is_new_pace_ = true;
    const Clock::time_point loop_begin = Clock::now();
    const auto is_disturbed = [this] {
        return wanted_time_ || wanted_steps_ != 0 || is_new_pace_ || !state_.is_playing;
    };
    while (!stop.stop_requested() && state_.is_playing && !wanted_time_ && wanted_steps_ == 0) {
        if (std::exchange(is_new_pace_, false)) pace = {Clock::now(), state_.time, state_.speed};
        const std::chrono::nanoseconds out = state_.out;
        lock.unlock();
        const PlayedSample* const next = cursor_.peek();
        lock.lock();
        note_damage();
        const bool is_over = next == nullptr || next->time - world_->begin() > out;
        const std::chrono::nanoseconds at = is_over ? out : next->time - world_->begin();
        Clock::time_point due = pace.due(at);
        if (is_over && state_.loops) due = std::max(due, loop_begin + kShortestLoop);
        if (changed_.wait_until(lock, stop, due, is_disturbed)) {
            state_.time =
                std::clamp(pace.time + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                           (Clock::now() - pace.clock) * pace.speed),
                           state_.time,
                           std::max(state_.time, at));
            continue;
        }
        if (stop.stop_requested()) return;
        state_.time = std::max(state_.time, at);
        if (is_over) {
            if (state_.loops) {
                wanted_time_ = state_.in;
            } else {
                state_.is_playing = false;
                state_.is_at_end = true;
                changed_.notify_all();
            }
            return;
        }
        if (Clock::now() - due > kLatest) {
            ++state_.num_late;
            is_new_pace_ = true;
        }
        lock.unlock();
        write(*next, false);
        cursor_.pop();
        lock.lock();
    }
}

void Player::run(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        if (obey(lock)) continue;
        if (!is_shown_) {
            is_shown_ = true;
            changed_.notify_all();
        }
        if (state_.is_playing) {
            play_on(lock, stop);
            continue;
        }
        changed_.wait(
            lock, stop, [this] { return wanted_time_ || wanted_steps_ != 0 || state_.is_playing; });
    }
    lock.unlock();
    end_all_but({});
}

bool Player::wait_for_readers(std::chrono::nanoseconds timeout) const {
    const Clock::time_point end = Clock::now() + timeout;
    const auto is_read = [](const auto& output) {
        const bus::RawTopic& topic = *output.first;
        // a description reaches those who come later, but the first frame would come before it
        const bool is_needed = topic.qos_class() == "stream" || is_of_people(topic) ||
                               topic.name() == "SiteDescription";
        return !is_needed || output.second.writer->num_readers() > 0;
    };
    while (!std::ranges::all_of(outputs_, is_read)) {
        if (Clock::now() >= end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

// Called with the lock held.
void Player::note_damage() {
    if (cursor_.num_damaged() > state_.num_damaged) state_.fault = cursor_.damage();
    state_.num_damaged = cursor_.num_damaged();
}

void Player::show_now(std::chrono::nanoseconds time) {
    show_moment(absolute(time));
    advance(time);
    const std::lock_guard lock(mutex_);
    wanted_time_.reset();
}

void Player::advance(std::chrono::nanoseconds time) {
    for (const PlayedSample* next = cursor_.peek(); next != nullptr && next->time <= absolute(time);
         next = cursor_.peek()) {
        write(*next, false);
        cursor_.pop();
    }
    const std::lock_guard lock(mutex_);
    state_.time = time;
    note_damage();
}

}  // namespace atrium::recording
