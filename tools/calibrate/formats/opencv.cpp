// Files of OpenCV's FileStorage, and JSON with the same keys. OpenCV documents what camera_matrix
// and distortion mean, but not the keys: these are the usual ones of its samples, ROS, and programs
// around it.
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/lens.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <map>

namespace atrium::calibrate {
namespace {

using Keys = std::initializer_list<const char*>;
constexpr Keys kMatrix{"camera_matrix",
                       "cameraMatrix",
                       "camera_intrinsics",
                       "intrinsic_matrix",
                       "intrinsicMatrix",
                       "intrinsics",
                       "intrinsic",
                       "matrix",
                       "mtx",
                       "K",
                       "M"};
constexpr Keys kFocal{"fx", "fy", "cx", "cy"};
constexpr Keys kDistortion{"distortion_coefficients",
                           "distortionCoefficients",
                           "dist_coeffs",
                           "distCoeffs",
                           "dist_coeff",
                           "distortion",
                           "distortions",
                           "dist",
                           "distCoef",
                           "distortion_params",
                           "distortion_parameters",
                           "D"};
// one by one, in OpenCV's order; k1 is always there
constexpr Keys kCoefficients{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
constexpr Keys kFisheye{"k1", "k2", "k3", "k4"};
constexpr Keys kRotation{"Rot", "R", "rotation_matrix", "rotation", "rvec", "rotation_vector", "r"};
constexpr Keys kTranslation{"T", "t", "tvec", "translation", "translation_vector", "trans"};
constexpr Keys kPose{"extrinsics", "extrinsic", "extrinsic_matrix", "RT", "Rt", "pose"};
constexpr Keys kWidth{"image_width", "width", "W"};
constexpr Keys kHeight{"image_height", "height", "H"};
constexpr Keys kSize{"image_size", "imageSize", "img_size", "size", "resolution"};
constexpr Keys kName{"camera_name", "name", "camera_id", "cameraId", "id", "serial"};
constexpr Keys kModel{"distortion_model", "camera_model", "model"};

// Values of one camera, from one or more files.
struct Found {
    const Tree* matrix = nullptr;
    const Tree* focal = nullptr;  // a map with fx, fy, cx, cy
    const Tree* distortion = nullptr;
    const Tree* coefficients = nullptr;  // a map with k1
    const Tree* rotation = nullptr;
    const Tree* translation = nullptr;
    const Tree* pose = nullptr;
    const Tree* width = nullptr;
    const Tree* height = nullptr;
    const Tree* size = nullptr;
    const Tree* model = nullptr;
    std::string where;
};

class Collector {
public:
    Expected<void> add(const Tree& tree, const std::filesystem::path& file) {
        where_ = file.string();
        found_some_ = false;
        const bool is_stereo = find_with(tree, kMatrix, "1") != nullptr;
        has_stereo_ = has_stereo_ || is_stereo;
        const bool is_stereo_pose =
            find(tree, {"R"}) != nullptr && find(tree, {"T"}) != nullptr &&
            (has_stereo_ || (find(tree, {"R1"}) != nullptr && find(tree, {"P1"}) != nullptr));
        if (is_stereo || is_stereo_pose) return add_stereo(tree);
        for (const std::string& suffix : suffixes(tree)) add_keys(tree, suffix, suffix.substr(1));
        if (found_some_) return {};
        add_map(tree, file.stem().string(), 0);
        if (cameras_.size() > kMaxCamerasRead) return too_many_cameras(where_);
        return {};
    }

    const std::map<std::string, Found>& cameras() const { return cameras_; }

private:
    // Cameras of stereoCalibrate: the pose is that of the second in the first.
    Expected<void> add_stereo(const Tree& tree) {
        for (const char* index : {"1", "2"}) {
            Found& camera = cameras_[fmt::format("cam{}", index)];
            set(camera.matrix, find_with(tree, kMatrix, index));
            set(camera.distortion, find_with(tree, kDistortion, index));
            set_size(camera, tree, "");
            camera.where = where_;
        }
        Found& second = cameras_["cam2"];
        set(second.rotation, find(tree, {"R"}));
        set(second.translation, find(tree, {"T"}));
        Found& first = cameras_["cam1"];
        first.rotation = &no_rotation_;
        first.translation = &no_rotation_;
        found_some_ = true;
        return {};
    }

    // K_01, dist_01, Rot_01, T_01: the endings of a file with all cameras side by side.
    static std::vector<std::string> suffixes(const Tree& tree) {
        std::vector<std::string> result;
        if (!tree.is_object()) return result;
        for (const auto& [key, value] : tree.items()) {
            for (const Keys keys : {kMatrix, kTranslation}) {
                for (const char* name : keys) {
                    const std::string head = std::string(name) + "_";
                    const std::string suffix =
                        key.starts_with(head) ? key.substr(head.size() - 1) : "";
                    // camera_matrix is a key by itself, not matrix of "camera"
                    if (suffix.size() < 2 || suffix.size() > 40 || !numbers(value)) continue;
                    if (std::ranges::find(result, suffix) == result.end() && !is_key(key))
                        result.push_back(suffix);
                }
            }
        }
        return result;
    }
    static bool is_key(const std::string& key) {
        for (const Keys keys : {kMatrix, kDistortion, kRotation, kTranslation, kPose}) {
            if (std::ranges::any_of(keys, [&](const char* name) { return key == name; }))
                return true;
        }
        return false;
    }

    static const Tree* find_with(const Tree& tree, Keys keys, const std::string& suffix) {
        for (const char* key : keys) {
            if (const Tree* value = find(tree, {(key + suffix).c_str()})) return value;
        }
        return nullptr;
    }
    static void set(const Tree*& target, const Tree* value) {
        if (value != nullptr) target = value;
    }
    static void set_size(Found& camera, const Tree& tree, const std::string& suffix) {
        set(camera.width, find_with(tree, kWidth, suffix));
        set(camera.height, find_with(tree, kHeight, suffix));
        set(camera.size, find_with(tree, kSize, suffix));
    }

    static bool has_focal(const Tree& map) {
        return std::ranges::all_of(kFocal, [&](const char* key) {
            const Tree* value = find(map, {key});
            return value != nullptr && number(*value).has_value();
        });
    }

    static bool has_coefficients(const Tree& map) {
        const Tree* first = find(map, {"k1"});
        return first != nullptr && number(*first).has_value();
    }

    void add_keys(const Tree& tree, const std::string& suffix, const std::string& name) {
        Found& camera = cameras_[name];
        set(camera.matrix, find_with(tree, kMatrix, suffix));
        for (const Tree* map : {&tree, camera.matrix})
            if (suffix.empty() && map != nullptr && has_focal(*map)) camera.focal = map;
        set(camera.distortion, find_with(tree, kDistortion, suffix));
        for (const Tree* map : {&tree, camera.matrix, camera.distortion})
            if (suffix.empty() && map != nullptr && has_coefficients(*map))
                camera.coefficients = map;
        set(camera.rotation, find_with(tree, kRotation, suffix));
        set(camera.translation, find_with(tree, kTranslation, suffix));
        set(camera.pose, find_with(tree, kPose, suffix));
        set(camera.model, find_with(tree, kModel, suffix));
        set_size(camera, tree, suffix);
        camera.where = where_;
        found_some_ = true;
    }

    // A map with the keys of a camera, or maps or lists of those.
    void add_map(const Tree& tree, const std::string& name, int depth) {
        if (depth > 3 || cameras_.size() > kMaxCamerasRead) return;
        const auto has = [&](Keys keys) {
            const Tree* value = find(tree, keys);
            return value != nullptr && numbers(*value).has_value();
        };
        const Tree* matrix = find(tree, kMatrix);
        const bool is_camera = has(kMatrix) || has_focal(tree) ||
                               (matrix != nullptr && has_focal(*matrix)) || has(kPose) ||
                               (has(kRotation) && has(kTranslation));
        if (is_camera) {
            const Tree* own = find(tree, kName);
            const bool is_text = own != nullptr && own->is_string();
            const bool is_number = own != nullptr && own->is_number_integer();
            add_keys(tree,
                     "",
                     is_text     ? own->get<std::string>()
                     : is_number ? std::to_string(own->get<std::int64_t>())
                                 : name);
        } else if (tree.is_object()) {
            for (const auto& [key, child] : tree.items()) add_map(child, key, depth + 1);
        } else if (tree.is_array()) {
            for (std::size_t i = 0; i < tree.size() && i <= kMaxCamerasRead; ++i)
                if (tree[i].is_object()) add_map(tree[i], fmt::format("cam{}", i), depth + 1);
        }
    }

    std::map<std::string, Found> cameras_;
    std::string where_;
    bool found_some_ = false;  // in this file
    bool has_stereo_ = false;
    Tree no_rotation_ = {0.0, 0.0, 0.0};
};

std::optional<ForeignPose> pose_of(const Found& found) {
    std::vector<double> rotation;
    std::vector<double> translation;
    if (found.pose != nullptr) {
        const auto m = numbers(*found.pose);
        if (!m || (m->size() != 12 && m->size() != 16)) return std::nullopt;
        for (const std::size_t i : {0, 1, 2, 4, 5, 6, 8, 9, 10}) rotation.push_back((*m)[i]);
        for (const std::size_t i : {3, 7, 11}) translation.push_back((*m)[i]);
    } else {
        if (found.rotation == nullptr || found.translation == nullptr) return std::nullopt;
        rotation = numbers(*found.rotation).value_or(rotation);
        translation = numbers(*found.translation).value_or(translation);
    }
    const auto matrix = rotation_of(rotation);
    if (!matrix || translation.size() != 3) return std::nullopt;
    return ForeignPose{*matrix, {translation[0], translation[1], translation[2]}};
}

// Up to the last that is given; those between that are not are 0.
std::optional<std::vector<double>> coefficients_in(const Tree& map, const std::string& model) {
    std::vector<double> coefficients;
    std::size_t num_given = 0;
    for (const char* key : is_fisheye(model) ? kFisheye : kCoefficients) {
        const Tree* value = find(map, {key});
        const auto read = value != nullptr ? number(*value) : 0.0;
        if (!read) return std::nullopt;
        coefficients.push_back(*read);
        if (value != nullptr) num_given = coefficients.size();
    }
    // OpenCV takes 4, 5 or 8
    coefficients.resize(num_given <= 4 ? 4 : num_given == 5 ? 5 : 8);
    return coefficients;
}

Expected<ForeignCamera> camera_of(const std::string& name,
                                  const Found& found,
                                  std::vector<std::string>& notes) {
    ForeignCamera camera;
    camera.name = name;
    const auto wrong = [&](const std::string& what) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: camera '{}': {}", found.where, name, what));
    };
    if (found.matrix != nullptr || found.focal != nullptr) {
        LensNumbers lens;
        if (found.focal != nullptr) {
            for (const char* key : kFocal)
                lens.matrix.push_back(*number(*find(*found.focal, {key})));
        } else if (const auto matrix = numbers(*found.matrix)) {
            lens.matrix = *matrix;
        } else {
            return wrong("its camera matrix must be finite numbers");
        }
        if (found.model != nullptr && found.model->is_string())
            lens.model = found.model->get<std::string>();
        if (found.coefficients != nullptr) {
            const auto coefficients = coefficients_in(*found.coefficients, lens.model);
            if (!coefficients) return wrong("its distortion must be finite numbers");
            lens.distortion = *coefficients;
        } else if (found.distortion != nullptr) {
            const auto distortion = numbers(*found.distortion);
            if (!distortion) return wrong("its distortion must be finite numbers");
            lens.distortion = *distortion;
        }
        if (found.size != nullptr) {
            lens.size = numbers(*found.size).value_or(std::vector<double>{0.0});
        } else if (found.width != nullptr && found.height != nullptr) {
            const auto width = number(*found.width);
            const auto height = number(*found.height);
            if (width && height) lens.size = {*width, *height};
        }
        if (auto set = set_lens(camera, lens, found.where, notes); !set)
            return tl::unexpected(set.error());
    }
    camera.pose = pose_of(found);
    const bool has_values =
        found.pose != nullptr || (found.rotation != nullptr && found.translation != nullptr);
    if (has_values && !camera.pose) {
        return wrong(
            "its pose must be a right-handed rotation matrix of 9 numbers or a rotation vector of "
            "3, and a translation of 3 numbers");
    }
    return camera;
}

// At the top of a file a camera's name may follow: K_01.
bool is_known_key(const std::string& key, int depth) {
    const auto lower = [](std::string text) {
        std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
        return text;
    };
    for (const Keys keys : {kMatrix,
                            kFocal,
                            kDistortion,
                            kCoefficients,
                            kRotation,
                            kTranslation,
                            kPose,
                            kWidth,
                            kHeight,
                            kSize,
                            kName,
                            kModel}) {
        for (const char* known : keys) {
            if (lower(key) == lower(known) ||
                (depth == 0 && key.starts_with(std::string(known) + "_")))
                return true;
        }
    }
    return false;
}

// Keys with numbers that mean nothing here, in the file and below, without repetition.
void add_unknown_keys(const Tree& tree, int depth, std::vector<std::string>& unknown) {
    constexpr std::size_t kMaxNamed = 12;
    if (depth > 3 || !tree.is_structured()) return;
    for (const auto& [key, value] : tree.items()) {
        if (unknown.size() == kMaxNamed) return;
        const bool is_unknown = tree.is_object() && numbers(value) && !is_known_key(key, depth);
        if (is_unknown && std::ranges::find(unknown, key) == unknown.end()) unknown.push_back(key);
        if (!numbers(value)) add_unknown_keys(value, depth + 1, unknown);
    }
}

}  // namespace

Expected<ForeignRig> read_opencv(const Files& files) {
    ForeignRig rig;
    rig.format = "OpenCV";
    std::vector<Tree> trees;  // `Found` points into them
    trees.reserve(files.size());
    Collector collector;
    for (const auto& file : files) {
        const auto text = read_bytes(file, kMaxTextBytes);
        if (!text) return tl::unexpected(text.error());
        const std::size_t first = text->find_first_not_of(" \t\r\n");
        const bool is_json = first != std::string::npos && (*text)[first] == '{';
        auto tree =
            is_json ? parse_json(*text, file.string()) : parse_file_storage(*text, file.string());
        if (!tree) return tl::unexpected(tree.error());
        trees.push_back(std::move(*tree));
        if (auto added = collector.add(trees.back(), file); !added)
            return tl::unexpected(added.error());
    }
    std::optional<Error> failure;
    for (const auto& [name, found] : collector.cameras()) {
        auto camera = camera_of(name, found, rig.notes);
        if (!camera && !failure) failure = camera.error();
        if (camera) rig.cameras.push_back(std::move(*camera));
    }
    const bool is_complete = !failure && rig.cameras.size() > 1 &&
                             std::ranges::all_of(rig.cameras, [](const auto& camera) {
                                 return camera.has_lens && camera.pose.has_value();
                             });
    // the likely cause
    for (std::size_t i = 0; i < trees.size() && !is_complete; ++i) {
        if (const std::string word = decimal_comma_in(trees[i]); !word.empty())
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}: {}", files[i].string(), comma_is_no_point(word)));
    }
    if (failure) return tl::unexpected(*failure);
    std::vector<std::string> unknown;
    for (const Tree& tree : trees)
        if (!is_complete) add_unknown_keys(tree, 0, unknown);
    if (!unknown.empty()) {
        rig.problems.push_back(
            fmt::format("these keys are not understood: {}; understood are camera_matrix or K, "
                        "distortion or D, R or rvec, T or tvec, RT or extrinsics, and more "
                        "(docs/calibrate.md)",
                        fmt::join(unknown, ", ")));
    }
    return rig;
}

}  // namespace atrium::calibrate
