// A COLMAP model as a rig: each image is a camera; images of one folder, or with one name and
// different numbers, are one camera that stands still. COLMAP puts the first pixel's centre at 0.5.
#include "core/base/looked_up.hpp"
#include "tools/calibrate/formats/colmap_model.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/lens.hpp"
#include "tools/calibrate/names/name_parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

struct ModelFiles {
    fs::path cameras;
    fs::path images;
    bool is_binary = false;
};

std::optional<ModelFiles> files_in(const fs::path& folder) {
    std::error_code failure;
    for (const char* below : {"", "sparse/0", "sparse", "0"}) {
        for (const bool is_binary : {true, false}) {
            const std::string suffix = is_binary ? ".bin" : ".txt";
            const ModelFiles found{folder / below / ("cameras" + suffix),
                                   folder / below / ("images" + suffix),
                                   is_binary};
            if (fs::exists(found.cameras, failure) && fs::exists(found.images, failure))
                return found;
        }
    }
    return std::nullopt;
}

// `files`: the folder, or one or both files.
std::optional<ModelFiles> model_files(const Files& files) {
    std::error_code failure;
    for (const fs::path& file : files) {
        if (auto found = files_in(file)) return found;
        if (fs::is_directory(file, failure)) continue;
        const fs::path folder = file.parent_path();
        const bool is_binary = file.extension() == ".bin";
        const std::string suffix = is_binary ? ".bin" : ".txt";
        ModelFiles found{folder / ("cameras" + suffix), folder / ("images" + suffix), is_binary};
        if (fs::exists(found.cameras, failure) && fs::exists(found.images, failure)) return found;
    }
    return std::nullopt;
}

// Distortion in OpenCV's order, and fx, fy, cx, cy; nullopt for other models.
std::optional<LensNumbers> lens_of(const ColmapCamera& camera) {
    const std::vector<double>& p = camera.parameters;
    LensNumbers lens;
    lens.pixel_centre = 0.5;
    lens.size = {camera.width, camera.height};
    const auto has = [&](const char* model, std::size_t count) {
        return camera.model == model && p.size() == count;
    };
    if (has("SIMPLE_PINHOLE", 3) || has("SIMPLE_RADIAL", 4) || has("RADIAL", 5)) {
        lens.matrix = {p[0], p[0], p[1], p[2]};
        lens.distortion.assign(p.begin() + 3, p.end());
    } else if (has("PINHOLE", 4) || has("OPENCV", 8) || has("FULL_OPENCV", 12)) {
        lens.matrix.assign(p.begin(), p.begin() + 4);
        lens.distortion.assign(p.begin() + 4, p.end());
    } else {
        return std::nullopt;
    }
    const bool is_finite = std::ranges::all_of(p, [](double v) { return std::isfinite(v); });
    if (!is_finite) lens.matrix.clear();
    return lens;
}

// "cam1_0001" -> "cam1"; without a number, or nothing else: unchanged.
std::string without_number(const std::string& stem) {
    std::size_t end = stem.size();
    while (end > 0 && std::isdigit(static_cast<unsigned char>(stem[end - 1])) != 0) --end;
    const std::size_t digits = stem.size() - end;
    while (end > 0 && (stem[end - 1] == '_' || stem[end - 1] == '-' || stem[end - 1] == '.')) --end;
    return digits < 3 || end == 0 ? stem : stem.substr(0, end);
}

std::size_t num_different(const std::vector<std::string>& names) {
    return std::set<std::string>(names.begin(), names.end()).size();
}

using Parts = std::vector<std::string>;

// "cam1/images", "cam2/rgb/images": what all end with says nothing, nor does "images".
void drop_common_end(std::vector<Parts>& folders) {
    const auto all_end_alike = [&] {
        return std::ranges::all_of(folders, [&](const Parts& parts) {
            return parts.size() > 1 && parts.back() == folders.front().back();
        });
    };
    for (Parts& parts : folders)
        if (parts.size() > 1 && parts.back() == "images") parts.pop_back();
    while (folders.size() > 1 && all_end_alike())
        for (Parts& parts : folders) parts.pop_back();
}

// The names of folders: their last parts, or if some are alike, as of head0/left and head1/left,
// the parts from the first one that differs.
std::map<std::string, std::string> names_of(const std::set<std::string>& folders) {
    std::vector<Parts> all;
    for (const std::string& folder : folders) all.push_back(parts_of(folder));
    drop_common_end(all);
    std::set<std::string> last;
    for (const Parts& parts : all) last.insert(parts.back());
    const bool is_last_enough = last.size() == all.size();
    while (!is_last_enough && std::ranges::all_of(all, [&](const Parts& parts) {
        return parts.size() > 1 && parts.front() == all.front().front();
    }))
        for (Parts& parts : all) parts.erase(parts.begin());
    std::map<std::string, std::string> names;
    std::size_t i = 0;
    for (const std::string& folder : folders) {
        const Parts& parts = all[i++];
        names[folder] = is_last_enough ? parts.back() : fmt::format("{}", fmt::join(parts, "/"));
    }
    return names;
}

