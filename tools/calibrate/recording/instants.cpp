#include "tools/calibrate/recording/instants.hpp"

#include "tools/calibrate/recording/picture_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

namespace atrium::calibrate {
namespace {

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
            text += (text.empty() ? "" : ", ") + files.text(missing[i], missing[last]);
        i = last + 1;
    }
    if (num_ranges > kMaxRanges) text += fmt::format(" and {} more gaps", num_ranges - kMaxRanges);
    return text;
}

// 1 if the steps differ, or for few numbers.
std::size_t step_of(const std::vector<std::uint64_t>& numbers) {
    constexpr std::size_t kFewest = 4;
    if (numbers.size() < kFewest) return 1;
    std::uint64_t step = 0;
    for (const std::uint64_t number : numbers) step = std::gcd(step, number - numbers.front());
    return step;
}

// Whether the names of all pictures have times, or look like them.
std::optional<Numbering::Times> times_of(const std::map<std::string, Shots>& shots) {
    CameraTimes cameras;
    std::vector<std::vector<std::uint64_t>> numbers;
    bool have_times = true;
    std::string unit;
    for (const auto& [camera, one] : shots) {
        if (one.is_video || one.pictures.empty()) continue;
        have_times = have_times && !one.time_unit.empty();
        unit = one.time_unit;
        std::vector<std::uint64_t>& own = numbers.emplace_back();
        for (const auto& [number, file] : one.pictures) own.push_back(number);
        cameras[camera] = own;
    }
    Numbering::Times times{unit, !have_times, 1, {}, {}};
    if (!have_times) {
        const auto num_even =
            std::ranges::count_if(numbers, [](const auto& own) { return step_of(own) > 1; });
        if (2 * num_even >= std::ssize(numbers)) return std::nullopt;
        const auto looks_like = unit_of_numbers(numbers);
        if (!looks_like) return std::nullopt;
        times.unit = looks_like->name;
        times.nanoseconds = looks_like->nanoseconds;
        for (auto& [camera, own] : cameras)
            for (std::uint64_t& number : own) number *= times.nanoseconds;
    }
    auto grid = grid_of(cameras);
    if (!grid) return std::nullopt;
    times.grid = std::move(*grid);
    for (const auto& [camera, own] : times.grid.numbers)
        for (const auto& [time, number] : own)
            times.names.emplace(
                number, shots.at(camera).pictures.at(time / times.nanoseconds).stem().string());
    return times;
}

// By the times of the frames, which masks share.
void count_times(std::map<std::string, Shots>& shots, const Numbering::Times& times) {
    std::size_t num = 0;
    std::map<std::string, std::map<std::size_t, std::filesystem::path>> counted;
    std::size_t num_counted = 0;
    for (const auto& [camera, one] : shots) {
        num += one.pictures.size();
        const auto numbers = times.grid.numbers.find(camera);
        if (numbers == times.grid.numbers.end()) continue;
        for (const auto& [number, file] : one.pictures) {
            const auto found = numbers->second.find(number * times.nanoseconds);
            if (found == numbers->second.end()) continue;
            counted[camera][found->second] = file;
            ++num_counted;
        }
    }
    if (2 * num_counted < num) return;
    for (auto& [camera, one] : shots)
        if (const auto own = counted.find(camera); own != counted.end())
            one.pictures = std::move(own->second);
}

}  // namespace

std::string Numbering::text(std::size_t from, std::size_t to) const {
    if (times) {
        const auto name_of = [&](std::size_t number) {
            const auto found = times->names.find(number);
            return found == times->names.end() ? fmt::format("instant {}", number) : found->second;
        };
        return from == to ? name_of(from) : fmt::format("{} to {}", name_of(from), name_of(to));
    }
    const std::size_t begin = first + (from - first) * step;
    const std::size_t end = first + (to - first) * step;
    return begin == end ? fmt::format("{}", begin) : fmt::format("{} to {}", begin, end);
}

