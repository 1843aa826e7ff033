#include "site_node/capture/rig_of_pictures.hpp"

#include "site_node/capture/picture_file.hpp"

#include <fmt/format.h>

#include <set>
#include <system_error>

namespace atrium::capture {

namespace fs = std::filesystem;

Expected<config::Rig> rig_of_pictures(const fs::path& folder) {
    constexpr std::size_t kMostCameras = 64;
    std::set<fs::path> folders;
    std::error_code failure;
    for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure)) {
        std::error_code unreadable;
        if (entry->is_directory(unreadable)) folders.insert(entry->path());
    }
    if (failure)
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("recording '{}': cannot be read: {}", folder.string(), failure.message()));
    config::Rig rig;
    for (const fs::path& own : folders) {
        auto pictures = PictureFile::find(own, "frames");
        if (!pictures) {
            if (pictures.error().kind == ErrorKind::kNotFound) continue;  // of no camera
            return tl::unexpected(pictures.error());
        }
        geometry::CalibratedCamera camera;
        camera.name = own.filename().string();
        if (!config::is_valid_name(camera.name))
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("{}: the name of a camera has 1 to 63 characters of A-Z "
                                          "a-z 0-9 _ . -; rename the folder",
                                          own.string()));
        const auto size = pictures->size();
        if (!size)
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("{}: the first picture cannot be read", pictures->path().string()));
        camera.intrinsics.width = size->width;
        camera.intrinsics.height = size->height;
        camera.intrinsics.fx = camera.intrinsics.fy = size->width;
        camera.intrinsics.cx = 0.5 * (size->width - 1);
        camera.intrinsics.cy = 0.5 * (size->height - 1);
        rig.cameras.push_back(std::move(camera));
    }
    if (rig.cameras.size() < 2 || rig.cameras.size() > kMostCameras)
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("recording '{}': {} folders hold pictures of a camera, as in north/frames/"
                        "000000.png or north/frames.mp4; 2 to {} are needed",
                        folder.string(),
                        rig.cameras.size(),
                        kMostCameras));
    return rig;
}

}  // namespace atrium::capture
