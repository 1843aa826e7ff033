#include "tools/calibrate/recording/make_recording.hpp"

#include "core/base/write_check.hpp"
#include "site_node/capture/mask_file.hpp"
#include "tools/calibrate/recording/mask_reading.hpp"

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
    Maker(const MakeOptions& options, const MaskReading& reading)
        : options_(options), reading_(reading) {}

    Expected<void> place(const Shots& shots,
                         const fs::path& folder,
                         const std::string& name,
                         std::size_t first_number) {
        if (shots.is_video)
            return put(shots.path, folder / (name + recorded_suffix(shots.path, true)));
        if (name == "background" && shots.pictures.size() == 1) {
            const fs::path& only = shots.pictures.begin()->second;
            return put(only, folder / (name + recorded_suffix(only, false)));
        }
        if (auto made = make_folder(folder / name); !made) return made;
        for (const auto& [number, file] : shots.pictures) {
            if (number < first_number) continue;  // a mask before the first picture
            const std::string target =
                fmt::format("{:06}{}", number - first_number, recorded_suffix(file, false));
            const bool is_rewritten = name == "silhouettes" && !reading_.is_of_site();
            // a copy has a name of its own format
            const auto done =
                is_rewritten
                    ? put_plain(file, capture::numbered_png(folder / name, number - first_number))
                    : put(file, folder / name / target);
            if (!done) return done;
        }
        return {};
    }

    Expected<void> make_folder(const fs::path& folder) {
        std::error_code failure;
        std::vector<fs::path> missing;
        for (fs::path at = folder; !at.empty() && !fs::exists(at, failure); at = at.parent_path())
            missing.push_back(at);
        fs::create_directories(folder, failure);
        made_.insert(made_.end(), missing.rbegin(), missing.rend());
        if (failure) return tl::unexpected(cannot_write(folder, "create", failure.value()));
        return {};
    }

    std::vector<fs::path> take_made() { return std::move(made_); }

    // The links of an earlier recording, of another length or kind. Error if a file is no link.
    Expected<std::vector<fs::path>> old_links(const fs::path& folder) const {
        std::error_code failure;
        std::vector<fs::path> links;
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
                links.push_back(file);
            }
        }
        return links;
    }

private:
    Expected<void> put(const fs::path& source, const fs::path& target) {
        std::error_code failure;
        const fs::path real = fs::canonical(source, failure);
        if (failure) return cannot(source, "cannot be found");
        if (options_.copy) {
            fs::copy_file(real, target, failure);
        } else {
            fs::create_symlink(real, target, failure);
        }
        if (failure == std::errc::permission_denied)
            return tl::unexpected(cannot_write(target, "create", failure.value()));
        if (failure)
            return cannot(target,
                          "cannot be made: " + failure.message() +
                              (options_.copy ? "" : "; does the disk know links? Try --copy"));
        made_.push_back(target);
        return {};
    }

    Expected<void> put_plain(const fs::path& source, const fs::path& target) {
        const auto mask = read_mask(source, reading_);
        if (!mask) return tl::unexpected(mask.error());
        made_.push_back(target);
        return capture::write_mask(*mask, target);
    }

    const MakeOptions& options_;
    const MaskReading& reading_;
    std::vector<fs::path> made_;
};

Expected<void> check_numbers(const std::string& camera, const Shots& shots, std::size_t first) {
    if (shots.is_video || shots.pictures.rbegin()->first - first <= 9'999'999) return {};
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("camera '{}': its pictures are numbered from {} to {}; a "
                                  "recording has at most 10,000,000",
                                  camera,
                                  shots.pictures.begin()->first,
                                  shots.pictures.rbegin()->first));
}

Expected<void> make_camera(Maker& maker,
                           const Material& material,
                           const std::string& camera,
                           const fs::path& folder) {
    if (auto made = maker.make_folder(folder); !made) return made;
    const auto placed =
        maker.place(material.frames.at(camera), folder, "frames", material.first_frame);
    if (!placed) return placed;
    if (const auto masks = material.masks.find(camera); masks != material.masks.end()) {
        const auto done = maker.place(masks->second, folder, "silhouettes", material.first_mask);
        if (!done) return done;
    }
    const auto room = material.backgrounds.find(camera);
    if (room == material.backgrounds.end()) return {};
    const std::size_t first_of_room =
        room->second.is_video ? 0 : room->second.pictures.begin()->first;
    return maker.place(room->second, folder, "background", first_of_room);
}

}  // namespace

void remove_made(const std::vector<fs::path>& made) {
    std::error_code failure;
    for (auto path = made.rbegin(); path != made.rend(); ++path) fs::remove(*path, failure);
}

Expected<std::vector<fs::path>> make_recording(const Material& material,
                                               const fs::path& output,
                                               const MakeOptions& options) {
    Maker maker(options, material.mask_reading);
    std::vector<fs::path> old{output / "rig.toml"};
    for (const auto& [camera, shots] : material.frames) {
        if (auto right = check_numbers(camera, shots, material.first_frame); !right)
            return tl::unexpected(right.error());
        const auto links = maker.old_links(output / camera);
        if (!links) return tl::unexpected(links.error());
        old.insert(old.end(), links->begin(), links->end());
    }
    std::error_code failure;
    for (const fs::path& file : old) fs::remove(file, failure);
    for (const auto& [camera, shots] : material.frames) {
        const auto done = make_camera(maker, material, camera, output / camera);
        if (done) continue;
        remove_made(maker.take_made());
        return tl::unexpected(done.error());
    }
    return maker.take_made();
}

}  // namespace atrium::calibrate
