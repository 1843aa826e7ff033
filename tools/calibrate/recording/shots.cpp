#include "tools/calibrate/recording/shots.hpp"

#include "core/base/looked_up.hpp"

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
constexpr int kByName = 70;            // likeness of names, not only of numbers
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
                                         "cleanplates",
                                         "static"};
const std::set<std::string> kMasks{"mask",
                                   "masks",
                                   "matte",
                                   "mattes",
                                   "seg",
                                   "segmentation",
                                   "segmentations",
                                   "silhouette",
                                   "silhouettes"};

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

bool has_suffix(const fs::path& file, std::span<const char* const> suffixes) {
    const std::string suffix = lower(file.extension().string());
    return std::ranges::any_of(suffixes, [&](const char* known) { return suffix == known; });
}

// Runs of letters, in lower case, and of digits, without leading zeros.
std::vector<std::string> tokens(const std::string& text) {
    std::vector<std::string> result;
    char kind = ' ';
    for (const char raw : text) {
        const auto c = static_cast<unsigned char>(raw);
        const char here = std::isdigit(c) != 0 ? '1' : std::isalpha(c) != 0 ? 'a' : ' ';
        if (here != kind && here != ' ') result.emplace_back();
        kind = here;
        if (here == ' ') continue;
        if (here == '1' && result.back() == "0") result.back().clear();
        result.back() += static_cast<char>(std::tolower(c));
    }
    return result;
}

bool is_number(const std::string& token) {
    return !token.empty() && std::isdigit(static_cast<unsigned char>(token.front())) != 0;
}

std::vector<std::string> parts_of(const std::string& label) {
    std::vector<std::string> parts;
    for (const fs::path& part : fs::path(label)) parts.push_back(part.string());
    return parts;
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
        shots.is_background = has_word_of(kBackgrounds, shots.label);
        shots.is_mask = shots.is_mask || has_masks_only_ || has_word_of(kMasks, shots.label);
        found_.push_back(std::move(shots));
    }

    Expected<void> walk(const fs::path& folder, int depth) {
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
            if (path.filename().string().starts_with(".")) continue;
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
            if (prefixes.size() == 1 && has_word_of(kBackgrounds, prefix))
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

// Tokens that all labels have at the same place from the start or from the end say nothing.
std::vector<std::string> telling_tokens(const std::string& label,
                                        const std::vector<std::string>& others) {
    std::vector<std::string> own = tokens(label);
    std::size_t front = own.size();
    std::size_t back = own.size();
    bool is_only = true;
    for (const std::string& other : others) {
        if (other == label) continue;
        is_only = false;
        const std::vector<std::string> theirs = tokens(other);
        std::size_t same = 0;
        while (same < std::min(own.size(), theirs.size()) && own[same] == theirs[same]) ++same;
        front = std::min(front, same);
        same = 0;
        while (same < std::min(own.size(), theirs.size()) &&
               own[own.size() - 1 - same] == theirs[theirs.size() - 1 - same])
            ++same;
        back = std::min(back, same);
    }
    if (is_only || front + back >= own.size()) return own;
    return {own.begin() + static_cast<std::ptrdiff_t>(front),
            own.end() - static_cast<std::ptrdiff_t>(back)};
}

bool contains_run(const std::vector<std::string>& all, const std::vector<std::string>& run) {
    return !run.empty() && !std::ranges::search(all, run).empty();
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += word;
    return text;
}

}  // namespace

Expected<std::vector<Shots>> find_shots(const fs::path& folder) {
    std::error_code failure;
    if (!fs::is_directory(folder, failure)) {
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("{}: no such folder{}", folder.string(), looked_up_from(folder)));
    }
    return Search(folder).run();
}

int likeness(const std::string& camera,
             const std::string& label,
             const std::vector<std::string>& others,
             const std::vector<std::string>& cameras) {
    const std::vector<std::string> name = tokens(camera);
    const std::vector<std::string> telling = telling_tokens(label, others);
    int best = 0;
    // "left" of "cam_left.json" and "left" of "take2_left.mp4"
    if (!cameras.empty() && !telling.empty() && telling == telling_tokens(camera, cameras))
        best = 85;
    for (const std::string& part : parts_of(label)) {
        if (lower(part) == lower(camera)) return 100;
        if (joined(tokens(part)) == joined(name) && !name.empty()) best = std::max(best, 90);
        if (name.size() > 1 && contains_run(tokens(part), name)) best = std::max(best, 80);
    }
    if (contains_run(telling, name)) best = std::max(best, 70);
    const auto number = std::find_if(name.rbegin(), name.rend(), is_number);
    if (number != name.rend() && std::ranges::find(telling, *number) != telling.end())
        best = std::max(best, 50);
    return best;
}

Expected<Matches> match_shots(const std::vector<std::string>& cameras,
                              const std::vector<Shots>& shots) {
    std::vector<std::string> labels;
    for (const Shots& one : shots)
        if (!one.is_alone) labels.push_back(one.label);
    const std::vector<std::string> none;  // what tells single pictures apart is no camera's name
    Matches matches;
    std::map<std::string, std::string> taken;  // label -> camera
    for (const std::string& camera : cameras) {
        int best = 0;
        std::vector<const Shots*> fitting;
        for (const Shots& one : shots) {
            const int like = likeness(camera, one.label, labels, one.is_alone ? none : cameras);
            // the number of one picture is that of a frame; and a whole folder goes before it
            if (one.is_alone && like < kByName) continue;
            const int points = 2 * like - (one.is_alone ? 1 : 0);
            if (points < 2 || points < best) continue;
            if (points > best) fitting.clear();
            best = points;
            fitting.push_back(&one);
        }
        if (fitting.empty()) {
            matches.missing.push_back(camera);
            continue;
        }
        const Shots& chosen = *fitting.front();
        if (fitting.size() > 1) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("camera '{}' may be '{}' or '{}'; name the folder of one "
                                          "recording, move other pictures away, or give the "
                                          "pictures the names of the cameras; an empty room is "
                                          "given with --background",
                                          camera,
                                          chosen.label,
                                          fitting[1]->label));
        }
        if (const auto [former, is_new] = taken.emplace(chosen.label, camera); !is_new) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("'{}' fits both camera '{}' and camera '{}'; give the "
                                          "pictures the names of the cameras",
                                          chosen.label,
                                          former->second,
                                          camera));
        }
        matches.by_camera[camera] = chosen;
    }
    return matches;
}

}  // namespace atrium::calibrate
