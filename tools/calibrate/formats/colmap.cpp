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
    bool has_other = false;  // the folder has the other kind, too
};

std::optional<ModelFiles> files_of_kind(const fs::path& folder, bool is_binary) {
    std::error_code failure;
    const std::string suffix = is_binary ? ".bin" : ".txt";
    ModelFiles found{folder / ("cameras" + suffix), folder / ("images" + suffix), is_binary};
    if (!fs::exists(found.cameras, failure) || !fs::exists(found.images, failure))
        return std::nullopt;
    return found;
}

// The newer of both kinds: programs that refine a model write one of them.
std::optional<ModelFiles> files_in(const fs::path& folder) {
    for (const char* below : {"", "sparse/0", "sparse", "0"}) {
        auto binary = files_of_kind(folder / below, true);
        auto text = files_of_kind(folder / below, false);
        if (!binary || !text) {
            if (binary || text) return binary ? binary : text;
            continue;
        }
        std::error_code failure;
        const bool is_text_newer = fs::last_write_time(text->images, failure) >
                                   fs::last_write_time(binary->images, failure);
        ModelFiles& newer = is_text_newer ? *text : *binary;
        newer.has_other = true;
        return newer;
    }
    return std::nullopt;
}

// `files`: the folder, or one or both files.
std::optional<ModelFiles> model_files(const Files& files) {
    std::error_code failure;
    for (const fs::path& file : files) {
        if (auto found = files_in(file)) return found;
        if (fs::is_directory(file, failure)) continue;
        if (auto found = files_of_kind(file.parent_path(), file.extension() == ".bin"))
            return found;
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
    } else if (has("SIMPLE_RADIAL_FISHEYE", 4) || has("RADIAL_FISHEYE", 5)) {
        lens.matrix = {p[0], p[0], p[1], p[2]};
        lens.distortion.assign(p.begin() + 3, p.end());
        lens.model = "fisheye";
    } else if (has("OPENCV_FISHEYE", 8)) {
        lens.matrix.assign(p.begin(), p.begin() + 4);
        lens.distortion.assign(p.begin() + 4, p.end());
        lens.model = "fisheye";
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

constexpr std::size_t kMostImages = 1000;  // of one camera that count

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

// One camera's images that count.
struct Seen {
    std::vector<const ColmapImage*> images;
    std::vector<Eigen::Vector3d> centres;
};

double farthest(const std::vector<Eigen::Vector3d>& centres) {
    double result = 0.0;
    for (const auto& a : centres)
        for (const auto& b : centres) result = std::max(result, (a - b).norm());
    return result;
}

Eigen::Vector3d median_of(std::vector<Eigen::Vector3d> centres) {
    Eigen::Vector3d median;
    const auto middle = centres.begin() + static_cast<std::ptrdiff_t>(centres.size() / 2);
    for (int axis = 0; axis < 3; ++axis) {
        std::ranges::nth_element(
            centres, middle, {}, [axis](const Eigen::Vector3d& p) { return p[axis]; });
        median[axis] = (*middle)[axis];
    }
    return median;
}

// COLMAP misplaces a picture now and then: if at least two thirds of a camera's images, and three,
// stand in one place, the others are dropped, and returned.
std::vector<std::string> drop_odd(Seen& seen, double reach) {
    const Eigen::Vector3d place = median_of(seen.centres);
    const auto is_odd = [&](std::size_t i) { return (seen.centres[i] - place).norm() > reach; };
    std::vector<std::string> odd;
    Seen kept;
    for (std::size_t i = 0; i < seen.images.size(); ++i) {
        if (is_odd(i)) {
            odd.push_back(seen.images[i]->name);
        } else {
            kept.images.push_back(seen.images[i]);
            kept.centres.push_back(seen.centres[i]);
        }
    }
    if (kept.images.size() < 3 || kept.images.size() < 2 * odd.size()) return {};
    seen = std::move(kept);
    return odd;
}

ForeignPose pose_of(const ColmapImage& image) {
    return {image.rotation.normalized().toRotationMatrix(), image.translation};
}

// The camera that took an image, with its pose.
Expected<ForeignCamera> camera_of(const ColmapImage& image,
                                  const ColmapModel& model,
                                  const std::string& where,
                                  std::vector<std::string>& notes) {
    const auto wrong = [&](ErrorKind kind, const std::string& what) {
        return make_error(kind, fmt::format("{}: image '{}': {}", where, image.name, what));
    };
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
    result.pose = pose_of(image);
    if (auto set = set_lens(result, *lens, where, notes); !set) return tl::unexpected(set.error());
    return result;
}

Expected<ForeignRig> rig_of(const ColmapModel& model, const std::string& where) {
    ForeignRig rig;
    rig.format = "COLMAP";
    rig.has_scale = false;
    rig.has_frame = false;
    rig.is_sure_of_poses = true;
    const std::vector<std::string> names = camera_names(model.images);
    std::map<std::string, Seen> cameras;
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        const ColmapImage& image = model.images[i];
        if (!(std::abs(image.rotation.norm() - 1.0) < 1e-2) || !image.translation.allFinite()) {
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("{}: image '{}': its pose is no unit quaternion and translation",
                            where,
                            image.name));
        }
        Seen& seen = cameras[names[i]];
        if (seen.images.size() >= kMostImages) continue;
        seen.images.push_back(&image);
        seen.centres.push_back(camera_from_site(pose_of(image), {}).inverse().translation);
    }
    std::vector<Eigen::Vector3d> places;
    for (const auto& [name, seen] : cameras) places.push_back(median_of(seen.centres));
    const double size = std::max(farthest(places), 1e-12);
    std::set<std::string> added;
    for (const std::string& name : names) {
        if (!added.insert(name).second) continue;
        Seen& seen = cameras[name];
        const std::size_t num_images = seen.images.size();
        const std::vector<std::string> odd = drop_odd(seen, kStillSpread * size);
        if (!odd.empty()) {
            rig.checks.push_back(
                fmt::format("camera '{}': {} of its {} images stand in one place, but not {}{}: "
                            "COLMAP erred there, and they were left out",
                            name,
                            seen.images.size(),
                            num_images,
                            odd.front(),
                            odd.size() > 1 ? fmt::format(" and {} more", odd.size() - 1) : ""));
        }
        auto camera = camera_of(*seen.images.front(), model, where, rig.notes);
        if (!camera) return tl::unexpected(camera.error());
        camera->name = name;
        camera->num_images = seen.images.size();
        camera->spread = farthest(seen.centres) / size;
        rig.cameras.push_back(std::move(*camera));
    }
    return rig;
}

