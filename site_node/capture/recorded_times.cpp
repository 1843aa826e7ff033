#include "site_node/capture/recorded_times.hpp"

#include "core/base/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace atrium::capture {

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
