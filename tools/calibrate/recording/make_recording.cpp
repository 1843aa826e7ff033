#include "tools/calibrate/recording/make_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

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
            if (number < first_number) continue;  // a mask before the first picture
            const std::string target =
                fmt::format("{:06}{}", number - first_number, recorded_suffix(file, false));
            if (auto done = put(file, folder / name / target); !done) return done;
        }
        return {};
    }

    // Removes the links of an earlier recording, of another length or kind.
    Expected<void> clear(const fs::path& folder) const {
        std::error_code failure;
        for (const char* name : {"frames", "background", "silhouettes"}) {
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

}  // namespace

Expected<void> make_recording(const Material& material,
                              const fs::path& output,
                              const MakeOptions& options) {
    Maker maker(options);
    const std::size_t first = material.first_frame;
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
        if (const auto masks = material.masks.find(camera); masks != material.masks.end()) {
            if (auto done = maker.place(masks->second, folder, "silhouettes", material.first_mask);
                !done)
                return done;
        }
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