Expected<void> read_model(const ModelFiles& files, ColmapModel& model) {
    return files.is_binary ? read_colmap_binary(files.cameras, files.images, model)
                           : read_colmap_text(files.cameras, files.images, model);
}

bool is_same(const ColmapModel& a, const ColmapModel& b) {
    constexpr double kSame = 1e-6;  // of text that is written with fewer digits
    const auto near = [](double x, double y) {
        return std::abs(x - y) <= kSame * std::max({1.0, std::abs(x), std::abs(y)});
    };
    const auto is_same_camera = [&](const auto& one, const auto& other) {
        return one.first == other.first && one.second.model == other.second.model &&
               std::ranges::equal(one.second.parameters, other.second.parameters, near);
    };
    if (!std::ranges::equal(a.cameras, b.cameras, is_same_camera)) return false;
    std::map<std::string, const ColmapImage*> images;
    for (const ColmapImage& image : a.images) images[image.name] = &image;
    return a.images.size() == b.images.size() &&
           std::ranges::all_of(b.images, [&](const ColmapImage& image) {
               const auto other = images.find(image.name);
               return other != images.end() &&
                      image.rotation.angularDistance(other->second->rotation) < kSame &&
                      (image.translation - other->second->translation).norm() <=
                          kSame * std::max(1.0, image.translation.norm());
           });
}

// Says which model was read, if the folder has another one.
void check_other_kind(const ModelFiles& read, const ColmapModel& model, ForeignRig& rig) {
    if (!read.has_other) return;
    const fs::path folder = read.cameras.parent_path();
    const auto other = files_of_kind(folder, !read.is_binary);
    ColmapModel another;
    if (!other || !read_model(*other, another) || is_same(model, another)) return;
    rig.checks.push_back(
        fmt::format("model: {} has two models that differ; {} and {} are newer and were read; if "
                    "the other one is right, give {}",
                    folder.string(),
                    read.cameras.filename().string(),
                    read.images.filename().string(),
                    other->cameras.string()));
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
    if (auto read = read_model(*found, model); !read) return tl::unexpected(read.error());
    auto rig = rig_of(model, found->images.parent_path().string());
    if (rig) check_other_kind(*found, model, *rig);
    return rig;
}

}  // namespace atrium::calibrate
