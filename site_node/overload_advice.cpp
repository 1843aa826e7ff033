#include "site_node/overload_advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace atrium::site_node {
namespace {

constexpr double kReserve = 0.95;  // a rate that the site can just do would lose metaframes again

// A rate that the site can do, rounded down to a number that people write.
double suggested_hz(double done_hz) {
    const double rate = kReserve * done_hz;
    return rate >= 2.0 ? std::floor(rate) : std::max(0.1, std::floor(10.0 * rate) / 10.0);
}

}  // namespace

std::string overload_advice(const Overload& overload, atrium::status::Cause cause) {
    using atrium::status::Cause;
    // without any output yet, or with all of it, there is nothing to judge
    if (!(overload.done_hz > 0.0) || overload.done_hz > kReserve * overload.asked_hz) return {};
    if (cause == Cause::kStoodStill || cause == Cause::kNetwork || !overload.largest_work)
        return {};
    std::string text =
        fmt::format("{:.3g}/s asked, {:.3g} done", overload.asked_hz, overload.done_hz);
    text += fmt::format(": {} takes {:.0f} % of the work",
                        overload.largest_work->name,
                        100.0 * overload.largest_work->share);
    if (overload.largest_work->is_wait) {
        return text + fmt::format(
                          "; give them fewer regions or more cores (atrium plan), or set "
                          "capture.rate_hz = {:g}",
                          suggested_hz(overload.done_hz));
    }
    std::vector<std::string> remedies;
    if (!overload.largest_work->remedy.empty()) remedies.push_back(overload.largest_work->remedy);
    const bool has_free_cores = cause != Cause::kMachine && overload.threads < overload.num_cores;
    if (has_free_cores) {
        remedies.push_back(fmt::format("raise site.threads to {} ({:.1f} of {} cores are used)",
                                       std::max(overload.threads + 1, overload.num_cores - 1),
                                       overload.cores_used,
                                       overload.num_cores));
    } else if (cause == Cause::kMachine) {
        remedies.emplace_back("run fewer programs on this host");
    } else {
        remedies.emplace_back("use fewer or smaller pictures");
    }
    return text + fmt::format("; {}, or set capture.rate_hz = {:g}",
                              fmt::join(remedies, ", "),
                              suggested_hz(overload.done_hz));
}

}  // namespace atrium::site_node
