// Files of OpenCV's FileStorage, and JSON with the same keys (camera_keys.hpp).
#include "tools/calibrate/formats/camera_keys.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/key_names.hpp"
#include "tools/calibrate/formats/lens.hpp"
#include "tools/calibrate/names/name_parts.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace atrium::calibrate {
namespace {

// Programs that multiply rows with matrices, as MATLAB, write them transposed: K ends with the row
// cx, cy, 1, and a pose with the row tx, ty, tz, 1.
bool is_transposed(const std::vector<double>& m, std::size_t size) {
    if (m.size() != size * size || m.back() != 1.0) return false;
    bool has_last_row = false;
    for (std::size_t i = 0; i + 1 < size; ++i) {
        if (m[size * i + size - 1] != 0.0) return false;
        has_last_row = has_last_row || m[size * (size - 1) + i] != 0.0;
    }
    return has_last_row && (size != 3 || m[1] == 0.0);
}
void transpose(std::vector<double>& m, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
        for (std::size_t k = 0; k < i; ++k) std::swap(m[size * i + k], m[size * k + i]);
}

// The left 3x3 numbers of a matrix of 3x4 or 4x4, row by row.
std::vector<double> left_of(const std::vector<double>& m) {
    return {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
}

std::optional<ForeignPose> pose_of(const Found& found) {
    std::vector<double> rotation;
    std::vector<double> translation;
    if (found.pose != nullptr) {
        auto m = numbers(*found.pose);
        if (m && is_transposed(*m, 4)) transpose(*m, 4);
        if (!m || (m->size() != 12 && m->size() != 16)) return std::nullopt;
        rotation = left_of(*m);
        for (const std::size_t i : {3, 7, 11}) translation.push_back((*m)[i]);
    } else {
        if (found.rotation == nullptr || found.translation == nullptr) return std::nullopt;
        rotation = numbers(*found.rotation).value_or(rotation);
        translation = numbers(*found.translation).value_or(translation);
    }
    auto matrix = rotation_of(rotation);
    if (!matrix || translation.size() != 3) return std::nullopt;
    if (found.is_mixed) matrix->transposeInPlace();
    return ForeignPose{*matrix, {translation[0], translation[1], translation[2]}};
}

std::size_t count_numbers(const Tree* value) {
    const auto all = value == nullptr ? std::nullopt : numbers(*value);
    return all ? all->size() : 0;
}

// The keys of a pose and how many numbers each has: "R_vec has 4, T 3".
std::string read_pose(const Found& found) {
    if (found.pose != nullptr)
        return fmt::format("{} has {}", found.pose_key, count_numbers(found.pose));
    return fmt::format("{} has {}, {} {}",
                       found.rotation_key,
                       count_numbers(found.rotation),
                       found.translation_key,
                       count_numbers(found.translation));
}

// A list takes a decimal comma for a separator.
bool has_number_too_many(const Found& found) {
    const std::size_t of_rotation = count_numbers(found.rotation);
    const std::size_t of_pose = count_numbers(found.pose);
    return of_pose > 12 ? of_pose != 16
                        : count_numbers(found.translation) > 3 || of_rotation > 9 ||
                              (of_rotation > 3 && of_rotation < 9);
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

// "fx = 900, ..." if a matrix of 3x4 numbers is K [R|t] of a plausible lens; else empty. With wrong
// numbers, as of decimal commas, it is not.
std::string lens_in_projection(const std::vector<double>& m) {
    constexpr double kLeastFocal_px = 10.0;
    constexpr double kMostSkew = 0.1;
    constexpr double kMostUneven = 2.0;  // ratio of the focal lengths
    Eigen::Matrix3d left;
    left << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
    const Eigen::Matrix3d inverse = left.inverse();  // R' K^-1, whose QR these are
    if (!inverse.allFinite()) return {};
    const Eigen::HouseholderQR<Eigen::Matrix3d> qr(inverse);
    const Eigen::Matrix3d upper = qr.matrixQR().triangularView<Eigen::Upper>();
    Eigen::Matrix3d k = upper.inverse();
    for (int i = 0; i < 3; ++i)
        if (k(i, i) < 0.0) k.col(i) = -k.col(i);
    k /= k(2, 2);
    const bool is_lens = k.allFinite() && k(0, 0) >= kLeastFocal_px && k(1, 1) >= kLeastFocal_px &&
                         std::max(k(0, 0), k(1, 1)) <= kMostUneven * std::min(k(0, 0), k(1, 1)) &&
                         std::abs(k(0, 1)) <= kMostSkew * k(0, 0);
    if (!is_lens) return {};
    return fmt::format(
        "fx = {:.6g}, fy = {:.6g}, cx = {:.6g}, cy = {:.6g}", k(0, 0), k(1, 1), k(0, 2), k(1, 2));
}

// What a camera matrix of 3x4 or 4x4 numbers looks like, with the cure; empty: like neither.
std::string explain_wide(const std::string& key, const std::vector<double>& m) {
    const char* shape = m.size() == 12 ? "3x4" : "4x4";
    if (rotation_of(left_of(m)))
        return fmt::format(
            "{} has {} numbers and looks like a pose [R|t], as OpenPose writes it: "
            "give the intrinsics beside it, as Intrinsics or K, with 9 numbers",
            key,
            shape);
    if (const std::string lens = lens_in_projection(m); !lens.empty())
        return fmt::format(
            "{} has {} numbers and looks like a projection matrix P = K [R|t] with "
            "{}: write K with 9 numbers, and the inverse of K times P as RT",
            key,
            shape,
            lens);
    return {};
}

constexpr double kLongestRotation = 6.5;  // [rad], a whole turn

// Whether a size is that of an array, height and width: the principal point is far from the middle
// of the picture, and in it the other way round.
bool is_height_first(const LensNumbers& lens) {
    const bool has_nine = lens.matrix.size() == 9;
    if (lens.size.size() != 2 || (lens.matrix.size() != 4 && !has_nine)) return false;
    const double cx = lens.matrix[2];
    const double cy = lens.matrix[has_nine ? 5 : 3];
    const auto off_middle = [&](double width, double height) {
        return std::max(std::abs(cx / width - 0.5), std::abs(cy / height - 0.5));
    };
    return off_middle(lens.size[0], lens.size[1]) > 0.12 &&
           off_middle(lens.size[1], lens.size[0]) < 0.1;
}

Expected<ForeignCamera> camera_of(const std::string& name,
                                  const Found& found,
                                  std::vector<std::string>& notes,
                                  std::vector<std::string>& height_first,
                                  std::vector<std::string>& transposed) {
    ForeignCamera camera;
    camera.name = name;
    const auto wrong = [&](const std::string& what) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: camera '{}': {}", found.where, name, what));
    };
    // finish() left a wide matrix to be the camera matrix, or made it the pose
    const Tree* matrix_given = found.matrix;
    if (matrix_given == nullptr && found.focal == nullptr) matrix_given = found.wide_matrix;
    const auto wide = found.wide_matrix == nullptr ? std::nullopt : numbers(*found.wide_matrix);
    const std::string of_wide = wide ? explain_wide(found.wide_key, *wide) : "";
    if (matrix_given == found.wide_matrix && !of_wide.empty()) return wrong(of_wide);
    if (matrix_given != nullptr || found.focal != nullptr) {
        LensNumbers lens;
        if (found.focal != nullptr) {
            for (const Keys keys : kFocal)
                lens.matrix.push_back(*number(*find(*found.focal, keys)));
        } else if (const auto matrix = numbers(*matrix_given)) {
            lens.matrix = *matrix;
            if (is_transposed(lens.matrix, 3)) {
                transpose(lens.matrix, 3);
                transposed.push_back(name);
            }
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
            if (is_height_first(lens)) {
                std::swap(lens.size[0], lens.size[1]);
                height_first.push_back(name);
            }
        } else if (found.width != nullptr && found.height != nullptr) {
            const auto width = number(*found.width);
            const auto height = number(*found.height);
            if (width && height) lens.size = {*width, *height};
        }
        if (auto set = set_lens(camera, lens, found.where, notes); !set)
            return tl::unexpected(set.error());
    }
    if (found.rotation != nullptr && found.pose == nullptr) {
        const std::vector<double> vector = numbers(*found.rotation).value_or(std::vector<double>{});
        const double length =
            vector.size() == 3 ? std::hypot(vector[0], vector[1], vector[2]) : 0.0;
        if (length > kLongestRotation) {
            return wrong(
                fmt::format("its rotation vector is {:.3g} long, but its length is an "
                            "angle in radians; is it in degrees?",
                            length));
        }
    }
    camera.pose = pose_of(found);
    const bool has_values =
        found.pose != nullptr || (found.rotation != nullptr && found.translation != nullptr);
    if (has_values && !camera.pose) {
        if (found.pose == found.wide_matrix && !of_wide.empty()) return wrong(of_wide);
        return wrong(fmt::format("its pose must be {}; {}{}",
                                 found.pose != nullptr
                                     ? "a matrix of 3x4 or 4x4 numbers with a right-handed rotation"
                                     : "a right-handed rotation matrix of 9 numbers or a rotation "
                                       "vector of 3, and a translation of 3 numbers",
                                 read_pose(found),
                                 has_number_too_many(found) ? kCommaMakesTwo : ""));
    }
    return camera;
}

// What the keys of all cameras say of their poses, as R_wc does; else what OpenCV documents.
Reading::Pose common_meaning(const std::map<std::string, Found>& cameras) {
    std::set<std::optional<Reading::Pose>> said;
    for (const auto& [name, found] : cameras) said.insert(found.meaning);
    return said.size() == 1 ? said.begin()->value_or(Reading::Pose::kCameraFromSite)
                            : Reading::Pose::kCameraFromSite;
}

}  // namespace

Expected<ForeignRig> read_opencv(const Files& files) {
    ForeignRig rig;
    rig.format = "OpenCV";
    std::vector<Tree> trees;  // `Found` points into them
    trees.reserve(files.size());
    std::vector<std::string> names;
    for (const auto& file : files) names.push_back(file.stem().string());
    names = without_calibration_words(names);
    for (const auto& file : files) {
        const auto text = read_bytes(file, kMaxTextBytes);
        if (!text) return tl::unexpected(text.error());
        const std::size_t first = text->find_first_not_of(" \t\r\n");
        const bool is_json =
            first != std::string::npos && ((*text)[first] == '{' || (*text)[first] == '[');
        auto tree =
            is_json ? parse_json(*text, file.string()) : parse_file_storage(*text, file.string());
        if (!tree) return tl::unexpected(tree.error());
        if (const std::string bad = unreadable_value(*tree); !bad.empty())
            return make_error(ErrorKind::kInvalidData, fmt::format("{}: {}", file.string(), bad));
        trees.push_back(CameraKeys::flattened(std::move(*tree)));
    }
    const std::set<std::string> words = CameraKeys::find_words(trees);
    CameraKeys collector(words);
    for (std::size_t i = 0; i < trees.size(); ++i) {
        if (auto added = collector.add(trees[i], files[i], names[i]); !added)
            return tl::unexpected(added.error());
    }
    collector.finish();
    std::vector<std::string> height_first;
    std::vector<std::string> transposed;
    std::optional<Error> failure;
    rig.has_matrix_poses = std::ranges::all_of(
        collector.cameras(), [](const auto& camera) { return camera.second.pose != nullptr; });
    rig.documented.pose = common_meaning(collector.cameras());
    for (const auto& [name, found] : collector.cameras()) {
        auto camera = camera_of(name, found, rig.notes, height_first, transposed);
        if (!camera && !failure) failure = camera.error();
        if (camera) rig.cameras.push_back(std::move(*camera));
    }
    std::vector<std::string> undistorted;
    for (const auto& [name, found] : collector.cameras()) {
        const bool has_lens = found.matrix != nullptr || found.focal != nullptr;
        if (has_lens && found.distortion == nullptr && found.coefficients == nullptr)
            undistorted.push_back(name);
    }
    if (!undistorted.empty()) {
        rig.checks.push_back(fmt::format(
            "lens: the calibration gives no distortion of {}: right for undistorted pictures. If "
            "straight edges are bent in the pictures, calibrate with distortion",
            fmt::join(undistorted, ", ")));
    }
    if (!transposed.empty()) {
        rig.notes.push_back(
            fmt::format("lens: the camera matrix of {} is transposed, as MATLAB writes it, and is "
                        "read so",
                        fmt::join(transposed, ", ")));
    }
    if (!height_first.empty()) {
        rig.checks.push_back(fmt::format(
            "size: of {} it is taken as height, width, because the principal point is in the "
            "middle of the picture then; if that is wrong, say --size",
            fmt::join(height_first, ", ")));
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
        if (!is_complete) add_unknown_keys(tree, words, unknown);
    for (std::size_t i = 0; trees.size() > 1 && !is_complete && i < trees.size(); ++i) {
        CameraKeys alone(words);
        if (alone.add(trees[i], files[i], names[i]) && alone.cameras().empty())
            rig.problems.push_back(
                fmt::format("{}: nothing in it is understood", files[i].string()));
    }
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
