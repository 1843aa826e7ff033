#pragma once

#include "core/bus/bus.hpp"

#include <memory>

namespace atrium::bus {

/// Keeps the list of revoked keys of this process up to date while it runs, in a thread of its own:
/// looks twice a second whether its bundle was replaced by one with a newer list, and takes the
/// lists that the others publish (RevokedKeys). Publishes the longest that it knows: when it grows,
/// and every four seconds, as a sign of life. Programs whose keys are on one of the lists are cut
/// off. Also says when the own key expires, and gives up programs that prove nothing
/// (peer_leases.hpp). Private to core/bus.
class KeyWatch {
public:
    /// `file` is the bundle that `bundle` was read from.
    static Expected<std::shared_ptr<KeyWatch>> start(const Participant& participant,
                                                     const std::string& file,
                                                     std::shared_ptr<const keys::Bundle> bundle);

    struct Impl;
    explicit KeyWatch(std::unique_ptr<Impl> impl);
    ~KeyWatch();
    KeyWatch(const KeyWatch&) = delete;
    KeyWatch& operator=(const KeyWatch&) = delete;

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::bus
