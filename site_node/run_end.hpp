#pragma once

#include "core/base/expected.hpp"

#include <mutex>
#include <stop_token>

namespace atrium::site_node {

/// When and why a run ends, said by any thread, and perhaps before there is one: a site that waits
/// for its room to be learned has a name already, and may lose it. Thread-safe.
class RunEnd {
public:
    /// A run begins; fails where the name is lost.
    Expected<void> begin();
    /// Ends the run; the first result is the run's.
    void finish(const Expected<void>& result);
    /// Another has the name: ends this run, and there is no other.
    void lose_name(const Error& lost);

    std::stop_token token() const;
    bool has_lost_name() const;
    Expected<void> result() const;

private:
    mutable std::mutex mutex_;
    Expected<void> result_;
    std::stop_source source_;
    bool name_lost_ = false;
};

}  // namespace atrium::site_node
