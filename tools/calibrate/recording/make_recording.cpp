#include "tools/calibrate/recording/make_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> cannot(const fs::path& path, const std::string& what) {
    return make_error(ErrorKind::kNotFound, fmt::format("{}: {}", path.string(), what));
}

std::string lower_suffix(const fs::path& file) {
    std::string suffix = file.extension().string();
    std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return std::tolower(c); });
    return suffix;
}

// A recording names pictures .png or .jpg and videos .avi, .mp4 or .mkv. Decoders go by content.
std::string recorded_suffix(const fs::path& file, bool is_video) {
    const std::string suffix = lower_suffix(file);
    if (!is_video) return suffix == ".jpg" || suffix == ".jpeg" ? ".jpg" : ".png";
    if (suffix == ".avi" || suffix == ".mp4" || suffix == ".mkv") return suffix;
    return suffix == ".mov" || suffix == ".m4v" ? ".mp4" : suffix == ".webm" ? ".mkv" : ".avi";
}

class Maker {
public:
    explicit Maker(const MakeOptions& options) : options_(options) {}

    Expected<void> place(const Shots& shots,
                         const fs::path& folder,
                         const std::string& name,
                         std::size_t first_number) {
        std::error_code failure;
        if (shots.is_video)
            return put(shots.path, folder / (name + recorded_suffix(shots.path, true)));
        if (name == "background" && shots.pictures.size() == 1) {
            const fs::path& only = shots.pictures.begin()->second;
            return put(only, folder / (name + recorded_suffix(only, false)));
        }
        fs::create_directories(folder / name, failure);
        for (const auto& [number, file] : shots.pictures) {
            const std::string target =
                fmt::format("{:06}{}", number - first_number, recorded_suffix(file, false));
            if (auto done = put(file, folder / name / target); !done) return done;
        }
        return {};
    }

    // Removes the links of an earlier recording, of another length or kind.
    Expected<void> clear(const fs::path& folder) const {
        std::error_code failure;
        for (const char* name : {"frames", "background"}) {
            std::vector<fs::path> old;
            for (const fs::path& in : {folder, folder / name}) {
                for (const auto& entry : fs::directory_iterator(in, failure)) {
                    const bool is_ours = in != folder || entry.path().stem() == name;
                    if (is_ours && !entry.is_directory(failure)) old.push_back(entry.path());
                }
            }
            for (const fs::path& file : old) {
                if (!options_.force || !fs::is_symlink(file, failure)) {
                    return make_error(
                        ErrorKind::kConfiguration,
                        fmt::format("{}: exists already; give another -o{}",
                                    file.string(),
                                    options_.force ? ", or remove it yourself: only "
                                                     "links are replaced"
                                                   : ", or --force to replace links"));
                }
                fs::remove(file, failure);
            }
        }
        return {};
    }

private:
    Expected<void> put(const fs::path& source, const fs::path& target) const {
        std::error_code failure;
        const fs::path real = fs::canonical(source, failure);
        if (failure) return cannot(source, "cannot be found");
        if (options_.copy) {
            fs::copy_file(real, target, failure);
        } else {
            fs::create_symlink(real, target, failure);
        }
        if (failure)
            return cannot(target,
                          "cannot be made: " + failure.message() +
                              (options_.copy ? "" : "; does the disk know links? Try --copy"));
        return {};
    }

    const MakeOptions& options_;
};

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size() && i < 12; ++i)
        text += (i == 0 ? "'" : ", '") + names[i] + "'";
    return names.size() > 12 ? text + ", ..." : text;
}

std::vector<Shots> of_kind(const std::vector<Shots>& all, bool is_background) {
    std::vector<Shots> result;
    std::ranges::copy_if(all, std::back_inserter(result), [&](const Shots& shots) {
        return shots.is_background == is_background;
    });
    return result;
}

Expected<void> gather_backgrounds(const std::vector<std::string>& cameras,
                                  const std::vector<Shots>& shots,
                                  Material& material) {
    auto matches = match_shots(cameras, shots);
    if (!matches) {
        return make_error(matches.error().kind, "background: " + matches.error().message);
    }
    material.backgrounds = std::move(matches->by_camera);
    std::vector<std::string> without;
    for (const auto& [camera, frames] : material.frames)
        if (!material.backgrounds.contains(camera)) without.push_back(camera);
    if (without.empty()) {
        material.told.push_back("background: the empty room was found for every camera");
    } else {
        material.unsure.push_back(
            fmt::format("background: none of {}; film the empty room with the same cameras and "
                        "give its folder with --background, or put masks into CAMERA/silhouettes",
                        listed(without)));
    }
    return {};
}

