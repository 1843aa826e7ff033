// Kalibr's camchain.yaml: cam0, cam1, ... each with the transform from the camera before.
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/lens.hpp"

#include <fmt/format.h>

namespace atrium::calibrate {
namespace {

std::optional<ForeignPose> step_of(const Tree& camera) {
    const Tree* value = find(camera, {"T_cn_cnm1"});
    if (value == nullptr) return std::nullopt;
    const auto m = numbers(*value);
    if (!m || m->size() != 16) return std::nullopt;
    std::vector<double> rotation;
    for (const std::size_t i : {0, 1, 2, 4, 5, 6, 8, 9, 10}) rotation.push_back((*m)[i]);
    const auto matrix = rotation_of(rotation);
    if (!matrix) return std::nullopt;
    return ForeignPose{*matrix, {(*m)[3], (*m)[7], (*m)[11]}};
}

bool has_number_too_many(const Tree& camera) {
    const Tree* value = find(camera, {"T_cn_cnm1"});
    const auto m = value == nullptr ? std::nullopt : numbers(*value);
    return m && m->size() > 16;
}

Expected<ForeignCamera> chain_camera(const Tree& table,
                                     const std::string& name,
                                     const std::string& where,
                                     std::vector<std::string>& notes) {
    ForeignCamera camera;
    camera.name = name;
    const auto wrong = [&](const std::string& what) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: camera '{}': {}", where, name, what));
    };
    const Tree* model = find(table, {"camera_model"});
    if (model != nullptr && *model != "pinhole") {
        return wrong(
            fmt::format("camera_model {} is not supported; calibrate with --models "
                        "pinhole-radtan",
                        model->dump(-1, ' ', false, Tree::error_handler_t::replace)));
    }
    LensNumbers lens;
    const auto read = [&](const char* key, std::vector<double>& values) {
        const Tree* value = find(table, {key});
        const auto all = value == nullptr ? std::nullopt : numbers(*value);
        values = all.value_or(std::vector<double>{});
        return all.has_value();
    };
    if (!read("intrinsics", lens.matrix) || !read("resolution", lens.size) ||
        !read("distortion_coeffs", lens.distortion))
        return wrong("intrinsics, distortion_coeffs and resolution must be finite numbers");
    if (const Tree* kind = find(table, {"distortion_model"}); kind != nullptr && kind->is_string())
        lens.model = kind->get<std::string>();
    if (lens.model == "fov" || lens.model == "none") {
        if (lens.model == "fov")
            return wrong(
                "distortion_model fov is not supported; calibrate with --models "
                "pinhole-radtan");
        lens.distortion.clear();
    }
    if (lens.distortion.size() > 4) {
        return wrong(fmt::format("distortion_coeffs has {} numbers, but must have 4{}",
                                 lens.distortion.size(),
                                 kCommaMakesTwo));
    }
    if (auto set = set_lens(camera, lens, where, notes); !set) return tl::unexpected(set.error());
    return camera;
}

}  // namespace

Expected<ForeignRig> read_kalibr(const Files& files) {
    ForeignRig rig;
    rig.format = "Kalibr";
    rig.units = "m";
    rig.has_frame = false;
    rig.is_sure_of_poses = true;
    if (files.size() != 1)
        return make_error(ErrorKind::kConfiguration, "Kalibr: give one camchain.yaml");
    const std::string where = files.front().string();
    const auto text = read_bytes(files.front(), kMaxTextBytes);
    if (!text) return tl::unexpected(text.error());
    const auto tree = parse_file_storage(*text, where);
    if (!tree) return tl::unexpected(tree.error());
    geometry::RigidTransform camera_from_first;
    for (int i = 0;; ++i) {
        const std::string name = fmt::format("cam{}", i);
        const Tree* table = find(*tree, {name.c_str()});
        if (table == nullptr) break;
        auto camera = chain_camera(*table, name, where, rig.notes);
        if (!camera) return tl::unexpected(camera.error());
        if (i > 0) {
            const auto step = step_of(*table);
            if (!step) {
                return make_error(ErrorKind::kInvalidData,
                                  fmt::format("{}: camera '{}': T_cn_cnm1 must be a transform of 4 "
                                              "rows of 4 numbers, from the camera before{}",
                                              where,
                                              name,
                                              has_number_too_many(*table) ? kCommaMakesTwo : ""));
            }
            camera_from_first = camera_from_site(*step, {}) * camera_from_first;
        }
        camera->pose = foreign_pose(camera_from_first, {});
        rig.cameras.push_back(std::move(*camera));
    }
    return rig;
}

}  // namespace atrium::calibrate
