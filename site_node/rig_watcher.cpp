#include "site_node/rig_watcher.hpp"

#include "core/app/log.hpp"
#include "core/base/thread_priority.hpp"
#include "core/bus/names.hpp"

#include <pthread.h>

#include <optional>
#include <utility>

namespace atrium::site_node {
namespace {

constexpr auto kLookPeriod = std::chrono::seconds(1);
constexpr auto kRarePeriod = std::chrono::seconds(5);
constexpr std::size_t kWell = 20;  // good looks until they become rare
constexpr auto kLastDiagnosis = std::chrono::seconds(3);

}  // namespace

RigWatcher::RigWatcher(rig_check::AgreementOptions options)
    : watch_(options), thread_([this](std::stop_token stop) { run(stop); }) {
    pthread_setname_np(thread_.native_handle(), "rig check");
}

RigWatcher::~RigWatcher() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
}

bool RigWatcher::wants_look(Clock::time_point now) {
    if (now < due_) return false;
    due_ = now + (is_well_ ? kRarePeriod : kLookPeriod);
    return true;
}

void RigWatcher::run(std::stop_token stop) {
    lower_thread_priority();
    while (const auto look = slot_.take(stop)) judge(*look, stop);
}

void RigWatcher::judge(const rig_check::Look& look, const std::stop_token& stop) {
    // at the end of a short run this may be the only look: it gets some time
    std::optional<Clock::time_point> limit;
    const auto goes_on = [&] {
        if (!stop.stop_requested()) return true;
        if (!limit) limit = Clock::now() + kLastDiagnosis;
        return Clock::now() < *limit;
    };
    const auto lines = watch_.look(look, Clock::now(), goes_on);
    is_well_ = watch_.num_good_looks() >= kWell;
    is_explained_ = watch_.is_explained();
    for (const std::string& line : lines) app::log::warn("{}", line);
    std::string line = bus::as_line(watch_.standing_reason());
    const std::lock_guard lock(finding_mutex_);
    finding_ = std::move(line);
}

std::string RigWatcher::finding() const {
    const std::lock_guard lock(finding_mutex_);
    return finding_;
}

void RigWatcher::finish(bool is_rig_in_doubt) {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
    if (const auto last = slot_.try_take()) judge(*last, {});
    for (const std::string& line : watch_.finish()) app::log::warn("{}", line);
    if (const std::string line = watch_.summary(is_rig_in_doubt); !line.empty())
        app::log::info("{}", line);
}

}  // namespace atrium::site_node
