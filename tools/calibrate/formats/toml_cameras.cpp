// The TOML of aniposelib, which pose2sim and caliscope share: one table per camera with size,
// matrix, distortions, and rotation (Rodrigues vector) and translation of camera_from_site.
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/lens.hpp"
#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>

namespace atrium::calibrate {
namespace {

std::string camera_name(const Tree& table, const std::string& key) {
    const Tree* name = find(table, {"name"});
    return name != nullptr && name->is_string() ? name->get<std::string>() : key;
}

Expected<ForeignCamera> toml_camera(const Tree& table,
                                    const std::string& key,
                                    const std::string& where,
                                    std::vector<std::string>& notes) {
    ForeignCamera camera;
    camera.name = camera_name(table, key);
    const auto wrong = [&](const std::string& what) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: camera '{}': {}", where, camera.name, what));
    };
    LensNumbers lens;
    const auto read = [&](const char* key_of, std::vector<double>& values) {
        const Tree* value = find(table, {key_of});
        if (value == nullptr) return true;
        values = numbers(*value).value_or(std::vector<double>{});
        return numbers(*value).has_value();
    };
    if (!read("matrix", lens.matrix) || !read("distortions", lens.distortion) ||
        !read("size", lens.size))
        return wrong("matrix, distortions and size must be finite numbers");
    const Tree* fisheye = find(table, {"fisheye"});
    if (fisheye != nullptr && fisheye->is_boolean() && fisheye->get<bool>()) lens.model = "fisheye";
    if (auto set = set_lens(camera, lens, where, notes); !set) return tl::unexpected(set.error());
    std::vector<double> rotation;
    std::vector<double> translation;
    if (!read("rotation", rotation) || !read("translation", translation))
        return wrong("rotation and translation must be finite numbers");
    if (rotation.empty() && translation.empty()) return camera;  // not yet calibrated
    const auto matrix = rotation_of(rotation);
    if (!matrix || translation.size() != 3) {
        const bool has_too_many =
            translation.size() > 3 || (rotation.size() > 3 && rotation.size() != 9);
        return wrong(
            fmt::format("rotation must be a rotation vector of 3 numbers or a matrix of 9, and "
                        "translation 3 numbers{}",
                        has_too_many ? kCommaMakesTwo : ""));
    }
    camera.pose = ForeignPose{*matrix, {translation[0], translation[1], translation[2]}};
    return camera;
}

bool is_ignored(const Tree& table) {
    const Tree* ignore = find(table, {"ignore"});
    return ignore != nullptr && ignore->is_boolean() && ignore->get<bool>();
}

}  // namespace

Expected<ForeignRig> read_toml_cameras(const Files& files) {
    ForeignRig rig;
    rig.format = "TOML of aniposelib (Anipose, pose2sim, caliscope)";
    for (const auto& file : files) {
        const auto text = read_bytes(file, kMaxTextBytes);
        if (!text) return tl::unexpected(text.error());
        const auto tree = parse_toml(*text, file.string());
        if (!tree) return tl::unexpected(tree.error());
        if (is_rig(*tree)) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("{}: this is a rig.toml of Atrium already; use it as it "
                                          "is, or `calibrate export`",
                                          file.string()));
        }
        // caliscope nests its cameras in [cameras.N]
        for (const Tree* level : {&*tree, find(*tree, {"cameras"})}) {
            if (level == nullptr || !level->is_object()) continue;
            for (const auto& [key, table] : level->items()) {
                if (find(table, {"matrix"}) == nullptr) continue;
                if (is_ignored(table)) {
                    rig.left_out[camera_name(table, key)] =
                        "the file says to ignore it: set ignore = false";
                    continue;
                }
                auto camera = toml_camera(table, key, file.string(), rig.notes);
                if (!camera) return tl::unexpected(camera.error());
                rig.cameras.push_back(std::move(*camera));
            }
        }
    }
    return rig;
}

}  // namespace atrium::calibrate
