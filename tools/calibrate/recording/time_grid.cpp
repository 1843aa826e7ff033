#include "tools/calibrate/recording/time_grid.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

namespace atrium::calibrate {
namespace {

// Every time is an angle: its phase in the period. Sums of phases over a window are long if the
// period is right, and their angle then says where the instants are.
using Phase = std::complex<double>;
using Windows = std::map<std::int64_t, Phase>;

constexpr std::size_t kFewestTimesOfOne = 4;
constexpr double kPeriodsOfWindow = 16.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

// Times from the first one of all cameras.
using Times = std::vector<double>;
using TimesOf = std::map<std::string, Times>;

std::optional<double> median_step(const TimesOf& cameras) {
    std::vector<double> steps;
    for (const auto& [camera, times] : cameras) {
        if (times.size() < kFewestTimesOfOne) continue;
        std::adjacent_difference(times.begin(), times.end(), std::back_inserter(steps));
        steps.erase(steps.end() - static_cast<std::ptrdiff_t>(times.size()));  // no difference
    }
    if (steps.empty()) return std::nullopt;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::ranges::nth_element(steps, middle);
    return *middle > 0.0 ? std::optional(*middle) : std::nullopt;
}

struct Comb {
    double period;
    double window;  // length
    std::int64_t window_of(double time) const {
        return static_cast<std::int64_t>(std::floor(time / window));
    }
    double centre_of(std::int64_t index) const {
        return (static_cast<double>(index) + 0.5) * window;
    }
};

Windows phases_of(const Times& times, const Comb& comb) {
    Windows windows;
    for (const double time : times)
        windows[comb.window_of(time)] +=
            std::polar(1.0, kTurn * std::fmod(time / comb.period, 1.0));
    return windows;
}

// Of the phases of each window, without a map of them.
double squares_of_sums(const Times& times, const Comb& comb) {
    double squares = 0.0;
    Phase sum;
    double end = 0.0;
    for (const double time : times) {
        if (time >= end) {
            squares += std::norm(sum);
            sum = {};
            end = static_cast<double>(comb.window_of(time) + 1) * comb.window;
        }
        sum += std::polar(1.0, kTurn * std::fmod(time / comb.period, 1.0));
    }
    return squares + std::norm(sum);
}

// The period near the median step that makes the longest sums. Half of it would make them, too.
double find_period(const TimesOf& cameras, double median) {
    constexpr double kFirst = 0.7;
    constexpr double kLast = 1.5;
    constexpr int kSteps = 80;
    double best = median;
    double most = -1.0;
    for (int i = 0; i <= kSteps; ++i) {
        const double period = median / (kFirst + (kLast - kFirst) * i / kSteps);
        const Comb comb{period, kPeriodsOfWindow * median};
        double sum = 0.0;
        for (const auto& [camera, times] : cameras) sum += squares_of_sums(times, comb);
        if (sum <= most) continue;
        most = sum;
        best = period;
    }
    return best;
}

double offset_between(const Windows& a, const Windows& b) {
    Phase sum;
    for (const auto& [index, phase] : a)
        if (const auto other = b.find(index); other != b.end())
            sum += phase * std::conj(other->second);
    return sum == Phase() ? 0.0 : std::arg(sum);
}

double num_shared(const Windows& a, const Windows& b) {
    double num = 0.0;
    for (const auto& [index, phase] : a)
        if (const auto other = b.find(index); other != b.end())
            num += std::min(std::abs(phase), std::abs(other->second));
    return num;
}

// The phases of all cameras together, each turned by its offset, which is in turns.
struct Together {
    Windows phases;
    std::map<std::string, double> offsets;
};

Together put_together(const TimesOf& cameras, const Comb& comb) {
    std::map<std::string, Windows> left;
    for (const auto& [camera, times] : cameras) left[camera] = phases_of(times, comb);
    Together all;
    Phase middle;
    while (!left.empty()) {
        // the first one is that with the most pictures
        const auto next = std::ranges::max_element(left, {}, [&](const auto& entry) {
            return all.phases.empty() ? num_shared(entry.second, entry.second)
                                      : num_shared(entry.second, all.phases);
        });
        const double angle = offset_between(next->second, all.phases);
        for (const auto& [index, phase] : next->second)
            all.phases[index] += phase * std::polar(1.0, -angle);
        all.offsets[next->first] = angle;
        middle += std::polar(1.0, angle);
        left.erase(next);
    }
    // turns from the middle, so that the first camera may be any
    for (auto& [camera, offset] : all.offsets)
        offset = (std::arg(middle) + std::arg(std::polar(1.0, offset - std::arg(middle)))) / kTurn;
    return all;
}

// Turns of the instants over time: slow, without jumps. By centre of a window.
std::map<double, double> turns_of(const Windows& phases, const Comb& comb) {
    constexpr double kGain = 0.3;
    std::vector<double> turns;
    double slope = 0.0;  // per window
    std::int64_t former = 0;
    for (const auto& [index, phase] : phases) {
        double turn = std::arg(phase) / kTurn;
        if (!turns.empty()) {
            const auto gap = static_cast<double>(index - former);
            const double expected = turns.back() + slope * gap;
            turn = expected + std::remainder(turn - expected, 1.0);
            slope += kGain * ((turn - turns.back()) / gap - slope);
        }
        turns.push_back(turn);
        former = index;
    }
    std::map<double, double> smooth;
    std::size_t i = 0;
    for (auto here = phases.begin(); here != phases.end(); ++here, ++i) {
        const auto& [index, phase] = *here;
        double& turn = smooth[comb.centre_of(index)];
        turn = turns[i];
        const auto before = phases.find(index - 1);
        const auto after = phases.find(index + 1);
        if (before == phases.end() || after == phases.end()) continue;
        const double weight = std::min(std::abs(before->second), std::abs(after->second));
        const double own = std::abs(phase);
        turn = (turns[i] * own + (turns[i - 1] + turns[i + 1]) * weight) / (own + 2.0 * weight);
    }
    return smooth;
}

// The mean change of turns, per time. Windows with a gap between them say nothing.
double slope_of(const std::map<double, double>& turns, double window) {
    double change = 0.0;
    double time = 0.0;
    for (auto next = turns.begin(); next != turns.end(); ++next) {
        if (next == turns.begin()) continue;
        const auto former = std::prev(next);
        if (next->first - former->first > 1.5 * window) continue;
        change += next->second - former->second;
        time += next->first - former->first;
    }
    return time > 0.0 ? change / time : 0.0;
}

double turn_at(const std::map<double, double>& turns, double time) {
    const auto after = turns.lower_bound(time);
    if (after == turns.begin()) return after->second;
    const auto before = std::prev(after);
    if (after == turns.end()) return before->second;
    const double share = (time - before->first) / (after->first - before->first);
    return before->second + share * (after->second - before->second);
}

// Of two pictures of a camera at one instant the nearer one stays.
struct Placed {
    std::uint64_t time;
    double beside;
};

// The slope of the times over the numbers, of all cameras together.
double fitted_period(const TimeGrid& grid, double period) {
    double squares = 0.0;
    double products = 0.0;
    for (const auto& [camera, numbers] : grid.numbers) {
        const auto [start, first] = *numbers.begin();
        double mean_number = 0.0;
        double mean_time = 0.0;
        for (const auto& [time, number] : numbers) {
            mean_number += static_cast<double>(number - first);
            mean_time += static_cast<double>(time - start);
        }
        mean_number /= static_cast<double>(numbers.size());
        mean_time /= static_cast<double>(numbers.size());
        for (const auto& [time, number] : numbers) {
            const double from_mean = static_cast<double>(number - first) - mean_number;
            squares += from_mean * from_mean;
            products += from_mean * (static_cast<double>(time - start) - mean_time);
        }
    }
    return squares > 0.0 ? products / squares : period;
}

TimeGrid place(const CameraTimes& cameras,
               const TimesOf& times,
               const Together& all,
               const std::map<double, double>& turns,
               double period) {
    TimeGrid grid;
    std::vector<double> offsets;
    for (const auto& [camera, offset] : all.offsets) offsets.push_back(offset);
    std::ranges::sort(offsets);
    const double median = offsets[offsets.size() / 2];
    std::map<std::string, std::map<std::int64_t, Placed>> placed;
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    for (const auto& [camera, of_camera] : times) {
        const double offset = all.offsets.at(camera);
        grid.offset_ns[camera] = (offset - median) * period;
        for (std::size_t i = 0; i < of_camera.size(); ++i) {
            const double at = of_camera[i] / period - offset - turn_at(turns, of_camera[i]);
            const double nearest = std::round(at);
            const auto number = static_cast<std::int64_t>(nearest);
            first = std::min(first, number);
            const Placed here{cameras.at(camera)[i], std::abs(at - nearest)};
            const auto [former, is_new] = placed[camera].emplace(number, here);
            if (is_new) continue;
            ++grid.num_beside;
            if (here.beside < former->second.beside) former->second = here;
        }
    }
    for (const auto& [camera, by_number] : placed)
        for (const auto& [number, here] : by_number)
            grid.numbers[camera][here.time] = static_cast<std::size_t>(number - first);
    grid.period_ns = fitted_period(grid, period);
    return grid;
}

}  // namespace

std::optional<TimeGrid> grid_of(const CameraTimes& cameras) {
    std::uint64_t start = std::numeric_limits<std::uint64_t>::max();
    for (const auto& [camera, times] : cameras)
        if (!times.empty()) start = std::min(start, times.front());
    TimesOf since;
    for (const auto& [camera, times] : cameras)
        for (const std::uint64_t time : times)
            since[camera].push_back(static_cast<double>(time - start));
    const auto median = median_step(since);
    if (!median) return std::nullopt;
    double period = find_period(since, *median);
    for (int round = 0; round < 3; ++round) {
        const Comb comb{period, kPeriodsOfWindow * period};
        const double slope =
            slope_of(turns_of(put_together(since, comb).phases, comb), comb.window);
        period = 1.0 / (1.0 / period - slope);
    }
    const Comb comb{period, kPeriodsOfWindow * period};
    const Together all = put_together(since, comb);
    return place(cameras, since, all, turns_of(all.phases, comb), period);
}

}  // namespace atrium::calibrate
