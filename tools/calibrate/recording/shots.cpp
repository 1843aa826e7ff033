#include "tools/calibrate/recording/shots.hpp"

#include "core/base/looked_up.hpp"
#include "core/base/readable.hpp"
#include "tools/calibrate/names/name_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <span>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxFolders = 4;
constexpr std::size_t kMaxFiles = 200'000;
constexpr std::size_t kMaxAlone = 64;  // a folder with one picture per camera has no more
constexpr std::array kVideos{
    ".avi", ".mp4", ".mkv", ".mov", ".m4v", ".webm", ".mpg", ".mpeg", ".wmv"};
constexpr std::array kPictures{".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".ppm", ".pgm"};
const std::set<std::string> kBackgrounds{"background",
                                         "backgrounds",
                                         "bg",
                                         "bgs",
                                         "bkg",
                                         "empty",
                                         "emptyroom",
                                         "plate",
                                         "plates",
                                         "cleanplate",
                                         "cleanplates"};
// Also a trial in which a person stands still.
const std::set<std::string> kStatics{"static"};
const std::set<std::string> kMasks{"mask",
                                   "masks",
                                   "matte",
                                   "mattes",
                                   "seg",
                                   "segmentation",
                                   "segmentations",
                                   "silhouette",
                                   "silhouettes"};

bool has_suffix(const fs::path& file, std::span<const char* const> suffixes) {
    const std::string suffix = lower(file.extension().string());
    return std::ranges::any_of(suffixes, [&](const char* known) { return suffix == known; });
}

bool has_word_of(const std::set<std::string>& words, const std::string& label) {
    for (const std::string& part : parts_of(label)) {
        if (words.contains(lower(part))) return true;
        for (const std::string& token : tokens(part))
            if (words.contains(token)) return true;
    }
    return false;
}

struct Numbered {
    std::string prefix;
    std::size_t number = 0;
};

// "0001_mask" -> "0001", and "0001.jpg", as COLMAP names the mask of that picture.
std::string without_word_for_mask(const std::string& whole) {
    const std::string stem = has_suffix(whole, kPictures) ? fs::path(whole).stem().string() : whole;
    std::size_t begin = stem.size();
    while (begin > 0 && std::isalpha(static_cast<unsigned char>(stem[begin - 1])) != 0) --begin;
    if (!kMasks.contains(lower(stem.substr(begin)))) return stem;
    while (begin > 0 && std::isalnum(static_cast<unsigned char>(stem[begin - 1])) == 0) --begin;
    return begin == 0 ? stem : stem.substr(0, begin);
}

// "cam1_000012" -> "cam1", 12. Without a number: the stem, 0.
Numbered split_number(const std::string& whole) {
    const std::string stem = without_word_for_mask(whole);
    std::size_t begin = stem.size();
    while (begin > 0 && std::isdigit(static_cast<unsigned char>(stem[begin - 1])) != 0) --begin;
    const std::string digits = stem.substr(begin);
    std::string prefix = stem.substr(0, begin);
    while (!prefix.empty() && std::isalnum(static_cast<unsigned char>(prefix.back())) == 0)
        prefix.pop_back();
    if (digits.empty() || digits.size() > 18) return {whole, 0};
    return {prefix, static_cast<std::size_t>(std::stoull(digits))};
}

class Search {
public:
    explicit Search(fs::path root)
        : root_(std::move(root)),
          has_masks_only_(kMasks.contains(lower(fs::weakly_canonical(root_).filename().string()))) {
    }

    Expected<std::vector<Shots>> run() {
        if (auto walked = walk(root_, 0); !walked) return tl::unexpected(walked.error());
        std::ranges::sort(found_, {}, &Shots::label);
        return std::move(found_);
    }

private:
    std::string label_of(const fs::path& path) const {
        const std::string label = path.lexically_relative(root_).string();
        return label == "." ? "" : label;
    }
    void add(Shots shots) {
        const bool is_room = has_word_of(kBackgrounds, shots.label);
        shots.is_static = !is_room && has_word_of(kStatics, shots.label);
        shots.is_background = is_room || shots.is_static;
        shots.is_mask = shots.is_mask || has_masks_only_ || has_word_of(kMasks, shots.label);
        found_.push_back(std::move(shots));
    }

    Expected<void> walk(const fs::path& folder, int depth) {
        if (auto readable = check_folder_readable(folder); !readable) return readable;
        std::vector<fs::path> pictures;
        std::error_code failure;
        for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
             entry.increment(failure)) {
            const fs::path path = entry->path();
            if (++num_files_ > kMaxFiles) {
                return make_error(ErrorKind::kInvalidData,
                                  fmt::format("{}: more than {} files; name the folder of one "
                                              "recording",
                                              root_.string(),
                                              kMaxFiles));
            }
            // lost+found: only root may look into it, and it is in every disk's root
            const std::string name = path.filename().string();
            if (name.starts_with(".") || name == "lost+found") continue;
            if (entry->is_directory(failure) && depth < kMaxFolders) {
                if (auto walked = walk(path, depth + 1); !walked) return walked;
            } else if (has_suffix(path, kVideos)) {
                add({path, true, {}, label_of(path.parent_path() / path.stem())});
            } else if (has_suffix(path, kPictures)) {
                pictures.push_back(path);
            }
        }
        add_pictures(folder, pictures);
        return {};
    }

    // A folder is the sequence of one camera, or of one camera per prefix; or has one picture each.
    void add_pictures(const fs::path& folder, const std::vector<fs::path>& pictures) {
        // masks may lie beside their pictures: 0001.png, 0001_mask.png
        std::map<std::pair<std::string, bool>, Shots> by_prefix;
        std::set<std::string> prefixes;
        for (const fs::path& picture : pictures) {
            const std::string stem = picture.stem().string();
            const Numbered numbered = split_number(stem);
            const bool is_mask = has_word_of(kMasks, stem) || has_suffix(stem, kPictures);
            by_prefix[{numbered.prefix, is_mask}].pictures[numbered.number] = picture;
            prefixes.insert(numbered.prefix);
        }
        for (auto& [key, shots] : by_prefix) {
            const auto& [prefix, is_mask] = key;
            shots.path = folder;
            shots.is_mask = is_mask;
            shots.label = label_of(prefixes.size() > 1 ? folder / prefix : folder);
            if (prefixes.size() == 1 && names_empty_room(prefix))
                shots.label = label_of(folder / prefix);
            add(shots);
        }
        if (pictures.size() > kMaxAlone) return;
        for (const fs::path& picture : pictures) {
            Shots alone{folder, false, {{0, picture}}, label_of(folder / picture.stem())};
            alone.is_alone = true;
            add(alone);
        }
    }

    fs::path root_;
    bool has_masks_only_;  // the folder that was named is one of masks
    std::vector<Shots> found_;
    std::size_t num_files_ = 0;
};

}  // namespace

bool names_empty_room(const std::string& label) {
    return has_word_of(kBackgrounds, label) || has_word_of(kStatics, label);
}

Expected<std::vector<Shots>> find_shots(const fs::path& folder) {
    std::error_code failure;
    if (fs::is_regular_file(folder, failure)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: is a file; give its folder", folder.string()));
    }
    if (!fs::is_directory(folder, failure)) {
        if (auto readable = check_folder_readable(folder);
            !readable && readable.error().kind != ErrorKind::kNotFound)
            return tl::unexpected(readable.error());
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("{}: no such folder{}", folder.string(), looked_up_from(folder)));
    }
    return Search(folder).run();
}

}  // namespace atrium::calibrate
