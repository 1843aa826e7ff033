#include "tools/simulated_cameras/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace atrium::simulated_cameras {
namespace {

constexpr double kMaxSeconds = 1e6;
constexpr double kMaxDelay_ms = 10'000.0;
constexpr double kMaxClockOffset_ms = 1e9;

std::optional<double> parse_number(std::string_view text, double min, double max) {
    double value = 0.0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    if (!(value >= min && value <= max)) return std::nullopt;
    return value;
}

std::optional<std::size_t> find_camera(std::string_view text, const config::Rig& rig) {
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        if (rig.cameras[i].name == text) return i;
    }
    std::size_t number = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return number < rig.cameras.size() ? std::optional(number) : std::nullopt;
}

// Calls visit(camera, rest) for each "CAMERA<separator>rest" of a comma-separated list; if `visit`
// returns false, that item is an error.
template <typename Visit>
Expected<void> visit_items(const std::string& option,
                           const std::string& list,
                           char separator,
                           const std::string& form,
                           const config::Rig& rig,
                           Visit&& visit) {
    std::string_view rest = list;
    while (!rest.empty()) {
        const std::string_view item = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(rest.size(), item.size() + 1));
        const std::size_t at = item.find(separator);
        const auto wrong = [&](const std::string& what) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("{}: '{}': {}", option, item, what));
        };
        if (at == std::string_view::npos) return wrong("must be " + form);
        const auto camera = find_camera(item.substr(0, at), rig);
        if (!camera) {
            return wrong(fmt::format("the rig has no camera '{}'; it has {} to {}, numbers 0 to {}",
                                     item.substr(0, at),
                                     rig.cameras.front().name,
                                     rig.cameras.back().name,
                                     rig.cameras.size() - 1));
        }
        if (!visit(*camera, item.substr(at + 1))) return wrong("must be " + form);
    }
    return {};
}

Expected<std::vector<double>> parse_values(const std::string& option,
                                           const std::string& list,
                                           double min,
                                           double max,
                                           const config::Rig& rig) {
    std::vector<double> values(rig.cameras.size(), 0.0);
    const auto parsed = visit_items(option,
                                    list,
                                    '=',
                                    fmt::format("CAMERA=NUMBER, {} to {}", min, max),
                                    rig,
                                    [&](std::size_t camera, std::string_view text) {
                                        const auto value = parse_number(text, min, max);
                                        if (value) values[camera] = *value;
                                        return value.has_value();
                                    });
    if (!parsed) return tl::unexpected(parsed.error());
    return values;
}

Expected<void> parse_outages(const FaultTexts& texts,
                             const config::Rig& rig,
                             std::vector<Outage>& outages) {
    auto stops =
        visit_items("stop",
                    texts.stop,
                    '@',
                    "CAMERA@FROM+SECONDS",
                    rig,
                    [&](std::size_t camera, std::string_view text) {
                        const std::size_t plus = text.find('+');
                        if (plus == std::string_view::npos) return false;
                        const auto from = parse_number(text.substr(0, plus), 0.0, kMaxSeconds);
                        const auto seconds = parse_number(text.substr(plus + 1), 0.0, kMaxSeconds);
                        if (from && seconds) outages.push_back({camera, *from, *seconds});
                        return from && seconds;
                    });
    if (!stops) return stops;
    return visit_items("restart",
                       texts.restart,
                       '@',
                       "CAMERA@FROM",
                       rig,
                       [&](std::size_t camera, std::string_view text) {
                           const auto from = parse_number(text, 0.0, kMaxSeconds);
                           if (from) outages.push_back({camera, *from, 0.0});
                           return from.has_value();
                       });
}

// Rejects outages of a camera that is already away.
Expected<void> check_outages(const std::vector<Outage>& outages, const config::Rig& rig) {
    for (std::size_t i = 0; i < outages.size(); ++i) {
        for (std::size_t k = i + 1; k < outages.size(); ++k) {
            if (outages[i].camera == outages[k].camera &&
                outages[k].from_s < outages[i].from_s + outages[i].seconds) {
                return make_error(ErrorKind::kConfiguration,
                                  fmt::format("stop, restart: camera {} is still away at {} s",
                                              rig.cameras[outages[k].camera].name,
                                              outages[k].from_s));
            }
        }
    }
    return {};
}

}  // namespace

Expected<Faults> parse_faults(const FaultTexts& texts, const config::Rig& rig) {
    Faults faults;
    auto lost = parse_values("lose", texts.lose, 0.0, 100.0, rig);
    if (!lost) return tl::unexpected(lost.error());
    faults.lost_share = std::move(*lost);
    for (double& share : faults.lost_share) share *= 0.01;
    auto delay = parse_values("delay_ms", texts.delay_ms, 0.0, kMaxDelay_ms, rig);
    if (!delay) return tl::unexpected(delay.error());
    faults.delay_ms = std::move(*delay);
    auto offset = parse_values(
        "clock_offset_ms", texts.clock_offset_ms, -kMaxClockOffset_ms, kMaxClockOffset_ms, rig);
    if (!offset) return tl::unexpected(offset.error());
    faults.clock_offset_ms = std::move(*offset);
    if (auto parsed = parse_outages(texts, rig, faults.outages); !parsed)
        return tl::unexpected(parsed.error());
    std::stable_sort(faults.outages.begin(),
                     faults.outages.end(),
                     [](const auto& a, const auto& b) { return a.from_s < b.from_s; });
    if (auto checked = check_outages(faults.outages, rig); !checked)
        return tl::unexpected(checked.error());
    return faults;
}

}  // namespace atrium::simulated_cameras
