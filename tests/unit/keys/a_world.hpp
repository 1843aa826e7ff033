#pragma once

#include "core/keys/store.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace atrium::keys::testing {

/// Noon of a day on which all keys of the tests are made.
inline constexpr Timestamp kNow{1'800'000'000'000'000'000};
inline constexpr std::chrono::hours kDay{24};

template <typename T>
T value(Expected<T> expected) {
    if (!expected) ADD_FAILURE() << expected.error().message;
    return std::move(expected.value());
}

/// A key store with a member of each kind; the viewer may push and grab.
class AWorld {
public:
    explicit AWorld(const std::string& world = "playroom")
        : store_(value(KeyStore::create(folder_ / "store.keys", world, 3650, kNow))) {
        for (const Member& member :
             {Member{world, Kind::kSite, "alice", {}},
              Member{world, Kind::kSite, "anna", {}},
              Member{world, Kind::kWorld, "hall", {}},
              Member{world, Kind::kViewer, "bob", {Right::kPush, Right::kGrab}},
              Member{world, Kind::kMonitor, "mona", {}}})
            value(store_.add(member, 365, kNow));
    }

    KeyStore& store() { return store_; }
    Bundle bundle(const std::string& name) const { return value(store_.bundle(name)); }
    std::filesystem::path folder() const { return folder_ / "store.keys"; }

private:
    test::TemporaryFolder folder_;
    KeyStore store_;
};

/// Made once for all tests that do not change it.
inline const AWorld& a_world() {
    static const AWorld world;
    return world;
}

}  // namespace atrium::keys::testing
