#include "tools/calibrate/formats/folder_files.hpp"

#include "core/base/readable.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <iterator>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

bool holds_colmap_model(const fs::path& folder) {
    std::error_code failure;
    return fs::exists(folder / "cameras.txt", failure) ||
           fs::exists(folder / "images.txt", failure) ||
           fs::exists(folder / "cameras.bin", failure) ||
           fs::exists(folder / "images.bin", failure);
}

// The models of COLMAP in its usual folders: FOLDER/0, FOLDER/sparse, FOLDER/sparse/0.
Files models_below(const fs::path& folder) {
    constexpr std::size_t kMaxModels = 8;
    Files models;
    for (const fs::path& place : {folder, folder / "sparse"}) {
        std::error_code failure;
        for (fs::directory_iterator entry(place, failure), end;
             !failure && entry != end && models.size() < kMaxModels;
             entry.increment(failure)) {
            if (holds_colmap_model(entry->path())) models.push_back(entry->path());
        }
    }
    std::ranges::sort(models);
    return models;
}

constexpr std::array kSuffixes{".yml", ".yaml", ".json", ".xml", ".toml", ".xcp"};

bool may_be_calibration(const fs::path& file) {
    const std::string suffix = suffix_of(file);
    return std::ranges::any_of(kSuffixes, [&](const char* known) { return suffix == known; }) ||
           file.filename().string().ends_with(".qca.txt");
}

Files calibrations_in(const fs::path& folder) {
    constexpr std::size_t kMaxFiles = 256;
    Files inside;
    std::error_code failure;
    for (fs::directory_iterator entry(folder, failure), end;
         !failure && entry != end && inside.size() < kMaxFiles;
         entry.increment(failure)) {
        if (may_be_calibration(entry->path()) && entry->is_regular_file(failure))
            inside.push_back(entry->path());
    }
    return inside;
}

// Up to two folders below: a user may give the folder of all that a program keeps.
Files calibrations_below(const fs::path& folder) {
    constexpr int kDeepest = 2;
    constexpr std::size_t kMaxFolders = 1000;
    Files found;
    std::error_code failure;
    std::size_t num_folders = 0;
    for (fs::recursive_directory_iterator
             entry(folder, fs::directory_options::skip_permission_denied, failure),
         end;
         !failure && entry != end && num_folders < kMaxFolders;
         entry.increment(failure)) {
        std::error_code ignored;
        if (!entry->is_directory(ignored)) continue;
        ++num_folders;
        if (entry.depth() + 1 == kDeepest) entry.disable_recursion_pending();
        if (holds_colmap_model(entry->path())) {
            found.push_back(entry->path());
        } else {
            std::ranges::copy(calibrations_in(entry->path()), std::back_inserter(found));
        }
    }
    std::ranges::sort(found);
    return found;
}

tl::unexpected<Error> without_calibration(const fs::path& folder) {
    constexpr std::size_t kNamed = 4;
    const Files below = calibrations_below(folder);
    std::string names;
    for (std::size_t i = 0; i < std::min(below.size(), kNamed); ++i)
        names += fmt::format("{}'{}'", i == 0 ? "" : ", ", below[i].string());
    if (!names.empty()) {
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("{}: this folder holds no calibration itself, but below it there {} {}{}; "
                        "give that of these cameras",
                        folder.string(),
                        below.size() == 1 ? "is" : "are",
                        names,
                        below.size() > kNamed ? ", ..." : ""));
    }
    return make_error(
        ErrorKind::kNotFound,
        fmt::format("{}: a folder without a calibration: neither cameras and images of a model of "
                    "COLMAP (.txt or .bin, often in sparse/0) nor {}, .qca.xml, .qca.txt; give the "
                    "calibration files",
                    folder.string(),
                    fmt::join(kSuffixes, ", ")));
}

}  // namespace

std::string suffix_of(const fs::path& file) {
    std::string suffix = file.extension().string();
    std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return std::tolower(c); });
    return suffix;
}

tl::unexpected<Error> several_of(const Files& files,
                                 const std::string& what,
                                 const std::string& cure) {
    std::string names;
    for (const fs::path& file : files) names += (names.empty() ? "" : ", ") + file.string();
    const fs::path folder = files.front().parent_path();
    const bool is_one_folder = std::ranges::all_of(
        files, [&](const fs::path& file) { return file.parent_path() == folder; });
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("{} {} {}: {}; {}",
                                  is_one_folder ? "this folder holds" : "these files are",
                                  files.size(),
                                  what,
                                  names,
                                  cure));
}

Expected<Files> with_folders_opened(const Files& files) {
    Files result;
    for (const fs::path& file : files) {
        std::error_code failure;
        if (!fs::is_directory(file, failure) || holds_colmap_model(file)) {
            result.push_back(file);
            continue;
        }
        if (auto readable = check_folder_readable(file); !readable)
            return tl::unexpected(readable.error());
        Files inside = calibrations_in(file);
        const auto rigs = std::ranges::partition(inside, std::not_fn(is_rig_file));
        if (rigs.size() == inside.size()) {
            if (Files models = models_below(file); !models.empty()) inside = std::move(models);
        } else {  // those that an import wrote beside its calibration
            inside.erase(rigs.begin(), rigs.end());
        }
        if (inside.size() > 1 && holds_colmap_model(inside.front()))
            return several_of(inside, "models of COLMAP", "give the one with all cameras");
        if (inside.empty()) return without_calibration(file);
        std::ranges::sort(inside);
        result.insert(result.end(), inside.begin(), inside.end());
    }
    return result;
}

}  // namespace atrium::calibrate
