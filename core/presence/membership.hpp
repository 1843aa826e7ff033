#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::presence {

struct MembershipOptions {
    bus::ProgramKind kind = bus::ProgramKind::kOther;
    std::string name;     // unique among the programs of its kind in the world
    std::string version;  // of Atrium
};

/// Callbacks of a Membership. Its thread calls them; during `join` the caller's thread does. They
/// must not use the membership.
struct MembershipEvents {
    std::function<void(const std::string&)> info;
    std::function<void(const std::string&)> warn;
    /// Another process holds the name and is older: this one has to end. Called at most once.
    std::function<void(const Error&)> name_lost;
};

/// Announces this process to its world (topic Presence), holds its unique name, keeps the list of
/// present programs and warns about programs that are present but incompatible.
class Membership {
public:
    /// Claims the name and blocks until this process holds it: 0.6 s, up to 2 s more if the former
    /// holder was killed and DDS has not lost it yet. Fails with kConfiguration if another process
    /// holds the name (the message has its host and pid), with kUnavailable if `stop` is requested.
    static Expected<std::unique_ptr<Membership>> join(const bus::Participant& participant,
                                                      const MembershipOptions& options,
                                                      MembershipEvents events,
                                                      std::stop_token stop = {});
    ~Membership();
    Membership(const Membership&) = delete;
    Membership& operator=(const Membership&) = delete;

    /// Returns the programs present, this process first. Thread-safe.
    std::vector<bus::Presence> present() const;
    /// Returns bus::Participant::place. Thread-safe.
    std::string place() const;
    /// As bus::Participant::other_worlds. Thread-safe.
    bus::OtherWorlds other_worlds() const;

private:
    struct Impl;
    explicit Membership(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Returns the host's name as a valid name of messages: other characters become '-', at most 63
/// characters; "unknown" if it is empty.
std::string host_name();

}  // namespace atrium::presence
