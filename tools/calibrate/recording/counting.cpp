#include "tools/calibrate/recording/counting.hpp"

#include "tools/calibrate/names/name_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>

namespace atrium::calibrate {
namespace {

// Longer numbers are those of devices.
constexpr std::size_t kMaxDigits = 3;

std::optional<int> count_of(const std::string& number) {
    if (number.empty() || number.size() > kMaxDigits) return std::nullopt;
    return std::stoi(number);
}

// Names by their numbers, if each has one, all differ and they follow each other; else empty.
using Counted = std::map<int, std::string>;

bool add_counted(Counted& counted, const std::vector<std::string>& words, const std::string& name) {
    if (std::ranges::count_if(words, is_number) != 1) return false;
    const auto number = count_of(last_number(words));
    return number && counted.emplace(*number, name).second;
}

bool follow_each_other(const Counted& counted) {
    return counted.rbegin()->first - counted.begin()->first + 1 == static_cast<int>(counted.size());
}

// "cam_09" becomes "cam_10".
std::string with_number(const std::string& name, int number) {
    const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
    const auto begin = std::ranges::find_if(name, is_digit);
    const auto end = std::find_if_not(begin, name.end(), is_digit);
    return fmt::format("{}{:0{}}{}",
                       std::string(name.begin(), begin),
                       number,
                       end - begin,
                       std::string(end, name.end()));
}

}  // namespace

ShiftedCount find_shifted_count(const std::vector<std::string>& cameras,
                                const std::vector<Shots>& shots,
                                const Originals& originals) {
    // two numbers alone may be any two
    constexpr std::size_t kFewestInside = 3;
    std::vector<std::string> labels;
    for (const Shots& one : shots)
        if (!one.is_alone) labels.push_back(one.label);
    if (labels.size() != cameras.size() || cameras.size() < 2) return {};
    Counted counted_cameras;
    Counted counted_labels;
    std::map<std::string, std::string> camera_of;  // by the name that the user knows
    for (const std::string& camera : cameras) {
        const std::string& name = known_name(camera, originals);
        camera_of[name] = camera;
        if (!add_counted(counted_cameras, tokens(name), name)) return {};
    }
    for (const std::string& label : labels)
        if (!add_counted(counted_labels, telling_tokens(label, labels), label)) return {};
    const int first = counted_cameras.begin()->first;
    const int shift = counted_labels.begin()->first - first;
    if ((shift != 1 && shift != -1) || !follow_each_other(counted_cameras) ||
        !follow_each_other(counted_labels))
        return {};
    if (std::min(first, first + shift) != 0 && cameras.size() < kFewestInside) return {};
    for (const auto& [number, name] : counted_cameras) {
        const int as_number = tokens(name).size() == 1 ? kByName : kByName - 1;
        for (const std::string& label : labels)
            if (likeness(name, label, labels) > as_number) return {};
    }
    ShiftedCount result;
    for (const auto& [number, name] : counted_cameras) {
        result.names[camera_of.at(name)] = with_number(name, number + shift);
        constexpr std::size_t kMaxNamed = 12;
        if (result.names.size() == kMaxNamed + 1) result.pairing += ", ...";
        if (result.names.size() > kMaxNamed) continue;
        result.pairing += fmt::format("{}'{}' has '{}'",
                                      result.pairing.empty() ? "" : ", ",
                                      name,
                                      counted_labels.at(number + shift));
    }
    return result;
}

std::string doubt_of_count(const std::vector<std::string>& cameras,
                           const std::vector<std::string>& missing,
                           const std::vector<std::string>& unused) {
    Counted counted;
    for (const std::string& camera : cameras) {
        const auto number = count_of(last_number(tokens(camera)));
        if (!number || !counted.emplace(*number, camera).second) return {};
    }
    if (counted.size() < 2) return {};
    const auto is_missing = [&](const std::string& camera) {
        return std::ranges::find(missing, camera) != missing.end();
    };
    const auto left_over = [&](int number) {
        return std::ranges::find_if(unused, [&](const std::string& label) {
            return count_of(last_number(tokens(label))) == number;
        });
    };
    auto label = unused.end();
    std::string camera = counted.begin()->second;
    if (is_missing(camera)) label = left_over(counted.rbegin()->first + 1);
    if (label == unused.end()) {
        camera = counted.rbegin()->second;
        if (is_missing(camera)) label = left_over(counted.begin()->first - 1);
    }
    if (label == unused.end()) return {};
    return fmt::format(
        "; '{}' has none and '{}' is left: one program may count from 0 and the other from 1, so "
        "that cameras have the pictures of their neighbours: if so, rename the videos",
        camera,
        *label);
}

}  // namespace atrium::calibrate
