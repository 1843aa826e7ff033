#include "core/bus/peer_leases.hpp"

#include "core/bus/authentication.hpp"
#include "core/bus/authentication_internal.hpp"
#include "core/bus/cyclone_entities.h"

#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace atrium::bus {
namespace {

using authentication::process;

// Idle programs send something encrypted every four seconds (KeyWatch).
constexpr std::chrono::milliseconds kLimit{12'000};
// A flood of strangers shall fill less memory.
constexpr std::size_t kMany = 1'000;
constexpr std::chrono::milliseconds kLessForMany{9'000};
// Two programs that give each other up at the same pace could miss each other for ever.
constexpr int kJitterMs = 4'000;
// A process that stood still for as long has not read what is in its sockets.
constexpr std::chrono::seconds kStoodStill{3};
constexpr int kMaxTaken = 1024;

struct Silent {
    dds_guid_t participant{};
    std::string name;
    bool was_heard = false;
};

std::vector<Silent> silent_peers(std::uint32_t domain, std::chrono::steady_clock::time_point time) {
    const auto identities = process().heard.silent_since(time);
    std::vector<Silent> silent;
    if (identities.empty()) return silent;
    const std::lock_guard lock(process().mutex);
    for (const auto& [plugin, instance] : process().instances) {
        if (instance.domain != domain) continue;
        for (const auto& [identity, was_heard] : identities) {
            const auto remote = instance.remotes.find(identity);
            const auto peer = instance.peers.find(identity);
            if (remote == instance.remotes.end() || peer == instance.peers.end()) continue;
            silent.push_back({remote->second.participant, peer->second.name, was_heard});
        }
    }
    return silent;
}

}  // namespace

Expected<PeerLeases> PeerLeases::create(dds_entity_t participant) {
    PeerLeases leases;
    auto reader =
        own(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
            "a reader of DCPSParticipant");
    if (!reader) return tl::unexpected(reader.error());
    leases.participants_ = std::move(*reader);
    dds_get_domainid(participant, &leases.domain_);
    return leases;
}

PeerLeases::Clock::time_point PeerLeases::due_after(Clock::time_point begin) {
    std::uniform_int_distribution<int> jitter(0, kJitterMs);
    return begin + kLimit + std::chrono::milliseconds(jitter(random_));
}

// Takes them, so that the reader keeps nothing of those who have left.
void PeerLeases::take_participants(Clock::time_point now) {
    std::array<void*, kMaxTaken> samples{};
    std::array<dds_sample_info_t, kMaxTaken> infos{};
    for (int num = kMaxTaken; num == kMaxTaken;) {
        samples.fill(nullptr);
        num = dds_take(participants_.get(), samples.data(), infos.data(), kMaxTaken, kMaxTaken);
        for (int i = 0; i < num; ++i) {
            const auto index = static_cast<std::size_t>(i);
            Guid guid{};
            std::memcpy(guid.data(), samples[index], guid.size());  // the key comes first
            if (infos[index].instance_state == DDS_ALIVE_INSTANCE_STATE)
                unproven_.try_emplace(guid, due_after(now));
            else
                unproven_.erase(guid);
        }
        if (num > 0) dds_return_loan(participants_.get(), samples.data(), num);
    }
}

void PeerLeases::look() {
    const auto now = Clock::now();
    if (now - std::exchange(looked_, now) > kStoodStill) {
        all_heard_ = now;
        for (auto& [guid, due] : unproven_) due = due_after(now);
    }
    take_participants(now);
    std::vector<dds_guid_t> gone;
    const auto due = now + (unproven_.size() > kMany ? kLessForMany : std::chrono::milliseconds(0));
    for (auto one = unproven_.begin(); one != unproven_.end();) {
        if (due < one->second) {
            ++one;
            continue;
        }
        dds_guid_t guid{};
        std::memcpy(&guid, one->first.data(), sizeof guid);
        if (proven_name(guid).empty()) gone.push_back(guid);
        one = unproven_.erase(one);
    }
    if (now - all_heard_ >= kLimit) {
        for (const Silent& peer : silent_peers(domain_, now - kLimit)) {
            authentication::log_cut(
                peer.name,
                peer.was_heard ? "nothing that its keys decrypt came for 12 s; it is taken in "
                                 "again when it answers"
                               : "it sends nothing that its keys decrypt: it refuses this "
                                 "program's key, which may be revoked (its owner runs `atrium keys "
                                 "list`), or its packets do not arrive");
            gone.push_back(peer.participant);
        }
    }
    forget_participants(domain_, gone);
}

}  // namespace atrium::bus
