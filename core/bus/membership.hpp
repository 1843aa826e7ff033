#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::bus {

struct MembershipOptions {
    ProgramKind kind = ProgramKind::kOther;
    std::string name;     // alone of its kind in the world
    std::string version;  // of Atrium
};

/// What a member has to say. Called by its thread and, while it joins, by the caller's; must not
/// touch the membership.
struct MembershipEvents {
    std::function<void(const std::string&)> info;
    std::function<void(const std::string&)> warn;
    /// Another holds the name and is older: this process has to end. Called once.
    std::function<void(const Error&)> name_lost;
};

/// This process among those of its world: tells the others that it is there (topic Presence), has a
/// name that nobody else of its kind has, knows who is there, and warns of programs that are there
/// but can not be heard.
class Membership {
public:
    /// Asks for the name and waits until it is ours: 0.6 s, and up to 2 s more where one that held
    /// it was killed and DDS has not lost it yet. Fails with kConfiguration naming the host and
    /// process that holds it, and with kUnavailable once a stop is requested.
    static Expected<std::unique_ptr<Membership>> join(const Participant& participant,
                                                      const MembershipOptions& options,
                                                      MembershipEvents events,
                                                      std::stop_token stop = {});
    ~Membership();
    Membership(const Membership&) = delete;
    Membership& operator=(const Membership&) = delete;

    /// Who is there, this process included. Thread-safe.
    std::vector<Presence> present() const;

private:
    struct Impl;
    explicit Membership(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Name of this host as far as it may stand in a message: other characters become '-'.
std::string host_name();

}  // namespace atrium::bus
