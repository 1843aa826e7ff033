#include "tools/calibrate/formats/camera_keys.hpp"

#include "tools/calibrate/formats/format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

namespace atrium::calibrate {
namespace {

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
constexpr Keys kDistortion{"distortion_coefficients",
                           "distortionCoefficients",
                           "dist_coeffs",
                           "distCoeffs",
                           "dist_coeff",
                           "coeffs",
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
constexpr Keys kPose{"extrinsics",
                     "extrinsic",
                     "extrinsic_matrix",
                     "RT",
                     "Rt",
                     "pose",
                     "T_wc",
                     "T_cw",
                     "c2w",
                     "w2c",
                     "cam2world",
                     "world2cam",
                     "camera_to_world",
                     "world_to_camera",
                     "transform"};
constexpr Keys kWidth{"image_width", "width", "W"};
constexpr Keys kHeight{"image_height", "height", "H"};
constexpr Keys kSize{"image_size", "imageSize", "img_size", "size", "resolution"};
constexpr Keys kName{
    "camera_name", "name", "camera_id", "cameraId", "cam_id", "cam_name", "id", "serial", "label"};
constexpr Keys kModel{"distortion_model", "camera_model", "model"};

// maps in which the values of their camera may be
constexpr Keys kWrappers{
    "intrinsics", "intrinsic", "extrinsics", "extrinsic", "pose", "calibration", "lens"};

bool is_key(const std::string& key) {
    for (const Keys keys : {kMatrix, kDistortion, kRotation, kTranslation, kPose}) {
        if (std::ranges::any_of(keys, [&](const char* name) { return key == name; })) return true;
    }
    return false;
}

// K_01, dist_01, Rot_01, T_01: the endings of a file with all cameras side by side.
std::vector<std::string> suffixes(const Tree& tree) {
    std::vector<std::string> result;
    if (!tree.is_object()) return result;
    for (const auto& [key, value] : tree.items()) {
        for (const Keys keys : {kMatrix, kTranslation}) {
            for (const char* name : keys) {
                const std::string head = std::string(name) + "_";
                const std::string suffix = key.starts_with(head) ? key.substr(head.size() - 1) : "";
                // camera_matrix is a key by itself, not matrix of "camera"
                if (suffix.size() < 2 || suffix.size() > 40 || !numbers(value)) continue;
                if (std::ranges::find(result, suffix) == result.end() && !is_key(key))
                    result.push_back(suffix);
            }
        }
    }
    return result;
}

const Tree* find_with(const Tree& tree, Keys keys, const std::string& suffix) {
    for (const char* key : keys) {
        if (const Tree* value = find(tree, {(key + suffix).c_str()})) return value;
    }
    return nullptr;
}
void set(const Tree*& target, const Tree* value) {
    if (value != nullptr) target = value;
}
void set_size(Found& camera, const Tree& tree, const std::string& suffix) {
    set(camera.width, find_with(tree, kWidth, suffix));
    set(camera.height, find_with(tree, kHeight, suffix));
    set(camera.size, find_with(tree, kSize, suffix));
}

bool has_focal(const Tree& map) {
    return std::ranges::all_of(kFocal, [&](const Keys keys) {
        const Tree* value = find(map, keys);
        return value != nullptr && number(*value).has_value();
    });
}

bool has_coefficients(const Tree& map) {
    const Tree* first = find(map, {"k1"});
    return first != nullptr && number(*first).has_value();
}

// At the top of a file a camera's name may follow: K_01.
bool is_one_of(const std::string& key, std::initializer_list<Keys> all, int depth) {
    const auto lower = [](std::string text) {
        std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
        return text;
    };
    for (const Keys keys : all) {
        for (const char* known : keys) {
            if (lower(key) == lower(known) ||
                (depth == 0 && key.starts_with(std::string(known) + "_")))
                return true;
        }
    }
    return false;
}

bool is_key_of_numbers(const std::string& key, int depth) {
    return is_one_of(key,
                     {kMatrix,
                      kFocal[0],
                      kFocal[1],
                      kFocal[2],
                      kFocal[3],
                      kDistortion,
                      kCoefficients,
                      kRotation,
                      kTranslation,
                      kPose,
                      kWidth,
                      kHeight,
                      kSize},
                     depth);
}

bool is_known_key(const std::string& key, int depth) {
    return is_key_of_numbers(key, depth) || is_one_of(key, {kName, kModel}, depth);
}

// The first text in a list, or lists of those, of numbers.
std::string text_among_numbers(const Tree& value, int depth) {
    if (depth > 3 || !value.is_array()) return {};
    for (const Tree& element : value) {
        if (element.is_string()) return element.get<std::string>();
        if (std::string text = text_among_numbers(element, depth + 1); !text.empty()) return text;
    }
    return {};
}

std::string unreadable_below(const Tree& tree, const std::string& path, int depth) {
    if (depth > 4 || !tree.is_structured()) return {};
    for (const auto& [key, value] : tree.items()) {
        const std::string where = path + (path.empty() ? "" : ".") + key;
        if (tree.is_object() && is_key_of_numbers(key, depth)) {
            const std::string comma =
                value.is_string() ? decimal_comma(value.get<std::string>()) : std::string();
            const std::string text = comma.empty() ? text_among_numbers(value, 0) : comma;
            if (!decimal_comma(text).empty()) return where + ": " + comma_is_no_point(text);
            if (!text.empty())
                return fmt::format("{}: '{}' is not a number; write numbers without quotes",
                                   where,
                                   text.substr(0, 40));
        }
        if (std::string bad = unreadable_below(value, where, depth + 1); !bad.empty()) return bad;
    }
    return {};
}

void add_unknown_below(const Tree& tree, int depth, std::vector<std::string>& unknown) {
    constexpr std::size_t kMaxNamed = 12;
    if (depth > 3 || !tree.is_structured()) return;
    for (const auto& [key, value] : tree.items()) {
        if (unknown.size() == kMaxNamed) return;
        const bool is_unknown = tree.is_object() && numbers(value) && !is_known_key(key, depth);
        if (is_unknown && std::ranges::find(unknown, key) == unknown.end()) unknown.push_back(key);
        if (!numbers(value)) add_unknown_below(value, depth + 1, unknown);
    }
}

// "cam2" of "cam2_to_cam1"; else the whole name.
std::string first_of_two(const std::string& name) {
    const std::size_t at = name.find("_to_");
    return at == std::string::npos || at == 0 ? name : name.substr(0, at);
}

}  // namespace

Tree CameraKeys::flattened(Tree tree, int depth) {
    constexpr int kMaxDepth = 4;
    if (depth > kMaxDepth || !tree.is_structured()) return tree;
    for (Tree& child : tree) child = flattened(std::move(child), depth + 1);
    if (!tree.is_object()) return tree;
    for (const char* key : kWrappers) {
        const Tree* found = find(tree, {key});
        // a matrix of OpenCV is a map with data
        if (found == nullptr || !found->is_object() || numbers(*found)) continue;
        const auto wrapper = std::ranges::find_if(
            tree.items(), [&](const auto& entry) { return &entry.value() == found; });
        const Tree inner = *found;
        tree.erase(wrapper.key());
        for (const auto& [name, value] : inner.items())
            if (find(tree, {name.c_str()}) == nullptr) tree[name] = value;
    }
    return tree;
}

Expected<void> CameraKeys::add(const Tree& tree,
                               const std::filesystem::path& file,
                               const std::string& name) {
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
    add_map(tree, name, 0);
    if (cameras_.size() > kMaxCamerasRead) return too_many_cameras(where_);
    return {};
}

// Cameras of stereoCalibrate: the pose is that of the second in the first.
Expected<void> CameraKeys::add_stereo(const Tree& tree) {
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

void CameraKeys::add_keys(const Tree& tree, const std::string& suffix, const std::string& name) {
    Found& camera = cameras_[name];
    set(camera.matrix, find_with(tree, kMatrix, suffix));
    for (const Tree* map : {&tree, camera.matrix})
        if (suffix.empty() && map != nullptr && has_focal(*map)) camera.focal = map;
    set(camera.distortion, find_with(tree, kDistortion, suffix));
    for (const Tree* map : {&tree, camera.matrix, camera.distortion})
        if (suffix.empty() && map != nullptr && has_coefficients(*map)) camera.coefficients = map;
    set(camera.rotation, find_with(tree, kRotation, suffix));
    set(camera.translation, find_with(tree, kTranslation, suffix));
    set(camera.pose, find_with(tree, kPose, suffix));
    set(camera.model, find_with(tree, kModel, suffix));
    set_size(camera, tree, suffix);
    camera.where = where_;
    found_some_ = true;
}

// A map with the keys of a camera, or maps or lists of those.
void CameraKeys::add_map(const Tree& tree, const std::string& name, int depth) {
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

void CameraKeys::finish() {
    for (auto it = cameras_.begin(); it != cameras_.end();) {
        const auto& [name, found] = *it;
        const auto camera = cameras_.find(first_of_two(name));
        const bool has_pose = found.pose != nullptr || found.rotation != nullptr;
        const bool is_pose_only = has_pose && found.matrix == nullptr && found.focal == nullptr;
        if (camera == it || camera == cameras_.end() || !is_pose_only ||
            camera->second.pose != nullptr || camera->second.rotation != nullptr) {
            ++it;
            continue;
        }
        camera->second.pose = found.pose;
        camera->second.rotation = found.rotation;
        camera->second.translation = found.translation;
        it = cameras_.erase(it);
    }
}

std::string unreadable_value(const Tree& tree) { return unreadable_below(tree, "", 0); }

void add_unknown_keys(const Tree& tree, std::vector<std::string>& unknown) {
    add_unknown_below(tree, 0, unknown);
}

}  // namespace atrium::calibrate
