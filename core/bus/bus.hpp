#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

/// Cyclone DDS in C++: the only place of Atrium that includes its headers.
namespace atrium::bus {

struct BusOptions {
    std::string world = "atrium";  // the DDS partition: programs of one world hear only each other
    std::uint32_t domain = 0;      // DDS domain id, 0..230
    std::string network = "loopback";  // loopback, lan, wifi, wan: files of qos/; or a path
    std::string peers;                 // hosts to look for besides, "a,b"
    std::string interface;             // network card; empty: as `network` says, or by itself
    std::filesystem::path
        profiles_file;  // OMG DDS-XML profiles, qos/profiles.xml; empty: the built-in copy of it
};

/// How a process is on the network, for the log.
struct NetworkReport {
    std::string line;                   // kind, card and address, discovery, receive buffer
    std::vector<std::string> warnings;  // each with its remedy
};

/// This process in one world. Movable; Readers and Writers keep it alive.
class Participant {
public:
    static Expected<Participant> create(const BusOptions& options);
    const NetworkReport& network() const;

    /// Programs in this world that use one of our topics with another type, or with a QoS that does
    /// not fit ours, so that neither hears the other: one line for each program and topic, once.
    /// To be asked now and then. Thread-safe.
    std::vector<std::string> take_complaints() const;

    struct Impl;
    const std::shared_ptr<Impl>& impl() const { return impl_; }

private:
    explicit Participant(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
    std::shared_ptr<Impl> impl_;
};

/// Publishes one topic. `Message` is any struct of messages.hpp. Thread-safe.
template <typename Message>
class Writer {
public:
    static Expected<Writer> create(const Participant& participant);
    /// Fails with kInvalidData where `from_wire` at the other end would refuse the message, and
    /// with kUnavailable where a reader of commands does not keep up or the topic has too many
    /// keys. Returns the bytes of payload handed over. May wait some ten milliseconds
    /// (qos/profiles.xml, max_blocking_time): not for a capture thread.
    Expected<std::size_t> write(const Message& message);
    /// Tells the readers that the message's key (site, object, sender) is gone.
    Expected<void> dispose(const Message& key_holder);
    /// Number of readers matched now.
    int num_readers() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

struct TakeReport {
    std::size_t num_taken = 0;
    std::size_t num_rejected = 0;  // failed a check; named in `first_rejection`
    std::string first_rejection;
};

/// How a key came to its end.
enum class Ending : std::uint8_t {
    kDisposed,  // its writer said so
    kLost,      // its writer left without a word: it was killed, or is cut off
};

/// Receives one topic. One thread at a time.
template <typename Message>
class Reader {
public:
    static Expected<Reader> create(const Participant& participant);

    /// Hands over, oldest first, each new sample that passed its checks. `on_gone` gets a message
    /// of which only the key fields are filled, once its writer has left, lost liveliness or
    /// disposed it; after the last sample of that key, and perhaps more than once. Never waits.
    /// The functions must not use this reader.
    TakeReport take(const std::function<void(Message&&)>& on_sample,
                    const std::function<void(const Message&)>& on_gone = {});
    /// The same, for who wants to know how a key ended.
    TakeReport take(const std::function<void(Message&&)>& on_sample,
                    const std::function<void(const Message&, Ending)>& on_gone);
    /// Like `take`, but also passes when each sample was written, by its writer's clock.
    TakeReport take_written(const std::function<void(Message&&, Timestamp written)>& on_sample,
                            const std::function<void(const Message&, Ending)>& on_gone = {});

    /// Number of writers matched now.
    int num_writers() const;
    /// How often a key went without a sample for longer than the deadline of its QoS profile.
    std::uint64_t num_deadlines_missed() const;

private:
    friend class Waiter;
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

/// Sleeps until one of several readers has something to take.
class Waiter {
public:
    static Expected<Waiter> create(const Participant& participant);
    template <typename Message>
    void add(const Reader<Message>& reader);
    /// Returns true when a reader has something, false on the timeout or after `wake`.
    bool wait(std::chrono::milliseconds timeout);
    /// Ends a `wait` of another thread at once.
    void wake();

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace atrium::bus
