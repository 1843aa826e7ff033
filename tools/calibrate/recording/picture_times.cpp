#include "tools/calibrate/recording/picture_times.hpp"

#include "tools/calibrate/names/name_parts.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kFewestTimes = 4;
constexpr std::uint64_t kSecond = 1'000'000'000;
constexpr std::uint64_t kShortestPeriod = 1'050'000;  // running numbers taken as 0.001, 0.002, ...
constexpr std::uint64_t kLongestPeriod = 10 * kSecond;
// Unix times from 2001 to 2103, in seconds.
constexpr std::uint64_t kFirstUnix = 1'000'000'000;
constexpr std::uint64_t kLastUnix = 4'200'000'000;

bool is_digit_at(const std::string& text, std::size_t at) {
    return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
}

bool is_letter_at(const std::string& text, std::size_t at) {
    return at < text.size() && is_letter(text[at]);
}

// A time in a name.
struct TimeInName {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::uint64_t nanoseconds = 0;
    bool has_fraction = true;  // else whole seconds
    std::string_view unit;
};

// Reads a name from left to right.
class Reader {
public:
    Reader(const std::string& text, std::size_t at) : text_(text), at_(at) {}

    std::size_t at() const { return at_; }
    std::size_t num_digits() const {
        std::size_t end = at_;
        while (is_digit_at(text_, end)) ++end;
        return end - at_;
    }
    // Exactly `num` digits, up to 19.
    std::optional<std::uint64_t> digits(std::size_t num) {
        if (num == 0 || num > 19 || num_digits() < num) return std::nullopt;
        at_ += num;
        return std::stoull(text_.substr(at_ - num, num));
    }
    // Two digits below `end`.
    std::optional<std::uint64_t> pair(std::uint64_t end) {
        const auto value = digits(2);
        return value && *value < end ? value : std::nullopt;
    }
    // The separator, '\0' if there is none of these.
    char skip_one_of(std::string_view separators) {
        if (at_ >= text_.size() || separators.find(text_[at_]) == std::string_view::npos)
            return '\0';
        return text_[at_++];
    }
    // Digits after the point of seconds, as nanoseconds, up to the end of the digits.
    std::optional<std::uint64_t> fraction() {
        const std::size_t num = num_digits();
        if (num > 9) return std::nullopt;
        auto value = digits(num);
        for (std::size_t i = num; value && i < 9; ++i) *value *= 10;
        return value;
    }
    // A separator and digits of a length that programs write.
    std::optional<std::uint64_t> fraction_behind(std::string_view separators) {
        Reader ahead = *this;
        const char separator = ahead.skip_one_of(separators);
        const std::size_t num = ahead.num_digits();
        const bool is_usual = num == 3 || num == 4 || num == 6 || num == 7 || num == 9;
        const bool is_point = separator == '.' || separator == ',';
        if (!is_usual && !is_point) return std::nullopt;
        const auto value = ahead.fraction();
        if (value) at_ = ahead.at_;
        return value;
    }

private:
    const std::string& text_;
    std::size_t at_;
};

std::optional<TimeInName> date_at(const std::string& name, std::size_t begin) {
    Reader reader(name, begin);
    const auto year = reader.digits(4);
    if (!year || *year < 1970 || *year > 2099) return std::nullopt;
    const char of_date = reader.skip_one_of("-_.");
    const auto month = reader.pair(13);
    if (reader.skip_one_of("-_.") != of_date) return std::nullopt;
    const auto day = reader.pair(32);
    if (!month || !day) return std::nullopt;
    const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(*year)),
                                           std::chrono::month(static_cast<unsigned>(*month)),
                                           std::chrono::day(static_cast<unsigned>(*day))};
    if (!date.ok()) return std::nullopt;
    while (reader.skip_one_of("T_- .") != '\0') {
    }
    const auto hour = reader.pair(24);
    const char of_time = reader.skip_one_of("-_.:h");
    const auto minute = reader.pair(60);
    reader.skip_one_of("-_.:m");
    const auto second = reader.pair(60);
    if (!hour || !minute || !second) return std::nullopt;
    const auto fraction = reader.fraction_behind("-_.,s");
    // 20260519_000123 may be a date and a running number
    if (!fraction && of_time == '\0') return std::nullopt;
    if (is_digit_at(name, reader.at())) return std::nullopt;
    const auto days =
        static_cast<std::uint64_t>(std::chrono::sys_days(date).time_since_epoch().count());
    const std::uint64_t seconds = ((days * 24 + *hour) * 60 + *minute) * 60 + *second;
    return TimeInName{begin,
                      reader.at(),
                      seconds * kSecond + fraction.value_or(0),
                      fraction.has_value(),
                      "dates"};
}