Expected<void> look_at_all(Material& material) {
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    std::size_t most = 0;
    for (const auto& [camera, shots] : material.frames) {
        auto look = look_at(shots);
        if (!look) return tl::unexpected(look.error());
        fewest = std::min(fewest, look->num_frames);
        most = std::max(most, look->num_frames);
        if (look->rate_hz > 0.0) {
            if (material.rate_hz > 0.0 && std::abs(look->rate_hz / material.rate_hz - 1.0) > 0.01) {
                material.unsure.push_back(fmt::format(
                    "camera '{}': {:.4g} pictures per second, others {:.4g}; a hull needs pictures "
                    "of the same instants",
                    camera,
                    look->rate_hz,
                    material.rate_hz));
            } else {
                material.rate_hz = look->rate_hz;
            }
        }
        material.looks[camera] = *look;
    }
    if (fewest != most) {
        material.unsure.push_back(
            fmt::format("the cameras have {} to {} pictures; they must begin at the same instant: "
                        "picture N of every camera is taken as one instant",
                        fewest,
                        most));
    }
    return {};
}

}  // namespace

Expected<Material> gather(const std::vector<std::string>& cameras,
                          const fs::path& folder,
                          const fs::path& background) {
    const auto found = find_shots(folder);
    if (!found) return tl::unexpected(found.error());
    auto matches = match_shots(cameras, of_kind(*found, false));
    if (!matches) return tl::unexpected(matches.error());
    Material material;
    material.frames = std::move(matches->by_camera);
    material.missing = std::move(matches->missing);
    if (material.frames.size() < 2) {
        std::vector<std::string> labels;
        for (const Shots& shots : of_kind(*found, false))
            if (!shots.is_alone) labels.push_back(shots.label);
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: no pictures of {}; found {}; give videos or folders the names of the "
                        "cameras",
                        folder.string(),
                        listed(material.missing),
                        labels.empty() ? "neither videos nor pictures" : listed(labels)));
    }
    for (const auto& [camera, shots] : material.frames)
        material.told.push_back(fmt::format("camera '{}': {}", camera, shots.label));
    if (!material.missing.empty()) {
        material.unsure.push_back(fmt::format(
            "{}: no pictures of {}: left out", folder.string(), listed(material.missing)));
    }
    std::vector<Shots> rooms = of_kind(*found, true);
    if (!background.empty()) {
        auto named = find_shots(background);
        if (!named) return tl::unexpected(named.error());
        rooms = std::move(*named);
    }
    std::vector<std::string> with_frames;
    for (const auto& [camera, shots] : material.frames) with_frames.push_back(camera);
    if (auto done = gather_backgrounds(with_frames, rooms, material); !done)
        return tl::unexpected(done.error());
    if (auto done = look_at_all(material); !done) return tl::unexpected(done.error());
    return material;
}

Expected<void> make_recording(const Material& material,
                              const fs::path& output,
                              const MakeOptions& options) {
    Maker maker(options);
    // one instant has one number in all cameras
    std::size_t first = std::numeric_limits<std::size_t>::max();
    for (const auto& [camera, shots] : material.frames)
        if (!shots.is_video) first = std::min(first, shots.pictures.begin()->first);
    for (const auto& [camera, shots] : material.frames) {
        std::error_code failure;
        const fs::path folder = output / camera;
        fs::create_directories(folder, failure);
        if (!fs::is_directory(folder, failure)) return cannot(folder, "cannot be made");
        if (auto cleared = maker.clear(folder); !cleared) return cleared;
        if (!shots.is_video && shots.pictures.rbegin()->first - first > 9'999'999) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("camera '{}': its pictures are numbered from {} to {}; a "
                                          "recording has at most 10,000,000",
                                          camera,
                                          shots.pictures.begin()->first,
                                          shots.pictures.rbegin()->first));
        }
        if (auto done = maker.place(shots, folder, "frames", first); !done) return done;
        const auto room = material.backgrounds.find(camera);
        if (room == material.backgrounds.end()) continue;
        const std::size_t first_of_room =
            room->second.is_video ? 0 : room->second.pictures.begin()->first;
        if (auto done = maker.place(room->second, folder, "background", first_of_room); !done)
            return done;
    }
    return {};
}

}  // namespace atrium::calibrate