// The camera of each image: its folder if the folders differ, else its name without the number.
std::vector<std::string> camera_names(const std::vector<ColmapImage>& images) {
    std::vector<std::string> folders;
    std::vector<std::string> prefixes;
    std::vector<std::string> stems;
    for (const ColmapImage& image : images) {
        const fs::path path(image.name);
        folders.push_back(path.parent_path().string());
        stems.push_back(path.stem().string());
        prefixes.push_back(without_number(stems.back()));
    }
    if (num_different(folders) < 2) return num_different(prefixes) > 1 ? prefixes : stems;
    // those beside folders, as one picture per camera beside the folder of a phone
    std::vector<std::string> loose;
    std::set<std::string> own;
    for (std::size_t i = 0; i < folders.size(); ++i) {
        if (folders[i].empty()) {
            loose.push_back(prefixes[i]);
        } else {
            own.insert(folders[i]);
        }
    }
    const std::map<std::string, std::string> names = names_of(own);
    const bool has_prefixes = num_different(loose) > 1;
    for (std::size_t i = 0; i < folders.size(); ++i) {
        const auto name = names.find(folders[i]);
        folders[i] = name != names.end() ? name->second : has_prefixes ? prefixes[i] : stems[i];
    }
    return folders;
}

double farthest(const std::vector<Eigen::Vector3d>& centres) {
    double result = 0.0;
    for (const auto& a : centres)
        for (const auto& b : centres) result = std::max(result, (a - b).norm());
    return result;
}

Expected<ForeignRig> rig_of(const ColmapModel& model, const std::string& where) {
    ForeignRig rig;
    rig.format = "COLMAP";
    rig.has_scale = false;
    rig.has_frame = false;
    rig.is_sure_of_poses = true;
    const std::vector<std::string> names = camera_names(model.images);
    std::map<std::string, std::vector<Eigen::Vector3d>> centres;
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        const ColmapImage& image = model.images[i];
        const auto wrong = [&](ErrorKind kind, const std::string& what) {
            return make_error(kind, fmt::format("{}: image '{}': {}", where, image.name, what));
        };
        if (!(std::abs(image.rotation.norm() - 1.0) < 1e-2) || !image.translation.allFinite())
            return wrong(ErrorKind::kInvalidData, "its pose is no unit quaternion and translation");
        const ForeignPose pose{image.rotation.normalized().toRotationMatrix(), image.translation};
        auto& seen = centres[names[i]];
        if (seen.size() < 1000) seen.push_back(camera_from_site(pose, {}).inverse().translation);
        if (seen.size() > 1) continue;  // the first image of a camera gives its pose
        const auto camera = model.cameras.find(image.camera);
        if (camera == model.cameras.end())
            return wrong(ErrorKind::kInvalidData,
                         fmt::format("the model has no camera {}", image.camera));
        const auto lens = lens_of(camera->second);
        if (!lens) {
            return wrong(
                ErrorKind::kConfiguration,
                fmt::format("camera model {} with {} parameters is not supported; run COLMAP with "
                            "--ImageReader.camera_model OPENCV, or `colmap image_undistorter` and "
                            "use its pictures and model",
                            camera->second.model.substr(0, 40),
                            camera->second.parameters.size()));
        }
        ForeignCamera result;
        result.name = names[i];
        result.pose = pose;
        if (auto set = set_lens(result, *lens, where, rig.notes); !set)
            return tl::unexpected(set.error());
        rig.cameras.push_back(std::move(result));
    }
    std::vector<Eigen::Vector3d> firsts;
    for (const auto& [name, all] : centres) firsts.push_back(all.front());
    const double size = farthest(firsts);
    for (const auto& [name, all] : centres) {
        ForeignCamera& camera = *std::ranges::find(rig.cameras, name, &ForeignCamera::name);
        camera.num_images = all.size();
        camera.spread = farthest(all) / std::max(size, 1e-12);
    }
    return rig;
}

}  // namespace

Expected<ForeignRig> read_colmap(const Files& files) {
    const auto found = model_files(files);
    if (!found) {
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: no model of COLMAP: a folder with cameras.txt and "
                                      "images.txt, or cameras.bin and images.bin",
                                      files.front().string()));
    }
    for (const fs::path& file : files) {
        std::error_code failure;
        if (!fs::exists(file, failure)) {
            return make_error(ErrorKind::kNotFound,
                              fmt::format("{}: no such file{}; the model of COLMAP is {}",
                                          file.string(),
                                          looked_up_from(file),
                                          found->cameras.parent_path().string()));
        }
    }
    ColmapModel model;
    const auto read = found->is_binary ? read_colmap_binary(found->cameras, found->images, model)
                                       : read_colmap_text(found->cameras, found->images, model);
    if (!read) return tl::unexpected(read.error());
    return rig_of(model, found->images.parent_path().string());
}

}  // namespace atrium::calibrate