Numbering numbering_of(const std::map<std::string, Shots>& shots) {
    std::set<std::size_t> numbers;
    for (const auto& [camera, one] : shots)
        for (const auto& [number, file] : one.pictures) numbers.insert(number);
    if (numbers.empty()) return {};
    Numbering result{*numbers.begin(), 1};
    result.times = times_of(shots);
    if (!result.times) result.step = step_of({numbers.begin(), numbers.end()});
    return result;
}

std::string doubt_of_sparse_numbers(const std::map<std::string, Shots>& shots,
                                    const Numbering& files) {
    constexpr std::size_t kFewest = 4;
    std::set<std::size_t> numbers;
    for (const auto& [camera, one] : shots)
        for (const auto& [number, file] : one.pictures) numbers.insert(number);
    if (numbers.size() < kFewest) return {};
    const std::size_t num_instants = *numbers.rbegin() - *numbers.begin() + 1;
    if (2 * numbers.size() >= num_instants) return {};
    return fmt::format(
        "instants: only {} of {} instants from {} have pictures, because each number between is an "
        "instant: {}",
        numbers.size(),
        num_instants,
        files.text(*numbers.begin(), *numbers.rbegin()),
        files.times
            ? "the cameras paused; give the pictures of each part a folder of its own, and "
              "import it alone"
            : "the site shows nobody at the others; renumber the pictures without gaps, the "
              "same instant with the same number");
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
    if (numbering.times) return count_times(shots, *numbering.times);
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
        "one instant, so all must begin at the same one; if a camera started late, cut the "
        "beginning of the others; if it lost pictures in between, give pictures that have their "
        "times in their names",
        fewest,
        most,
        shorter);
}

std::string doubt_of_listed_times(const std::map<std::string, Shots>& frames) {
    namespace fs = std::filesystem;
    std::set<fs::path> folders;
    for (const auto& [camera, shots] : frames) {
        if (!shots.is_video) return {};
        folders.insert(shots.path.parent_path());
    }
    for (const fs::path& folder : folders) {
        std::error_code failure;
        for (fs::directory_iterator it(folder, failure), end; !failure && it != end;
             it.increment(failure)) {
            const fs::path& file = it->path();
            if (file.extension() != ".csv" ||
                file.filename().string().find("time") == std::string::npos)
                continue;
            return fmt::format(
                "instants: {} is not read. Picture N of every camera is taken as one instant: if "
                "it "
                "says that cameras began at different times, cut the beginnings of the others "
                "(ffmpeg -ss SECONDS -i FILE -c copy OUT), until all begin at the same one",
                file.string());
        }
    }
    return {};
}

Expected<Instants> compare_instants(const std::map<std::string, Shots>& frames,
                                    const Numbering& files) {
    std::set<std::size_t> numbers;
    std::string ranges;
    for (const auto& [camera, shots] : frames) {
        if (shots.is_video || shots.pictures.empty()) continue;
        for (const auto& [number, file] : shots.pictures) numbers.insert(number);
        ranges +=
            fmt::format("{}{} of '{}'",
                        ranges.empty() ? "" : ", ",
                        files.text(shots.pictures.begin()->first, shots.pictures.rbegin()->first),
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
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("the pictures have no {} in common, so no two are of one "
                        "instant: {}; {}, or leave cameras out: --cameras '!NAME'",
                        files.times ? "time" : "number",
                        ranges,
                        files.times ? "the clocks of the cameras differ: set them and record "
                                      "again, or number the pictures instead, the same "
                                      "instant with the same number"
                                    : "renumber them, the same instant with the same "
                                      "number"));
    }
    Instants result{*numbers.begin(), {}};
    if (!gaps.empty()) {
        result.doubt = fmt::format(
            "instants: pictures of one {} are one instant, and {} of {} instants are complete; "
            "the site leaves the others out. By the {} in the files' names, {}",
            files.times ? "time" : "number",
            numbers.size(),
            all.size(),
            files.times ? "times" : "numbers",
            gaps);
    }
    return result;
}

}  // namespace atrium::calibrate
