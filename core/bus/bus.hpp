#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/keys/bundle.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

/// Wraps Cyclone DDS: typed readers and writers for the messages of messages.hpp. Only core/bus
/// includes Cyclone's headers.
namespace atrium::bus {

struct BusOptions {
    std::string world = "atrium";  // DDS partition: only programs of the same world are matched
    std::uint32_t domain = 0;      // DDS domain id, 0..230
    /// loopback, lan, wifi, wan (embedded files of qos/), or the path of a Cyclone DDS file. Also
    /// private: this process alone.
    std::string network = "loopback";
    std::string peers;  // additional hosts to discover, comma-separated
    /// Network card. Empty: the one that `network` names, else that of the default route.
    std::string interface;
    std::filesystem::path profiles_file;  // OMG DDS-XML; empty: embedded qos/profiles.xml
    /// Bundle of keys (core/keys), or "none". Empty: as `enter_keys` finds it.
    std::string security;
    /// As `security`, of an invitation: its tunnel is then the network.
    std::string join;
    std::shared_ptr<const keys::Bundle> keys;  // read by `enter_keys`; null: a world without keys
};

/// Describes the network configuration of this process, for the log.
struct NetworkReport {
    std::string line;                   // kind, card and address, discovery, receive buffer
    std::vector<std::string> warnings;  // each says what to do
};

/// Worlds of which programs were seen, other than this process's.
struct OtherWorlds {
    std::vector<std::string> heard;
    std::vector<std::string> meant;  // those whose names are near this one's
};

class KeyWatch;  // key_watch.hpp

/// Joins this process to one world. Movable; its Readers and Writers keep it alive.
class Participant {
public:
    /// Enters the keys (`enter_keys`) if that is not done. With keys only programs that have keys
    /// of the same world are heard, and each is what its key says: samples of others in its name
    /// never reach a Reader.
    static Expected<Participant> create(const BusOptions& options);
    const NetworkReport& network() const;
    /// Whose keys this process has; null in a world without keys.
    const keys::Member* member() const;

    /// Returns the incompatible programs found since the last call: programs of this world that
    /// use one of our topics with another type or an incompatible QoS, and thus are never matched.
    /// One line per program, topic and reason, reported once. Call it about once a second.
    /// Thread-safe.
    std::vector<std::string> take_mismatches() const;

    /// Returns what DDS itself logged in this process since the last call, and whom and what the
    /// keys refused: each kind of message once, and then at most once a minute. Call it about once
    /// a second. Thread-safe.
    std::vector<std::string> take_dds_log() const;

    /// Returns where this program is, for the log: "world=atrium domain=0 network=lan", with advice
    /// if that is this host only, and other worlds of which `take_mismatches` saw programs:
    /// "other_worlds=studio,lab". If this world's name may be a misspelling of one of them, also
    /// "did_you_mean=studio". Thread-safe.
    std::string place() const;
    /// Worlds of which `take_mismatches` saw programs. Thread-safe.
    OtherWorlds other_worlds() const;

    struct Impl;
    const std::shared_ptr<Impl>& impl() const { return impl_; }

private:
    explicit Participant(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
    std::shared_ptr<Impl> impl_;
    std::shared_ptr<KeyWatch> key_watch_;  // with keys
};

template <typename Message>
class RawTopicOf;  // raw_samples.cpp

/// Publishes one topic. `Message` is any topic struct of messages.hpp. Thread-safe.
template <typename Message>
class Writer {
public:
    /// With `part` only readers of the same part of the world are matched: what one site's hosts
    /// tell each other must not reach those of all others.
    static Expected<Writer> create(const Participant& participant, const std::string& part = "");
    /// Checks and writes a sample, and returns its payload in bytes. May block for some ten
    /// milliseconds (qos/profiles.xml, max_blocking_time): do not call it on a capture thread.
    /// Fails with kInvalidData if the message does not pass `check`, with kUnavailable if a
    /// reliable reader does not keep up or the topic has too many instances.
    Expected<std::size_t> write(const Message& message);
    /// Disposes and unregisters the instance with the key fields (site, object, sender) of
    /// `key_holder`.
    Expected<void> dispose(const Message& key_holder);
    /// Number of currently matched readers.
    int num_readers() const;

private:
    friend class RawTopicOf<Message>;
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

struct TakeReport {
    std::size_t num_taken = 0;
    std::size_t num_rejected = 0;  // samples that failed a check
    std::string first_rejection;   // why the first of them did; empty: none
};

/// Why an instance is no longer alive.
enum class Ending : std::uint8_t {
    kDisposed,  // its writer disposed it
    kLost,      // it has no writers: killed, cut off, or ended without dispose
};

/// Receives one topic. Only one thread may use it at a time.
template <typename Message>
class Reader {
public:
    /// `part` as in Writer.
    static Expected<Reader> create(const Participant& participant, const std::string& part = "");

    /// Passes each new sample that passes its checks to `on_sample`, oldest first. Calls `on_gone`
    /// when an instance is no longer alive: disposed, or its writers left or lost liveliness. That
    /// message has only its key fields filled. The call comes after the instance's last sample, and
    /// before the first of its next life, and may be repeated. Never blocks. The callbacks must not
    /// use this reader.
    TakeReport take(const std::function<void(Message&&)>& on_sample,
                    const std::function<void(const Message&)>& on_gone = {});
    /// Like `take`, but also reports why the instance ended.
    TakeReport take(const std::function<void(Message&&)>& on_sample,
                    const std::function<void(const Message&, Ending)>& on_gone);
    /// Like `take`, but also passes the time at which each sample was written, by the writer's
    /// clock.
    TakeReport take_written(const std::function<void(Message&&, Timestamp written)>& on_sample,
                            const std::function<void(const Message&, Ending)>& on_gone = {});

    /// Number of currently matched writers.
    int num_writers() const;
    /// Number of deadline periods (QoS profile) that passed without a sample of an instance.
    /// Counted when the next sample of the instance is taken.
    std::uint64_t num_deadlines_missed() const;

private:
    friend class Waiter;
    friend class RawTopicOf<Message>;
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

/// Blocks until one of several readers has something to take.
class Waiter {
public:
    static Expected<Waiter> create(const Participant& participant);
    template <typename Message>
    void add(const Reader<Message>& reader);
    /// Returns true when a reader has something to take, false on timeout or after `wake`.
    bool wait(std::chrono::milliseconds timeout);
    /// Ends a `wait` in another thread at once.
    void wake();

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace atrium::bus
