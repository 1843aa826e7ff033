#pragma once

#include "core/base/expected.hpp"

#include <mutex>
#include <stop_token>

namespace atrium::site_node {

/// Records when and why a run ends. Any thread may end a run, also before it begins: a site claims
/// its name before it learns its room, and may lose the name meanwhile. Thread-safe.
class RunControl {
public:
    /// Begins a run. Fails if the name is lost.
    Expected<void> begin();
    /// Ends the run. The first error reported becomes its result.
    void finish(const Expected<void>& result);
    /// Ends this run because another program owns the name, and prevents any further run.
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
