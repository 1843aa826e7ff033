#include "tools/calibrate/recording/picture_names.hpp"

#include "tools/calibrate/names/name_parts.hpp"
#include "tools/calibrate/recording/picture_times.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kFewestOfTail = 3;
constexpr std::size_t kMostDigits = 19;  // nanoseconds since 1970

bool is_digit_of_name(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// Splits at the last number; without one, or with one that is too long, all is prefix.
PictureName split_at_number(const std::string& name) {
    const auto end = std::find_if(name.rbegin(), name.rend(), is_digit_of_name).base();
    auto begin = end;
    while (begin != name.begin() && is_digit_of_name(*(begin - 1))) --begin;
    const auto num_digits = static_cast<std::size_t>(end - begin);
    if (num_digits == 0 || num_digits > kMostDigits) return {name, 0, {}};
    return {without_separators_behind({name.begin(), begin}),
            static_cast<std::size_t>(std::stoull(std::string(begin, end))),
            {end, name.end()}};
}

bool is_plain_number(const std::string& text) {
    return !text.empty() && text.size() <= kMostDigits &&
           std::ranges::all_of(text, is_digit_of_name);
}

// 0001_0, 0002_0, ...: the last number says nothing.
bool all_end_with_one_number(const std::vector<PictureName>& names) {
    return names.size() >= kFewestOfTail && std::ranges::all_of(names, [&](const auto& name) {
               return name.tail.empty() && name.number == names.front().number &&
                      is_plain_number(name.prefix);
           });
}

}  // namespace

std::vector<PictureName> split_names(const std::vector<std::string>& names) {
    if (auto timed = split_at_times(names)) return std::move(*timed);
    std::vector<PictureName> result;
    std::map<std::string, std::size_t> num_of_tail;
    for (const std::string& name : names) {
        result.push_back(split_at_number(name));
        ++num_of_tail[result.back().tail];
    }
    if (all_end_with_one_number(result)) {
        for (PictureName& name : result) name = {{}, std::stoull(name.prefix), {}};
        return result;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string& tail = result[i].tail;
        if (tail.empty() || (is_separator(tail[0]) && num_of_tail[tail] >= kFewestOfTail)) continue;
        result[i] = {names[i], 0, {}};
    }
    return result;
}

}  // namespace atrium::calibrate
