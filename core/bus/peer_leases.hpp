#pragma once

#include "core/bus/entity.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <random>

namespace atrium::bus {

/// Ends what Cyclone knows of programs that prove nothing for too long, in a world with keys:
///
/// - Who has proven no key goes after about twelve seconds; of more than a thousand, after three to
///   seven. Cyclone keeps a stranger for as long as
///   it announces itself, or as long as its announcement says: for ever, if it says so.
/// - Who has proven its key goes when for as long nothing came that its keys decrypt. If of two
///   programs only one loses the other (a link that works one way for a while), that one begins a
///   handshake which the other does not answer, because it still has the keys of the last one
///   (cyclonedds#1895). Announcements renew the lease of Cyclone, so that would last for ever.
///
/// In both cases the next announcement begins anew. Used by one thread. Private to core/bus.
class PeerLeases {
public:
    static Expected<PeerLeases> create(dds_entity_t participant);

    /// Call it about twice a second.
    void look();

private:
    using Clock = std::chrono::steady_clock;
    using Guid = std::array<std::uint8_t, 16>;

    void take_participants(Clock::time_point now);
    Clock::time_point due_after(Clock::time_point begin);

    Entity participants_;  // reader of the built-in topic
    std::uint32_t domain_ = 0;
    std::map<Guid, Clock::time_point> unproven_;  // and when each has to go
    Clock::time_point looked_ = Clock::now();
    Clock::time_point all_heard_ = looked_;
    std::minstd_rand random_{std::random_device{}()};
};

}  // namespace atrium::bus
