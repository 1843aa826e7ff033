#include "site_node/capture/recorded_times.hpp"

#include "core/base/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace atrium::capture {
namespace {

std::optional<std::int64_t> parse_integer(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
    std::int64_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

Expected<RecordedTimes> read_times(const std::filesystem::path& file,
                                   const config::Rig& rig,
                                   std::size_t num_frames) {
    std::ifstream stream(file);
    if (!stream)
        return make_error(ErrorKind::kNotFound, fmt::format("{}: cannot open", file.string()));
    RecordedTimes times(num_frames, std::vector<std::optional<std::int64_t>>(rig.cameras.size()));
    std::string line;
    for (std::size_t number = 1; std::getline(stream, line); ++number) {
        if (line.empty() || line == "\r" || (number == 1 && line.rfind("frame", 0) == 0)) continue;
        // the last line of a recording that was cut off
        if (stream.eof() && (std::ranges::count(line, ',') < 2 || line.back() == ',')) break;
        const auto wrong = [&](const std::string& what) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}:{}: {}", file.string(), number, what));
        };
        const std::size_t first = line.find(',');
        const std::size_t second = first == std::string::npos ? first : line.find(',', first + 1);
        if (second == std::string::npos) return wrong("expected: frame, camera, capture_time_ns");
        const std::size_t third = line.find(',', second + 1);
        const auto frame = parse_integer(std::string_view(line).substr(0, first));
        const auto time =
            parse_integer(std::string_view(line).substr(second + 1, third - second - 1));
        std::string name = line.substr(first + 1, second - first - 1);
        std::erase(name, ' ');
        const auto camera = std::ranges::find(
            rig.cameras, name, [](const auto& c) -> const auto& { return c.name; });
        if (!frame || *frame < 0 || !time)
            return wrong("frame and capture_time_ns must be integers");
        if (camera == rig.cameras.end())
            return wrong(fmt::format("rig.toml has no camera '{}'", name));
        if (static_cast<std::size_t>(*frame) >= num_frames || third != std::string::npos) continue;
        times[static_cast<std::size_t>(*frame)]
             [static_cast<std::size_t>(camera - rig.cameras.begin())] = *time;
    }
    return times;
}

Expected<void> check_times(const RecordedTimes& times, const std::filesystem::path& file) {
    constexpr std::size_t kFewest = 3;
    std::vector<double> apart_ms, step_ms;
    for (std::size_t frame = 0; frame < times.size(); ++frame) {
        std::optional<std::int64_t> first, last;
        for (std::size_t camera = 0; camera < times[frame].size(); ++camera) {
            const auto time = times[frame][camera];
            if (!time) continue;
            first = std::min(first.value_or(*time), *time);
            last = std::max(last.value_or(*time), *time);
            const auto before = frame == 0 ? std::nullopt : times[frame - 1][camera];
            if (before) step_ms.push_back(1e-6 * static_cast<double>(*time - *before));
        }
        if (first && *first < *last) apart_ms.push_back(1e-6 * static_cast<double>(*last - *first));
    }
    if (apart_ms.size() < kFewest || step_ms.size() < kFewest) return {};
    const double apart = median_of(std::move(apart_ms)), step = median_of(std::move(step_ms));
    if (apart <= step) return {};
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format(
            "{}: the pictures of one frame are {:.0f} ms apart, those of two frames {:.0f} ms "
            "(medians), but a frame is one instant of all cameras: give the pictures of each "
            "camera the numbers of instants, or cut the beginnings of those that started "
            "earlier",
            file.string(),
            apart,
            step));
}

}  // namespace atrium::capture
