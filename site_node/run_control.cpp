#include "site_node/run_control.hpp"

namespace atrium::site_node {

Expected<void> RunControl::begin() {
    const std::lock_guard lock(mutex_);
    if (name_lost_) return result_;
    source_ = std::stop_source();
    result_ = {};
    return {};
}

void RunControl::finish(const Expected<void>& result) {
    std::stop_source source;
    {
        const std::lock_guard lock(mutex_);
        if (result_) result_ = result;
        source = source_;
    }
    source.request_stop();  // without the lock: its callbacks may call this object
}

void RunControl::lose_name(const Error& lost) {
    {
        const std::lock_guard lock(mutex_);
        name_lost_ = true;
    }
    finish(tl::unexpected(lost));
}

std::stop_token RunControl::token() const {
    const std::lock_guard lock(mutex_);
    return source_.get_token();
}

bool RunControl::has_lost_name() const {
    const std::lock_guard lock(mutex_);
    return name_lost_;
}

Expected<void> RunControl::result() const {
    const std::lock_guard lock(mutex_);
    return result_;
}

}  // namespace atrium::site_node
