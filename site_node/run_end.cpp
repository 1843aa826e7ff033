#include "site_node/run_end.hpp"

namespace atrium::site_node {

Expected<void> RunEnd::begin() {
    const std::lock_guard lock(mutex_);
    if (name_lost_) return result_;
    source_ = std::stop_source();
    result_ = {};
    return {};
}

void RunEnd::finish(const Expected<void>& result) {
    std::stop_source source;
    {
        const std::lock_guard lock(mutex_);
        if (result_) result_ = result;
        source = source_;
    }
    source.request_stop();  // without the lock: its callbacks may call this object
}

void RunEnd::lose_name(const Error& lost) {
    {
        const std::lock_guard lock(mutex_);
        name_lost_ = true;
    }
    finish(tl::unexpected(lost));
}

std::stop_token RunEnd::token() const {
    const std::lock_guard lock(mutex_);
    return source_.get_token();
}

bool RunEnd::has_lost_name() const {
    const std::lock_guard lock(mutex_);
    return name_lost_;
}

Expected<void> RunEnd::result() const {
    const std::lock_guard lock(mutex_);
    return result_;
}

}  // namespace atrium::site_node
