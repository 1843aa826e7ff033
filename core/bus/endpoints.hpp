#pragma once

#include "core/bus/author_guard.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/deadline_count.hpp"
#include "core/bus/entity.hpp"
#include "core/bus/loan.hpp"
#include "core/bus/participant.hpp"
#include "core/bus/topics.hpp"
#include "core/bus/wire.hpp"

#include <memory>
#include <mutex>

/// Defines the private parts of Writer and Reader. Private to core/bus.
namespace atrium::bus {

template <typename Message>
struct Writer<Message>::Impl {
    std::shared_ptr<Participant::Impl> participant;
    Entity topic;
    Entity publisher;  // of partitions other than the world's
    Entity writer;
    PeerWatch::Registration watched;
    std::mutex mutex;  // guards the rest
    typename Topic<Message>::Wire wire{};
    WireScratch scratch;
};

template <typename Message>
struct Reader<Message>::Impl {
    std::shared_ptr<Participant::Impl> participant;
    Entity topic;
    Entity subscriber;  // of partitions other than the world's
    Entity reader;
    PeerWatch::Registration watched;
    std::unique_ptr<DeadlineCount> deadlines;
    Lives lives;
    std::shared_ptr<Authors> authors;  // null: anybody may have written a sample
    Entity anything;                   // read condition: true while there is something to take
};

}  // namespace atrium::bus
