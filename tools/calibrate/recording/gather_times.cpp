// Pictures whose names have times.
#include "tools/calibrate/names/name_parts.hpp"
#include "tools/calibrate/recording/gatherer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace atrium::calibrate {
namespace {

// As people say rates: 15 Hz of steps of 66 and 67 ms, and 29.97 Hz.
double rounded_rate(double rate_hz) {
    const double hundredths = std::round(100.0 * rate_hz) / 100.0;
    return rate_hz < 1.0 ? rate_hz : hundredths;
}

}  // namespace

// Numbers beside times say nothing about instants. The cameras that are fewer are left out.
Expected<void> Gatherer::drop_other_names() {
    std::vector<std::string> timed;
    std::vector<std::string> numbered;
    for (const auto& [camera, shots] : material_.frames) {
        if (shots.is_video || shots.pictures.empty()) continue;
        (shots.time_unit.empty() ? numbered : timed).push_back(camera);
    }
    if (timed.empty() || numbered.empty()) return {};
    if (timed.size() == numbered.size()) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("the names of the pictures of {} are times, those of {} are "
                                      "numbers, so nobody knows which are of one instant: name "
                                      "all by times or all by numbers, or leave cameras out: "
                                      "--cameras '!NAME'",
                                      known(timed),
                                      known(numbered)));
    }
    const bool are_timed_fewer = timed.size() < numbered.size();
    const std::vector<std::string>& fewer = are_timed_fewer ? timed : numbered;
    problem(
        fmt::format("cameras left out: {}: the names of their pictures are {}, those of the others "
                    "{}, so nobody knows which are of one instant: name all alike, or leave "
                    "cameras out: --cameras '!NAME'",
                    known(fewer),
                    are_timed_fewer ? "times" : "numbers",
                    are_timed_fewer ? "numbers" : "times"));
    for (const std::string& camera : fewer) material_.frames.erase(camera);
    return {};
}

// Pictures of the nearest times are one instant.
void Gatherer::take_times() {
    Numbering found = numbering_of(material_.frames);
    if (!found.times) return;
    numbering_ = std::move(found);
    const Numbering::Times& times = *numbering_.times;
    count_by_one(material_.frames, numbering_);
    const double rate_hz = rounded_rate(times.rate_hz());
    if (times.is_guessed) {
        check(
            fmt::format("instants: the numbers of the pictures look like times in {}: {} instants "
                        "at {:.4g} Hz; if they are no times, renumber the pictures without gaps, "
                        "the same instant with the same number",
                        times.unit,
                        times.names.size(),
                        rate_hz));
    } else {
        tell(
            fmt::format("instants: the names of the pictures are times ({}): {} instants at "
                        "{:.4g} Hz; pictures of the nearest times are one instant",
                        times.unit,
                        times.names.size(),
                        rate_hz));
    }
    if (times.grid.num_beside > 0) {
        check(fmt::format(
            "instants: {} not used, because another one of the same camera is nearer "
            "to its instant: some camera takes more pictures per second than the "
            "others, or its times are uneven",
            times.grid.num_beside == 1 ? "1 picture is"
                                       : fmt::format("{} pictures are", times.grid.num_beside)));
    }
    constexpr double kFarOffset = 0.25;  // of a period: beyond half of one, instants are confused
    std::string far;
    for (const auto& [camera, offset_ns] : times.grid.offset_ns) {
        if (std::abs(offset_ns) < kFarOffset * times.grid.period_ns) continue;
        far += fmt::format("{}'{}' by {:+.3g} ms",
                           far.empty() ? "" : ", ",
                           known_name(camera, folders_.originals),
                           offset_ns / 1e6);
    }
    if (!far.empty()) {
        check(
            fmt::format("instants: the times of some cameras differ from the others': {}. Clocks "
                        "that differ by more than half of {:.3g} ms confuse instants: if limbs "
                        "are doubled or missing, set the clocks together and record again",
                        far,
                        times.grid.period_ns / 1e6));
    }
    material_.rate_hz = rate_hz;
    material_.is_rate_of_times = true;
}

// Videos of another rate show other instants. That of most cameras is taken.
void Gatherer::compare_rates() {
    if (material_.is_rate_of_times) return;
    constexpr double kOneRate = 0.01;
    constexpr std::size_t kEnough = 3;  // cameras of a hull
    struct Group {
        double rate_hz;
        std::vector<std::string> cameras;
    };
    std::vector<Group> groups;
    for (const auto& [camera, look] : material_.looks) {
        if (look.rate_hz <= 0.0) continue;
        auto group = std::ranges::find_if(groups, [&, rate_hz = look.rate_hz](const Group& one) {
            return std::abs(rate_hz / one.rate_hz - 1.0) <= kOneRate;
        });
        if (group == groups.end()) group = groups.insert(group, {look.rate_hz, {}});
        group->cameras.push_back(known_name(camera, folders_.originals));
    }
    if (groups.empty()) return;
    std::ranges::stable_sort(
        groups, std::ranges::greater(), [](const Group& one) { return one.cameras.size(); });
    material_.rate_hz = groups.front().rate_hz;
    if (groups.size() == 1) return;
    std::string rates;
    for (const Group& group : groups)
        rates += fmt::format(
            "{}{:.4g} of {}", rates.empty() ? "" : ", ", group.rate_hz, listed(group.cameras));
    std::string names;
    for (const std::string& name : in_natural_order(groups.front().cameras))
        names += (names.empty() ? "" : ",") + name;
    problem(
        fmt::format("rate: the videos have different numbers of pictures per second, {}; a hull "
                    "needs pictures of the same instants: convert the videos to one rate{}",
                    rates,
                    groups.front().cameras.size() < kEnough
                        ? ""
                        : fmt::format(", or take only the cameras of one: --cameras {}",
                                      calibrate::quoted(names))));
}

}  // namespace atrium::calibrate
