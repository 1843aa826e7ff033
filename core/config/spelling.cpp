#include "core/config/spelling.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>

namespace atrium::config {
namespace {

// Edits between two words: a letter added, removed or replaced, or two neighbours swapped.
std::size_t num_edits(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row_before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        next[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t same = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            next[j] = std::min({row[j] + 1, next[j - 1] + 1, same});
            const bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (is_swap) next[j] = std::min(next[j], row_before[j - 2] + 1);
        }
        std::swap(row_before, row);
        std::swap(row, next);
    }
    return row.back();
}

std::string_view after_last_dot(std::string_view key) {
    return key.substr(key.rfind('.') + 1);  // npos + 1 is 0
}

std::string with_underscores(std::string_view name) {
    std::string text(name);
    std::replace(text.begin(), text.end(), '-', '_');
    return text;
}

bool is_unit(std::string_view word) {
    constexpr std::string_view kAll =
        " m cm mm in ft kg g s ms us min hz fps deg rad px mps percent ";
    return !word.empty() && kAll.find(" " + std::string(word) + " ") != std::string_view::npos;
}

// "limits_rad" for "limits_deg"
bool is_in_another_unit(std::string_view written, std::string_view meant) {
    const auto split = [](std::string_view word) {
        const std::size_t end = std::min(word.rfind('_'), word.size());
        return std::pair(word.substr(0, end), word.substr(std::min(end + 1, word.size())));
    };
    const auto [stem, unit] = split(written);
    const auto [meant_stem, meant_unit] = split(meant);
    return !stem.empty() && stem == meant_stem && is_unit(unit) && is_unit(meant_unit);
}

// Distance of two words, or nothing if the one is no misspelling of the other.
std::optional<std::size_t> distance(std::string_view written, std::string_view meant) {
    constexpr std::size_t kShortestStem = 3;
    const bool is_part = written.size() >= kShortestStem && meant.size() > written.size();
    const bool lacks_unit = is_part && meant.starts_with(written) && meant[written.size()] == '_';
    if (lacks_unit) return 1;
    const bool lacks_words = is_part && meant.ends_with(written) &&
                             meant[meant.size() - written.size() - 1] == '_';  // "yaw_deg"
    if (lacks_words || is_in_another_unit(written, meant)) return 1;
    if (!may_be_misspelling(written, meant)) return std::nullopt;
    return num_edits(written, meant);
}

// Lower is better: first whole keys, then their last parts in another table.
std::optional<std::size_t> rank(std::string_view written, std::string_view meant) {
    constexpr std::size_t kOtherTable = 10;
    if (const auto whole = distance(written, meant)) return whole;
    // two other letters make another word of a short one: "size", "tile", "nice"
    constexpr std::size_t kShort = 4;
    const std::string_view part = after_last_dot(written);
    const auto parts = distance(part, after_last_dot(meant));
    if (parts && *parts > 1 && part.size() <= kShort) return std::nullopt;
    return parts ? std::optional(*parts + kOtherTable) : std::nullopt;
}

// A size is given as width and height.
std::vector<std::string> sizes_meant_by(std::string_view written,
                                        const std::vector<std::string>& names) {
    std::vector<std::string> meant;
    const std::string_view part = after_last_dot(written);
    if (part != "size" && part != "resolution") return meant;
    const std::string_view table = written.substr(0, written.size() - part.size());
    for (const std::string_view side : {"width", "height"}) {
        const std::string name = std::string(table).append(side);
        if (std::ranges::find(names, name) != names.end()) meant.push_back(name);
    }
    return meant;
}

std::string in_lower_case(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

}  // namespace

bool may_be_misspelling(std::string_view written, std::string_view meant) {
    const bool is_long = meant.size() >= 7;
    const bool begins_alike =
        meant.size() >= 4 && !written.empty() && written.front() == meant.front();
    // "light" is not "rights"
    const std::size_t most = is_long || begins_alike ? 2 : 1;
    return num_edits(written, meant) <= std::min(most, meant.size() / 2);
}

std::vector<std::string> names_meant_by(std::string_view written,
                                        const std::vector<std::string>& names) {
    constexpr std::size_t kMaxNames = 3;
    const std::string plain = with_underscores(written);
    std::optional<std::size_t> best;
    std::vector<std::string> meant = sizes_meant_by(written, names);
    if (!meant.empty()) return meant;
    for (const std::string& name : names) {
        const auto found = rank(plain, with_underscores(name));
        if (!found || (best && *found > *best)) continue;
        if (!best || *found < *best) meant.clear();
        best = found;
        const bool is_new = std::find(meant.begin(), meant.end(), name) == meant.end();
        if (is_new && meant.size() < kMaxNames) meant.push_back(name);
    }
    return meant;
}

std::string ask_which(const std::vector<std::string>& names, std::string_view before) {
    std::string text;
    for (const std::string& name : names)
        text.append(text.empty() ? "did you mean " : " or ").append(before).append(name);
    return text.empty() ? text : text + "?";
}

std::string must_be_one_of(const std::vector<std::string>& choices, std::string_view written) {
    std::string text;
    for (const std::string& choice : choices)
        text.append(text.empty() ? "must be one of " : ", ").append(choice);
    const std::string question = ask_which(names_meant_by(written, choices));
    return question.empty() ? text : text + " (" + question + ")";
}

std::string ask_which_path(const std::filesystem::path& missing) {
    constexpr int kMaxEntries = 10'000;  // a folder may be huge
    namespace fs = std::filesystem;
    std::error_code failure;
    fs::path existing;
    for (const fs::path& part : missing) {
        if (fs::exists(existing / part, failure)) {
            existing /= part;
            continue;
        }
        const std::string written = in_lower_case(part.string());
        std::size_t best = std::string::npos;
        std::vector<std::string> meant;
        int num_entries = 0;
        const fs::path folder = existing.empty() ? fs::path(".") : existing;
        for (fs::directory_iterator entry(folder, failure), end;
             !failure && entry != end && ++num_entries <= kMaxEntries;
             entry.increment(failure)) {
            // "playroom" may be "playroom.toml"
            const fs::path file = entry->path().filename();
            const std::string name =
                in_lower_case((part.has_extension() ? file : file.stem()).string());
            if (!may_be_misspelling(written, name)) continue;
            const std::size_t distance = num_edits(written, name);
            if (distance > best) continue;
            if (distance < best) meant.clear();
            best = distance;
            meant.push_back((existing / entry->path().filename()).string());
        }
        std::ranges::sort(meant);
        if (meant.size() > 3) meant.resize(3);
        return ask_which(meant);
    }
    return {};
}

}  // namespace atrium::config
