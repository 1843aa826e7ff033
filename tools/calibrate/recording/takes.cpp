#include "tools/calibrate/recording/takes.hpp"

#include "tools/calibrate/names/name_parts.hpp"
#include "tools/calibrate/recording/matching.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

namespace atrium::calibrate {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// Whether a name may be cut at this place: not inside a word or a number.
bool is_between_words(const std::string& name, std::size_t at) {
    if (at == 0 || at >= name.size()) return true;
    const char before = name[at - 1];
    const char after = name[at];
    return is_separator(before) || is_separator(after) || is_digit(before) != is_digit(after);
}

std::string common_beginning(const std::string& a, const std::string& b) {
    auto at = static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
    while (at > 0 && !(is_between_words(a, at) && is_between_words(b, at))) --at;
    return without_separators_behind(a.substr(0, at));
}

// "Gait 1_Miqus", "Gait 2_Miqus" are "Gait 1", "Gait 2".
void cut_common_end(std::vector<std::string>& names) {
    if (names.size() < 2) return;
    const std::string& first = names.front();
    std::size_t same = first.size();
    for (const std::string& name : names) {
        const auto ends = std::mismatch(first.rbegin(), first.rend(), name.rbegin(), name.rend());
        same = std::min(same, static_cast<std::size_t>(ends.first - first.rbegin()));
    }
    const auto is_inside_word = [&](const std::string& name) {
        return !is_between_words(name, name.size() - same);
    };
    while (same > 0 && std::ranges::any_of(names, is_inside_word)) --same;
    std::set<std::string> shorter;
    for (const std::string& name : names)
        shorter.insert(without_separators_behind(name.substr(0, name.size() - same)));
    if (shorter.size() == names.size() && !shorter.contains(""))
        names.assign(shorter.begin(), shorter.end());
}

}  // namespace

bool is_of_take(const std::string& pattern, const std::string& label) {
    const std::string wanted = lower(pattern);
    const bool is_plain = wanted.find_first_of("*?[") == std::string::npos;
    if (fnmatch(wanted.c_str(), lower(label).c_str(), 0) == 0) return true;
    return std::ranges::any_of(parts_of(label), [&](const std::string& part) {
        const std::string name = lower(part);
        if (fnmatch(wanted.c_str(), name.c_str(), 0) == 0) return true;
        return is_plain && !wanted.empty() && name.starts_with(wanted) &&
               is_between_words(name, wanted.size());
    });
}

std::vector<std::string> beginnings(const std::vector<std::string>& cameras,
                                    const std::vector<Shots>& shots) {
    std::map<std::string, std::size_t> num_labels;  // by name of a folder or file
    std::set<std::string> labels;
    for (const Shots& one : shots)
        if (!one.is_alone) labels.insert(one.label);
    for (const std::string& label : labels)
        for (const std::string& part : parts_of(label)) ++num_labels[part];
    std::set<std::string> found;
    const std::string* former = nullptr;  // of those that occur once
    for (const auto& [name, number] : num_labels) {
        if (number > 1) {
            found.insert(name);
            continue;
        }
        if (former != nullptr) found.insert(common_beginning(*former, name));
        former = &name;
    }
    // what is common to others too, and names of cameras, choose nothing
    std::vector<std::string> result;
    for (const std::string& name : found) {
        const bool is_of_camera = std::ranges::any_of(cameras, [&](const std::string& camera) {
            return likeness(camera, name, {}) >= kByName;
        });
        const bool is_of_all = std::ranges::all_of(
            labels, [&](const std::string& label) { return is_of_take(name, label); });
        if (!name.empty() && !is_of_camera && !is_of_all) result.push_back(name);
    }
    // "Gait" is not proposed beside "Gait 1" and "Gait 2"
    std::erase_if(result, [&](const std::string& name) {
        return std::ranges::any_of(found, [&](const std::string& other) {
            return other.size() > name.size() && other.starts_with(name);
        });
    });
    cut_common_end(result);
    return result;
}

}  // namespace atrium::calibrate