std::optional<TimeInName> unix_at(const std::string& name, std::size_t begin) {
    Reader reader(name, begin);
    const std::size_t num = reader.num_digits();
    constexpr std::array<std::pair<std::size_t, std::string_view>, 4> kUnits{
        {{10, "seconds"}, {13, "milliseconds"}, {16, "microseconds"}, {19, "nanoseconds"}}};
    const auto* const unit =
        std::ranges::find(kUnits, num, [](const auto& one) { return one.first; });
    if (unit == kUnits.end()) return std::nullopt;
    const auto seconds = reader.digits(10);
    if (*seconds < kFirstUnix || *seconds >= kLastUnix) return std::nullopt;
    const auto fraction = num == 10 ? reader.fraction_behind("._-,") : reader.fraction();
    if (!fraction) return std::nullopt;
    return TimeInName{begin, reader.at(), *seconds * kSecond + *fraction, true, unit->second};
}

std::optional<TimeInName> decimals_at(const std::string& name, std::size_t begin) {
    const auto is_point = [&](std::size_t at) {
        return at < name.size() && (name[at] == '.' || name[at] == ',');
    };
    // "cam1.0001" and "1.2.3" are no decimals
    if (begin > 0 && (is_letter_at(name, begin - 1) || is_point(begin - 1))) return std::nullopt;
    Reader reader(name, begin);
    const std::size_t num = reader.num_digits();
    const auto seconds = num <= 9 ? reader.digits(num) : std::nullopt;
    if (!seconds || reader.skip_one_of(".,") == '\0') return std::nullopt;
    const auto fraction = reader.fraction();
    if (!fraction || (is_point(reader.at()) && is_digit_at(name, reader.at() + 1)))
        return std::nullopt;
    if (is_letter_at(name, reader.at()) && name.substr(reader.at()) != "s") return std::nullopt;
    return TimeInName{begin, reader.at(), *seconds * kSecond + *fraction, true, "seconds"};
}

std::optional<TimeInName> time_of_day_at(const std::string& name, std::size_t begin) {
    Reader reader(name, begin);
    const auto hour = reader.pair(24);
    const char separator = reader.skip_one_of("-_.:");
    const auto minute = reader.pair(60);
    if (separator == '\0' || reader.skip_one_of("-_.:") != separator) return std::nullopt;
    const auto second = reader.pair(60);
    if (!hour || !minute || !second || is_digit_at(name, reader.at())) return std::nullopt;
    const auto fraction = reader.fraction_behind("-_.,");
    if (!fraction) return std::nullopt;
    const std::uint64_t seconds = (*hour * 60 + *minute) * 60 + *second;
    return TimeInName{begin, reader.at(), seconds * kSecond + *fraction, true, "times of day"};
}

// One way to write a time, and how surely names are times that have it.
struct Writing {
    std::optional<TimeInName> (*at)(const std::string& name, std::size_t begin);
    bool is_sure = false;  // else most of the pictures must be there
    bool must_pass_a_second = true;
};
constexpr std::array<Writing, 4> kWritings{{{date_at, true, true},
                                            {unix_at, true, false},
                                            {decimals_at, false, true},
                                            {time_of_day_at, false, true}}};

// The last time in a name.
std::optional<TimeInName> time_in(const std::string& name, const Writing& writing) {
    std::optional<TimeInName> found;
    for (std::size_t at = 0; at < name.size(); ++at) {
        if (!is_digit_at(name, at) || (at > 0 && is_digit_at(name, at - 1))) continue;
        const auto here = writing.at(name, at);
        if (!here) continue;
        found = here;
        at = here->end - 1;
    }
    return found;
}

struct TimedName {
    std::string before;
    std::uint64_t time = 0;
    std::string behind;
    bool has_fraction = true;
};
using TimedNames = std::map<std::string, TimedName>;  // by name

// Where the runs of digits are: begin and length.
std::vector<std::pair<std::size_t, std::size_t>> runs_of_digits(const std::string& text) {
    std::vector<std::pair<std::size_t, std::size_t>> runs;
    for (std::size_t at = 0; at < text.size(); ++at) {
        if (!is_digit_at(text, at)) continue;
        const std::size_t num = Reader(text, at).num_digits();
        runs.emplace_back(at, num);
        at += num;
    }
    return runs;
}

// Drops the given run of digits before or behind all times, if it is the number of the picture: it
// rises with the time. A camera's number does not.
bool drop_number(TimedNames& names,
                 std::string TimedName::*part,
                 std::size_t run,
                 bool is_from_end) {
    std::map<std::pair<std::string, std::string>, std::map<std::uint64_t, std::uint64_t>> numbers;
    TimedNames shorter = names;
    for (auto& [name, timed] : shorter) {
        std::string& text = timed.*part;
        const auto runs = runs_of_digits(text);
        if (run >= runs.size()) return false;
        const auto [at, num] = is_from_end ? runs[runs.size() - 1 - run] : runs[run];
        if (num > 18) return false;
        const std::uint64_t number = std::stoull(text.substr(at, num));
        text.erase(at, num);
        numbers[{timed.before, timed.behind}].emplace(timed.time, number);
    }
    if (numbers.size() * kFewestTimes > names.size()) return false;
    std::size_t num_numbers = 0;
    for (const auto& [of, by_time] : numbers) {
        num_numbers += by_time.size();
        const auto falls = [](const auto& a, const auto& b) { return a.second >= b.second; };
        if (std::ranges::adjacent_find(by_time, falls) != by_time.end()) return false;
    }
    if (num_numbers < names.size()) return false;  // two of one time
    names = std::move(shorter);
    return true;
}

