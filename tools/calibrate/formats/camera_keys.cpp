#include "tools/calibrate/formats/camera_keys.hpp"

#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/key_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace atrium::calibrate {
namespace {

// maps in which the values of their camera may be
constexpr Keys kWrappers{
    "intrinsics", "intrinsic", "extrinsics", "extrinsic", "pose", "calibration", "lens"};

// "_01" of K_01, dist_01, Rot_01, T_01 in a file with all cameras side by side; else empty.
std::string camera_suffix(const std::string& key, const Tree& value) {
    // camera_matrix is a key by itself, not matrix of "camera"
    if (is_key(key) || !numbers(value)) return {};
    for (const Keys keys : {kMatrix, kTranslation}) {
        for (const char* name : keys) {
            const std::size_t at = std::string(name).size();
            if (key.size() > at + 1 && key.size() <= at + 40 && key.starts_with(name) &&
                key[at] == '_')
                return key.substr(at);
        }
    }
    return {};
}

std::vector<std::string> suffixes(const Tree& tree, const std::set<std::string>& words) {
    std::vector<std::string> result;
    if (!tree.is_object()) return result;
    for (const auto& [key, value] : tree.items()) {
        std::string suffix = camera_suffix(key, value);
        if (!suffix.empty() && !words.contains(suffix) &&
            std::ranges::find(result, suffix) == result.end())
            result.push_back(std::move(suffix));
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
void set(const Tree*& target, std::string& key, const Tree& map, const Tree* value) {
    if (value == nullptr) return;
    target = value;
    for (const auto& [name, child] : map.items())
        if (&child == value) key = name;
}
bool has_three(const Tree* value) {
    const auto all = value == nullptr ? std::nullopt : numbers(*value);
    return all && all->size() == 3;
}
void set_pose(Found& camera, const Tree& tree, const std::string& suffix) {
    set(camera.rotation, camera.rotation_key, tree, find_with(tree, kRotation, suffix));
    set(camera.translation, camera.translation_key, tree, find_with(tree, kTranslation, suffix));
    const Tree* cw = find_with(tree, kRotationCw, suffix);
    const Tree* wc = find_with(tree, kRotationWc, suffix);
    const Tree* t_cw = find_with(tree, kTranslationCw, suffix);
    const Tree* t_wc = find_with(tree, kTranslationWc, suffix);
    // T_cw is also the name of a matrix
    if (!has_three(t_cw)) t_cw = nullptr;
    if (!has_three(t_wc)) t_wc = nullptr;
    if (cw == nullptr && wc == nullptr && t_cw == nullptr && t_wc == nullptr) {
        set(camera.pose, camera.pose_key, tree, find_with(tree, kPose, suffix));
        return;
    }
    // both directions of one pose: one is enough
    if (cw != nullptr && t_cw != nullptr) wc = t_wc = nullptr;
    if (wc != nullptr && t_wc != nullptr) cw = t_cw = nullptr;
    set(camera.rotation, camera.rotation_key, tree, cw != nullptr ? cw : wc);
    set(camera.translation, camera.translation_key, tree, t_cw != nullptr ? t_cw : t_wc);
    // a lens's place beside a rotation into the camera
    camera.meaning = t_wc != nullptr && cw != nullptr   ? Reading::Pose::kRotationAndPosition
                     : t_cw != nullptr || cw != nullptr ? Reading::Pose::kCameraFromSite
                                                        : Reading::Pose::kSiteFromCamera;
    camera.is_mixed = wc != nullptr && t_cw != nullptr;
}
// Intrinsics, and what OpenPose calls a camera matrix beside them: the pose.
void set_matrices(Found& camera, const Tree& tree, const std::string& suffix) {
    const Tree* narrow = nullptr;
    const Tree* wide = nullptr;
    for (const char* key : kMatrix) {
        const Tree* value = find(tree, {(key + suffix).c_str()});
        if (value == nullptr) continue;
        const auto all = numbers(*value);
        const Tree*& kind = all && (all->size() == 12 || all->size() == 16) ? wide : narrow;
        if (kind == nullptr) kind = value;
    }
    set(camera.matrix, narrow);
    set(camera.wide_matrix, camera.wide_key, tree, wide);
}
void set_size(Found& camera, const Tree& tree, const std::string& suffix) {
    set(camera.width, find_with(tree, kWidth, suffix));
    set(camera.height, find_with(tree, kHeight, suffix));
    set(camera.size, find_with(tree, kSize, suffix));
}

bool has_size(const Found& camera) {
    return camera.size != nullptr || (camera.width != nullptr && camera.height != nullptr);
}
// Whether the size in this map is one of pictures, not that of a board.
bool has_picture_size(const Tree& map) {
    const auto is_side = [](const std::optional<double>& value) {
        return value && *value >= 16.0 && *value <= 8192.0;
    };
    if (const Tree* size = find(map, kSize)) {
        const auto sides = numbers(*size);
        return sides && sides->size() == 2 && is_side((*sides)[0]) && is_side((*sides)[1]);
    }
    const Tree* width = find(map, kWidth);
    const Tree* height = find(map, kHeight);
    return width != nullptr && height != nullptr && is_side(number(*width)) &&
           is_side(number(*height));
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

std::set<std::string> CameraKeys::find_words(const std::vector<Tree>& trees) {
    std::set<std::string> keys;
    std::set<std::string> all;
    std::set<std::string> repeated;
    bool has_plain = false;
    for (const Tree& tree : trees) {
        if (!tree.is_object()) continue;
        for (const auto& [key, value] : tree.items()) {
            const std::string suffix = camera_suffix(key, value);
            has_plain = has_plain || (is_key(key) && numbers(value));
            if (suffix.empty()) continue;
            all.insert(suffix);
            if (!keys.insert(key).second) repeated.insert(suffix);
        }
    }
    if (all.size() == 1 && has_plain) return all;
    // else the same cameras were given twice
    if (has_plain || all.size() < trees.size()) return repeated;
    return {};
}

Expected<void> CameraKeys::add(const Tree& tree,
                               const std::filesystem::path& file,
                               const std::string& name) {
    where_ = file.string();
    found_some_ = false;
    of_all_ = has_picture_size(tree) ? &tree : nullptr;
    const bool is_stereo = find_with(tree, kMatrix, "1") != nullptr;
    has_stereo_ = has_stereo_ || is_stereo;
    const bool is_stereo_pose =
        find(tree, {"R"}) != nullptr && find(tree, {"T"}) != nullptr &&
        (has_stereo_ || (find(tree, {"R1"}) != nullptr && find(tree, {"P1"}) != nullptr));
    if (is_stereo || is_stereo_pose) return add_stereo(tree);
    for (const std::string& suffix : suffixes(tree, words_))
        add_keys(tree, suffix, suffix.substr(1));
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
    set(second.rotation, second.rotation_key, tree, find(tree, {"R"}));
    set(second.translation, second.translation_key, tree, find(tree, {"T"}));
    Found& first = cameras_["cam1"];
    first.rotation = &no_rotation_;
    first.translation = &no_rotation_;
    found_some_ = true;
    return {};
}

void CameraKeys::add_keys(const Tree& tree, const std::string& suffix, const std::string& name) {
    Found& camera = cameras_[name];
    set_matrices(camera, tree, suffix);
    for (const Tree* map : {&tree, camera.matrix})
        if (suffix.empty() && map != nullptr && has_focal(*map)) camera.focal = map;
    set(camera.distortion, find_with(tree, kDistortion, suffix));
    for (const Tree* map : {&tree, camera.matrix, camera.distortion})
        if (suffix.empty() && map != nullptr && has_coefficients(*map)) camera.coefficients = map;
    set_pose(camera, tree, suffix);
    set(camera.model, find_with(tree, kModel, suffix));
    set_size(camera, tree, suffix);
    if (!has_size(camera) && of_all_ != nullptr) set_size(camera, *of_all_, "");
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
                           ((has(kRotation) || has(kRotationCw) || has(kRotationWc)) &&
                            (has(kTranslation) || has(kTranslationCw) || has(kTranslationWc)));
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
    for (auto& [name, found] : cameras_) {
        const bool has_lens = found.matrix != nullptr || found.focal != nullptr;
        const bool has_pose = found.pose != nullptr || found.rotation != nullptr;
        if (found.wide_matrix == nullptr || !has_lens || has_pose) continue;
        found.pose = found.wide_matrix;
        found.pose_key = found.wide_key;
    }
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
        camera->second.rotation_key = found.rotation_key;
        camera->second.translation_key = found.translation_key;
        camera->second.pose_key = found.pose_key;
        it = cameras_.erase(it);
    }
}

}  // namespace atrium::calibrate
