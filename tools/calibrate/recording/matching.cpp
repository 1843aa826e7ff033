#include "tools/calibrate/recording/matching.hpp"

#include "tools/calibrate/names/name_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <string_view>

namespace atrium::calibrate {
namespace {

bool contains_run(const std::vector<std::string>& all, const std::vector<std::string>& run) {
    return !run.empty() && !std::ranges::search(all, run).empty();
}

// "left_back" is "leftback", but 1 and 11 are not 11 and 1.
std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) {
        const bool is_after_digit =
            !text.empty() && std::isdigit(static_cast<unsigned char>(text.back())) != 0;
        text += (is_number(word) && is_after_digit ? "_" : "") + word;
    }
    return text;
}

// Whether a word for a camera ends before `at`: "camA", "Cam A", "camera_A". `part` is in lower
// case.
bool follows_word_for_camera(const std::string& part, std::size_t at) {
    constexpr std::string_view kWhole = "camera";
    std::size_t end = at;
    while (end > 0 && std::string_view(" _-.").find(part[end - 1]) != std::string_view::npos) --end;
    return std::ranges::any_of(std::array{kWhole, std::string_view("kamera"), kWhole.substr(0, 3)},
                               [&](std::string_view word) {
                                   const std::string_view before(part.data(), end);
                                   if (!before.ends_with(word)) return false;
                                   const std::size_t begin = end - word.size();
                                   // "era" of "camera" is no name
                                   const bool is_cut =
                                       part.compare(begin, kWhole.size(), kWhole) == 0 &&
                                       at < begin + kWhole.size();
                                   return !is_cut && (begin == 0 || !is_letter(part[begin - 1]));
                               });
}

// Where the whole of `name` is in `part`, not as a piece of a longer word or number.
std::vector<std::size_t> places_of(const std::string& name, const std::string& part) {
    const auto ends_at = [&](std::size_t i) {
        return i >= part.size() ||
               (!is_letter(part[i]) && std::isdigit(static_cast<unsigned char>(part[i])) == 0);
    };
    std::vector<std::size_t> places;
    for (std::size_t at = part.find(name); at != std::string::npos; at = part.find(name, at + 1))
        if ((at == 0 || ends_at(at - 1) || follows_word_for_camera(part, at)) &&
            ends_at(at + name.size()))
            places.push_back(at);
    return places;
}

// Whether `name` is in `part` other than inside `longer`: "back" is not in "left_back" of the
// camera "left_back".
bool is_beside(const std::string& name, const std::string& longer, const std::string& part) {
    const std::vector<std::size_t> around = places_of(longer, part);
    return std::ranges::any_of(places_of(name, part), [&](std::size_t at) {
        return std::ranges::none_of(around, [&](std::size_t from) {
            return at >= from && at + name.size() <= from + longer.size();
        });
    });
}

// How wholly the pictures have a camera's name.
enum class Whole : std::uint8_t { kNo, kPart, kAfterWordForCamera, kEqual };

bool is_after_word_for_camera(const std::string& name, const std::string& part) {
    return std::ranges::any_of(places_of(name, part),
                               [&](std::size_t at) { return follows_word_for_camera(part, at); });
}

Whole whole_name(const std::string& camera,
                 const std::string& label,
                 const std::vector<std::string>& cameras) {
    Whole best = Whole::kNo;
    const std::string name = lower(camera);
    const std::vector<std::string> words = tokens(camera);
    const bool is_mere_number = words.size() == 1 && is_number(words.front());
    const std::vector<std::string> parts = parts_of(label);
    for (const std::string& raw : parts) {
        const std::string part = lower(raw);
        if (part == name) return Whole::kEqual;
        if (part == "cams" && &raw != &parts.back()) continue;  // the folder of all, not of "S"
        // a number alone may be that of a take
        if (is_mere_number || places_of(name, part).empty()) continue;
        const bool is_own = std::ranges::all_of(cameras, [&](const std::string& other) {
            return other.size() <= name.size() || is_beside(name, lower(other), part);
        });
        if (is_own)
            best = std::max(
                best,
                is_after_word_for_camera(name, part) ? Whole::kAfterWordForCamera : Whole::kPart);
    }
    return best;
}

// Gives each camera the pictures that have its whole name and that of no other camera.
class WholeNames {
public:
    WholeNames(const std::vector<std::string>& cameras, const std::vector<Shots>& shots) {
        for (const Shots& one : shots) claim(cameras, one);
        for (const auto& [camera, claims] : claims_) {
            const Claim& best = *std::ranges::max_element(claims, {}, &Claim::points);
            if (std::ranges::count(claims, best.points, &Claim::points) == 1)
                by_camera_[camera] = best.shots;
        }
    }