// frame_000012_1779186104123: the time rules, since it also says the rate.
void drop_running_number(TimedNames& names) {
    constexpr std::size_t kMostRuns = 6;
    std::set<std::pair<std::string, std::string>> distinct;
    for (const auto& [name, timed] : names) distinct.emplace(timed.before, timed.behind);
    if (distinct.size() * kFewestTimes <= names.size()) return;
    for (std::size_t run = 0; run < kMostRuns; ++run) {
        if (drop_number(names, &TimedName::before, run, true) ||
            drop_number(names, &TimedName::behind, run, false))
            return;
    }
}

// Whether the times count as cameras do.
bool are_times(const TimedNames& names, const Writing& writing) {
    std::map<std::pair<std::string, std::string>, std::set<std::uint64_t>> sequences;
    for (const auto& [name, timed] : names)
        if (!sequences[{timed.before, timed.behind}].insert(timed.time).second) return false;
    std::vector<std::uint64_t> steps;
    std::size_t num_in_sequences = 0;
    std::uint64_t span = 0;
    bool passes_a_second = false;
    for (const auto& [of, times] : sequences) {
        if (times.size() < kFewestTimes) continue;
        num_in_sequences += times.size();
        span += *times.rbegin() - *times.begin();
        passes_a_second |= *times.begin() / kSecond != *times.rbegin() / kSecond;
        for (auto time = std::next(times.begin()); time != times.end(); ++time)
            steps.push_back(*time - *std::prev(time));
    }
    if (2 * num_in_sequences < names.size() || steps.empty()) return false;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::ranges::nth_element(steps, middle);
    if (*middle < kShortestPeriod || *middle > kLongestPeriod) return false;
    if (writing.must_pass_a_second && !passes_a_second) return false;
    const bool has_fraction = names.begin()->second.has_fraction;
    return (writing.is_sure && has_fraction) || 2 * steps.size() * *middle > span;
}

std::optional<std::vector<PictureName>> split_as(const std::vector<std::string>& names,
                                                 const Writing& writing) {
    TimedNames timed;
    std::string_view unit;
    std::size_t num_timed = 0;
    for (const std::string& name : names) {
        const auto found = time_in(name, writing);
        if (!found || (!unit.empty() && found->unit != unit)) continue;
        unit = found->unit;
        ++num_timed;
        timed[name] = {name.substr(0, found->begin),
                       found->nanoseconds,
                       name.substr(found->end),
                       found->has_fraction};
    }
    if (timed.size() < kFewestTimes || 5 * num_timed < 4 * names.size()) return std::nullopt;
    drop_running_number(timed);
    if (!are_times(timed, writing)) return std::nullopt;
    std::vector<PictureName> result;
    for (const std::string& name : names) {
        const auto found = timed.find(name);
        if (found == timed.end()) {
            result.push_back({name, 0, {}, {}});
            continue;
        }
        const TimedName& own = found->second;
        result.push_back(
            {without_separators_behind(own.before), own.time, own.behind, std::string(unit)});
    }
    return result;
}

}  // namespace

std::optional<std::vector<PictureName>> split_at_times(const std::vector<std::string>& names) {
    if (names.size() < kFewestTimes) return std::nullopt;
    for (const Writing& writing : kWritings)
        if (auto split = split_as(names, writing)) return split;
    return std::nullopt;
}

std::optional<UnitOfNumbers> unit_of_numbers(
    const std::vector<std::vector<std::uint64_t>>& cameras) {
    constexpr std::size_t kFewestSteps = 8;
    constexpr std::uint64_t kSmallestStep = 5;
    constexpr double kUneven = 0.25;  // of a step
    std::vector<std::uint64_t> steps;
    for (const auto& numbers : cameras)
        for (std::size_t i = 1; i < numbers.size(); ++i)
            steps.push_back(numbers[i] - numbers[i - 1]);
    if (steps.size() < kFewestSteps) return std::nullopt;
    std::ranges::sort(steps);
    const std::uint64_t step = steps[steps.size() / 2];
    const auto num_even = std::ranges::count_if(steps, [&](std::uint64_t one) {
        const double ratio = static_cast<double>(one) / static_cast<double>(step);
        return std::abs(ratio - std::max(std::round(ratio), 1.0)) <= kUneven;
    });
    if (step < kSmallestStep || 5 * num_even < 4 * std::ssize(steps)) return std::nullopt;
    if (step < 2'000) return UnitOfNumbers{"milliseconds", 1'000'000};
    if (step < 2'000'000) return UnitOfNumbers{"microseconds", 1'000};
    if (step < 2'000'000'000) return UnitOfNumbers{"nanoseconds", 1};
    return std::nullopt;
}

}  // namespace atrium::calibrate
