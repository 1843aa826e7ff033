#include "tools/calibrate/recording/shots.hpp"

#include "core/base/looked_up.hpp"
#include "core/base/readable.hpp"
#include "tools/calibrate/names/name_parts.hpp"
#include "tools/calibrate/recording/picture_names.hpp"

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
                                   "labelids",
                                   "matte",
                                   "mattes",
                                   "matting",
                                   "pha",
                                   "seg",
                                   "segmentation",
                                   "segmentations",
                                   "silhouette",
                                   "silhouettes"};

// Names of masks only beside pictures whose names lack the word: a camera may be called so.
const std::set<std::string> kMasksBesidePictures{
    "alpha", "alphas", "annotation", "annotations", "binary", "fg",         "foreground",
    "gt",    "human",  "id",         "ids",         "label",  "labels",     "masked",
    "out",   "output", "outputs",    "people",      "person", "prediction", "predictions",
    "pred",  "preds",  "sam",        "sam2",        "subject"};

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

// "0001_mask" -> "0001", and "0001.jpg", as COLMAP names the mask of that picture.
std::string without_word_for_mask(const std::string& whole) {
    const std::string stem = has_suffix(whole, kPictures) ? fs::path(whole).stem().string() : whole;
    std::size_t begin = stem.size();
    while (begin > 0 && std::isalpha(static_cast<unsigned char>(stem[begin - 1])) != 0) --begin;
    if (!kMasks.contains(lower(stem.substr(begin)))) return stem;
    while (begin > 0 && std::isalnum(static_cast<unsigned char>(stem[begin - 1])) == 0) --begin;
    return begin == 0 ? stem : stem.substr(0, begin);
}

// A sequence in a folder of several: its pictures have the same words before and after the number.
struct Sequence {
    std::string prefix;
    std::string tail;
    bool is_mask = false;
    auto operator<=>(const Sequence&) const = default;
};

bool have_a_number_in_common(const Shots& a, const Shots& b) {
    return std::ranges::any_of(
        a.pictures, [&](const auto& picture) { return b.pictures.contains(picture.first); });
}

class Search {
public:
    explicit Search(fs::path root)
        : root_(std::move(root)),
          has_masks_only_(kMasks.contains(lower(fs::weakly_canonical(root_).filename().string()))) {
    }

    Expected<std::vector<Shots>> run() {
        if (auto walked = walk(root_, 0); !walked) return tl::unexpected(walked.error());
        find_masks_beside_pictures();
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

    // cam1_pred.mp4 beside cam1.mp4, and the folder cam1/pred
    void find_masks_beside_pictures() {
        std::set<std::vector<std::string>> names;
        for (const Shots& shots : found_)
            if (!shots.is_mask) names.insert(tokens(shots.label));
        for (Shots& shots : found_) {
            std::vector<std::string> words = tokens(shots.label);
            const std::size_t num_words = words.size();
            while (!words.empty() && kMasksBesidePictures.contains(words.back())) words.pop_back();
            if (words.size() < num_words && !words.empty() && names.contains(words))
                shots.is_mask = true;
        }
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
        std::vector<std::string> names;
        for (const fs::path& picture : pictures)
            names.push_back(without_word_for_mask(picture.stem().string()));
        const std::vector<PictureName> split = split_names(names);
        // masks may lie beside their pictures: 0001.png, 0001_mask.png
        std::map<Sequence, Shots> sequences;
        std::set<std::string> prefixes;
        std::set<std::string> tails;
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            const std::string stem = pictures[i].stem().string();
            const bool is_mask = has_word_of(kMasks, stem) || has_suffix(stem, kPictures);
            const Sequence of{split[i].prefix, split[i].tail, is_mask};
            sequences[of].pictures[split[i].number] = pictures[i];
            sequences[of].time_unit = split[i].time_unit;
            prefixes.insert(of.prefix);
            tails.insert(of.tail);
        }
        for (auto& [of, shots] : sequences) {
            const auto plain = sequences.find({of.prefix, "", false});
            const bool is_beside = !of.tail.empty() && has_word_of(kMasksBesidePictures, of.tail) &&
                                   plain != sequences.end() &&
                                   have_a_number_in_common(shots, plain->second);
            const std::string name =
                of.prefix + (tails.size() > 1 && !is_beside ? of.tail : std::string());
            shots.path = folder;
            shots.is_mask = of.is_mask || is_beside;
            const bool is_one_of_several = prefixes.size() > 1 || (tails.size() > 1 && !is_beside);
            shots.label = label_of(is_one_of_several && !name.empty() ? folder / name : folder);
            if (prefixes.size() == 1 && names_empty_room(of.prefix))
                shots.label = label_of(folder / of.prefix);
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