    const Shots* of(const std::string& camera) const {
        const auto found = by_camera_.find(camera);
        return found == by_camera_.end() ? nullptr : found->second;
    }
    /// Whether the pictures, or the folder that they are a part of, are given away.
    bool is_taken(const Shots& shots) const {
        return std::ranges::any_of(by_camera_, [&](const auto& entry) {
            const Shots& chosen = *entry.second;
            return chosen.label == shots.label || (shots.is_alone && !chosen.is_video &&
                                                   !chosen.is_alone && chosen.path == shots.path);
        });
    }

private:
    struct Claim {
        int points;  // the equal name before a part, a whole folder before one picture of it
        const Shots* shots;
    };

    void claim(const std::vector<std::string>& cameras, const Shots& shots) {
        Whole best = Whole::kNo;
        std::vector<const std::string*> named;
        for (const std::string& camera : cameras) {
            const Whole whole = whole_name(camera, shots.label, cameras);
            if (whole == Whole::kNo || whole < best) continue;
            if (whole > best) named.clear();
            best = whole;
            named.push_back(&camera);
        }
        if (named.size() != 1) return;
        const int points = 2 * static_cast<int>(best) - (shots.is_alone ? 1 : 0);
        claims_[*named.front()].push_back({points, &shots});
    }

    std::map<std::string, std::vector<Claim>> claims_;
    std::map<std::string, const Shots*> by_camera_;
};

}  // namespace

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
        const bool is_word = name.size() == 1 && !is_number(name.front());
        if ((name.size() > 1 && contains_run(tokens(part), name)) ||
            (is_word && is_after_word_for_camera(lower(camera), lower(part))))
            best = std::max(best, 80);
    }
    if (contains_run(telling, name)) best = std::max(best, 70);
    const std::string number = last_number(name);
    // a number of two cameras names neither
    const bool is_own_number = std::ranges::none_of(cameras, [&](const std::string& other) {
        return other != camera && last_number(tokens(other)) == number;
    });
    if (!number.empty() && is_own_number && std::ranges::find(telling, number) != telling.end())
        best = std::max(best, 50);
    return best;
}

const std::string& known_name(const std::string& camera, const Originals& originals) {
    const auto found = originals.find(camera);
    return found == originals.end() ? camera : found->second;
}

namespace {

Expected<Matches> match_names(const std::vector<std::string>& cameras,
                              const std::vector<Shots>& shots,
                              const std::string& cure) {
    std::vector<std::string> labels;
    for (const Shots& one : shots)
        if (!one.is_alone) labels.push_back(one.label);
    const std::vector<std::string> none;  // what tells single pictures apart is no camera's name
    const WholeNames whole_names(cameras, shots);
    Matches matches;
    std::map<std::string, std::string> taken;  // label -> camera
    for (const std::string& camera : cameras) {
        if (const Shots* own = whole_names.of(camera)) {
            matches.by_camera[camera] = *own;
            continue;
        }
        int best = 0;
        std::vector<const Shots*> fitting;
        for (const Shots& one : shots) {
            if (whole_names.is_taken(one)) continue;
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
                              fmt::format("camera '{}' may be '{}' or '{}'; {}",
                                          camera,
                                          chosen.label,
                                          fitting[1]->label,
                                          cure));
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

}  // namespace

Expected<Matches> match_shots(const std::vector<std::string>& cameras,
                              const std::vector<Shots>& shots,
                              const Originals& originals,
                              const std::string& cure) {
    std::map<std::string, std::string> camera_of;  // by the name in the calibration
    std::vector<std::string> names;
    for (const std::string& camera : cameras) {
        const std::string& known = known_name(camera, originals);
        // two cameras may have one name there
        names.push_back(camera_of.contains(known) ? camera : known);
        camera_of[names.back()] = camera;
    }
    auto by_name = match_names(names, shots, cure);
    if (!by_name) return by_name;
    Matches matches;
    for (const auto& [name, chosen] : by_name->by_camera)
        matches.by_camera[camera_of.at(name)] = chosen;
    for (const std::string& name : by_name->missing) matches.missing.push_back(camera_of.at(name));
    if (matches.missing.empty() || originals.empty()) return matches;
    std::vector<Shots> rest;
    std::ranges::copy_if(shots, std::back_inserter(rest), [&](const Shots& one) {
        return std::ranges::none_of(matches.by_camera, [&](const auto& entry) {
            return entry.second.label == one.label || entry.second.path == one.path;
        });
    });
    auto by_rig = match_names(matches.missing, rest, cure);
    if (!by_rig) return by_rig;
    matches.by_camera.merge(by_rig->by_camera);
    matches.missing = std::move(by_rig->missing);
    return matches;
}

}  // namespace atrium::calibrate
