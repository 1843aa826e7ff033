#include "tools/calibrate/recording/instants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <vector>

namespace atrium::calibrate {
namespace {

// Of pictures that were counted by one: the numbers in their files' names.
std::string range_text(std::size_t first, std::size_t last, const Numbering& files) {
    first = files.first + (first - files.first) * files.step;
    last = files.first + (last - files.first) * files.step;
    return numbers_text(first, last);
}

// "7, 12 to 14", and how many more ranges there are. `missing` and `all` ascend.
std::string missing_text(const std::vector<std::size_t>& missing,
                         const std::vector<std::size_t>& all,
                         const Numbering& files) {
    constexpr std::size_t kMaxRanges = 3;
    std::string text;
    std::size_t num_ranges = 0;
    auto at = all.begin();
    for (std::size_t i = 0; i < missing.size();) {
        while (*at != missing[i]) ++at;
        std::size_t last = i;
        // numbers that no camera has do not end a range
        while (last + 1 < missing.size() && *++at == missing[last + 1]) ++last;
        if (++num_ranges <= kMaxRanges)
            text += (text.empty() ? "" : ", ") + range_text(missing[i], missing[last], files);
        i = last + 1;
    }
    if (num_ranges > kMaxRanges) text += fmt::format(" and {} more gaps", num_ranges - kMaxRanges);
    return text;
}

}  // namespace

Numbering numbering_of(const std::map<std::string, Shots>& shots) {
    constexpr std::size_t kFewest = 4;
    std::set<std::size_t> numbers;
    for (const auto& [camera, one] : shots)
        for (const auto& [number, file] : one.pictures) numbers.insert(number);
    if (numbers.empty()) return {};
    Numbering result{*numbers.begin(), 1};
    if (numbers.size() < kFewest) return result;
    std::size_t step = 0;
    for (const std::size_t number : numbers) step = std::gcd(step, number - result.first);
    result.step = step;
    return result;
}

std::string numbers_text(std::size_t first, std::size_t last) {
    return first == last ? fmt::format("{}", first) : fmt::format("{} to {}", first, last);
}

OtherInstants find_other_instants(const std::map<std::string, Shots>& frames) {
    std::map<std::size_t, std::size_t> num_cameras;  // by number of a picture
    std::size_t num_numbered = 0;
    for (const auto& [camera, shots] : frames) {
        for (const auto& [number, file] : shots.pictures) ++num_cameras[number];
        if (!shots.pictures.empty()) ++num_numbered;
    }
    if (num_numbered < 3) return {};
    const auto common =
        std::ranges::max_element(num_cameras, {}, [](const auto& entry) { return entry.second; });
    if (2 * common->second <= num_numbered || common->second == num_numbered) return {};
    std::set<std::size_t> numbers;  // of the cameras that have the common one
    for (const auto& [camera, shots] : frames) {
        if (!shots.pictures.contains(common->first)) continue;
        for (const auto& [number, file] : shots.pictures) numbers.insert(number);
    }
    OtherInstants others{{}, *numbers.begin(), *numbers.rbegin()};
    for (const auto& [camera, shots] : frames) {
        if (shots.pictures.empty() || shots.pictures.contains(common->first)) continue;
        // a camera that shares some number is one with gaps
        if (std::ranges::any_of(shots.pictures,
                                [&](const auto& one) { return numbers.contains(one.first); }))
            return {};
        others.cameras.push_back(camera);
    }
    return others;
}

void count_by_one(std::map<std::string, Shots>& shots, const Numbering& numbering) {
    if (numbering.step < 2) return;
    std::size_t first = std::numeric_limits<std::size_t>::max();
    for (const auto& [camera, one] : shots)
        if (!one.pictures.empty()) first = std::min(first, one.pictures.begin()->first);
    if (first >= numbering.first && (first - numbering.first) % numbering.step == 0)
        first = numbering.first;
    for (const auto& [camera, one] : shots)
        for (const auto& [number, file] : one.pictures)
            if ((number - first) % numbering.step != 0) return;
    for (auto& [camera, one] : shots) {
        std::map<std::size_t, std::filesystem::path> counted;
        for (const auto& [number, file] : one.pictures)
            counted[first + (number - first) / numbering.step] = file;
        one.pictures = std::move(counted);
    }
}

std::string doubt_of_lengths(const std::map<std::string, Shots>& frames,
                             const std::map<std::string, Look>& looks) {
    constexpr std::size_t kMaxNamed = 12;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    std::size_t most = 0;
    for (const auto& [camera, shots] : frames) {
        if (!shots.is_video) return {};
        if (looks.at(camera).num_frames == 0) continue;  // unknown
        fewest = std::min(fewest, looks.at(camera).num_frames);
        most = std::max(most, looks.at(camera).num_frames);
    }
    if (fewest >= most) return {};
    std::string shorter;
    std::size_t num_shorter = 0;
    for (const auto& [camera, look] : looks) {
        if (look.num_frames == most || look.num_frames == 0 || ++num_shorter > kMaxNamed) continue;
        shorter +=
            fmt::format("{}'{}' has {}", shorter.empty() ? "" : ", ", camera, look.num_frames);
    }
    if (num_shorter > kMaxNamed) shorter += ", ...";
    return fmt::format(
        "instants: the videos have {} to {} pictures: {}. Picture N of every camera is taken as "
        "one "
        "instant, so all must begin at the same one; if a camera started late, cut the beginning "
        "of "
        "the others",
        fewest,
        most,
        shorter);
}

Expected<Instants> compare_instants(const std::map<std::string, Shots>& frames,
                                    const Numbering& files) {
    std::set<std::size_t> numbers;
    std::string ranges;
    for (const auto& [camera, shots] : frames) {
        if (shots.is_video || shots.pictures.empty()) continue;
        for (const auto& [number, file] : shots.pictures) numbers.insert(number);
        ranges += fmt::format(
            "{}{} of '{}'",
            ranges.empty() ? "" : ", ",
            range_text(shots.pictures.begin()->first, shots.pictures.rbegin()->first, files),
            camera);
    }
    if (numbers.empty()) return Instants{};
    const std::vector<std::size_t> all(numbers.begin(), numbers.end());
    std::string gaps;
    for (const auto& [camera, shots] : frames) {
        if (shots.is_video) continue;
        std::vector<std::size_t> missing;
        for (const std::size_t number : all) {
            if (!shots.pictures.contains(number)) missing.push_back(number);
        }
        for (const std::size_t number : missing) numbers.erase(number);
        if (missing.empty()) continue;
        gaps += fmt::format("{}'{}' has no {}",
                            gaps.empty() ? "" : "; ",
                            camera,
                            missing_text(missing, all, files));
    }
    if (numbers.empty()) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("the pictures have no number in common, so no two are of one "
                                      "instant: {}; renumber them, the same instant with the same "
                                      "number, or leave cameras out: --cameras '!NAME'",
                                      ranges));
    }
    Instants result{*numbers.begin(), {}};
    if (!gaps.empty()) {
        result.doubt = fmt::format(
            "instants: pictures of one number are one instant, and {} of {} instants are complete; "
            "the site leaves the others out. By the numbers in the files' names, {}",
            numbers.size(),
            all.size(),
            gaps);
    }
    return result;
}

}  // namespace atrium::calibrate
