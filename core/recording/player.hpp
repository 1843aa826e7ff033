#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "core/recording/cursor.hpp"
#include "core/recording/moment.hpp"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>

namespace atrium::recording {

/// What of a recording is played, and as whom.
struct PlaySelection {
    /// Only what belongs to these sites, without the viewers of the recording; empty: everything.
    /// The places of these sites are left to a world server, if the world has one.
    std::set<std::string> sites;
    std::set<std::string> topics;              // only these; empty: all
    std::map<std::string, std::string> names;  // other names of sites, by the recorded one
    std::map<std::string, geometry::RigidTransform> places;  // world_from_site, by the new name
};

/// Where a player is. Times are since the beginning of the recording.
struct PlayState {
    std::chrono::nanoseconds time{0};
    std::chrono::nanoseconds duration{0};
    std::chrono::nanoseconds in{0};  // marks: it plays between them
    std::chrono::nanoseconds out{0};
    double speed = 1.0;
    bool is_playing = false;
    bool loops = false;
    bool is_at_end = false;
    std::uint64_t num_written = 0;
    std::uint64_t num_refused = 0;  // samples that the bus did not take
    std::uint64_t num_damaged = 0;  // chunks that could not be read
    std::uint64_t num_late = 0;     // times that it fell behind and went on from there
    std::string fault;              // the last of these; empty: none
};

/// Tells what a player had to leave out, each time that there is more of it.
class LeftOut {
public:
    /// A line of the log, or nothing if the state has no more of it than the last one.
    std::optional<std::string> update(const PlayState& state);

private:
    std::uint64_t num_told_ = 0;
};

/// "1:02.5": minutes and seconds since the beginning of a recording, cut to tenths.
std::string position_text(std::chrono::nanoseconds time);

/// Plays a recording into a world: the same samples with the same bytes, at their times.
///
/// Only the names and places of the selection are changed. The time of writing is moved to now, so
/// that the delays on the bus are those of the recording. After a jump it ends the instances that
/// are not there at the new time and writes what shows the world then (`moment`).
///
/// All but `run` is thread-safe.
class Player {
public:
    static Expected<std::unique_ptr<Player>> create(std::shared_ptr<const WorldFile> world,
                                                    const bus::Participant& participant,
                                                    PlaySelection selection);
    ~Player();
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    /// The body of a thread. Shows the beginning (or the time of an earlier `seek`), and plays
    /// from there if `play` was called. Ends all instances when it stops.
    void run(std::stop_token stop);

    /// Blocks until the topics of people and objects that the recording has are read by somebody:
    /// what is written before is lost to them. False: not within `timeout`.
    bool wait_for_readers(std::chrono::nanoseconds timeout) const;

    /// Without `run`, on the caller's thread, for pictures that are made as slowly as they need:
    /// shows that moment, or writes all samples up to `time` at once.
    void show_now(std::chrono::nanoseconds time);
    void advance(std::chrono::nanoseconds time);

    void play();
    void pause();
    /// Pauses and shows the frame (SiteMesh; without any: state) that is `num` later or earlier.
    void step(int num);
    /// For a start in pause: shows the first frame that is surely whole. Before it nobody is there.
    /// Nothing to do at a later time.
    void show_first();
    /// Clamped to the recording.
    void seek(std::chrono::nanoseconds time);
    /// In [0.05, 20].
    void set_speed(double speed);
    void set_loop(bool loops);
    /// Plays between the marks. Clamped; `in` < `out`, otherwise they stay.
    void set_marks(std::chrono::nanoseconds in, std::chrono::nanoseconds out);

    PlayState state() const;
    /// Blocks until all that was asked for before is shown. False: not within `timeout`.
    bool wait_until_shown(std::chrono::nanoseconds timeout) const;

    const WorldFile& world() const { return *world_; }

private:
    using Clock = std::chrono::steady_clock;
    struct Output {
        std::unique_ptr<bus::RawWriter> writer;
        std::map<std::string, std::vector<std::byte>> alive;  // key: bytes that have the key
    };
    Player(std::shared_ptr<const WorldFile> world, PlaySelection selection);

    bool is_wanted(const bus::RawTopic& topic, const std::string& key) const;
    bool is_left_to_world_server(const bus::RawTopic& topic) const;
    void write(const PlayedSample& sample, bool is_known_wanted);
    void refuse(const bus::RawTopic& topic, const Error& why);
    void write(const bus::RawTopic& topic, const bus::RawSample& sample, const std::string& key);
    void show(Timestamp time);
    void show_moment(Timestamp time);
    void note_damage();
    void end_all_but(const std::set<std::pair<const bus::RawTopic*, std::string>>& alive);
    std::optional<Timestamp> frame_time(Timestamp from, int num);
    bool obey(std::unique_lock<std::mutex>& lock);
    void play_on(std::unique_lock<std::mutex>& lock, const std::stop_token& stop);
    Timestamp absolute(std::chrono::nanoseconds time) const { return world_->begin() + time; }

    std::shared_ptr<const WorldFile> world_;
    PlaySelection selection_;
    Cursor cursor_;                                   // running thread only
    std::map<const bus::RawTopic*, Output> outputs_;  // running thread only
    std::unique_ptr<bus::RawReader> placements_;      // null: everything is played

    mutable std::mutex mutex_;
    mutable std::condition_variable_any changed_;
    PlayState state_;  // guarded by mutex_, like all below
    std::optional<std::chrono::nanoseconds> wanted_time_;
    int wanted_steps_ = 0;
    bool is_new_pace_ = true;  // speed, time or pause changed: the clock starts anew
    bool is_shown_ = false;
};

}  // namespace atrium::recording
