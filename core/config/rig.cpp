#include "core/config/rig.hpp"

#include "core/base/fnv1a.hpp"
#include "core/config/table_reader.hpp"
#include "core/geometry/alignment.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace atrium::config {
namespace {

constexpr double kMaxRotationError =
    1e-3;  // largest |R^T R - 1|: calibration files have 4 to 12 digits
constexpr std::size_t kMaxCameras = 64;
constexpr double kFarthest_m = 1e4;
constexpr double kMinExtent_m = 0.01;  // of the bounds
constexpr Range kFocal_px{kMinFocal_px, kMaxFocal_px};

struct Unit {
    const char* name;
    double metres;
};
constexpr std::array<Unit, 5> kUnits{
    {{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}};

double read_unit(TableReader& reader) {
    std::string name = kUnits.front().name;
    std::vector<std::string> names;
    for (const Unit& unit : kUnits) names.emplace_back(unit.name);
    reader.read("units", name, names);
    const auto found =
        std::ranges::find_if(kUnits, [&](const Unit& unit) { return unit.name == name; });
    return found == kUnits.end() ? 1.0 : found->metres;
}

// Reads three lengths in the unit of the file.
void read_lengths(TableReader& table, const char* key, double unit_m, Eigen::Vector3d& value_m) {
    Eigen::Vector3d number = value_m / unit_m;
    table.read(key, number.data(), 3);
    value_m = number * unit_m;
    if (value_m.cwiseAbs().maxCoeff() <= kFarthest_m) return;
    table.reject(key,
                 fmt::format("must be within {} m, got {:g} m; if the numbers are millimetres, "
                             "write units = \"mm\" at the top of the file",
                             kFarthest_m,
                             value_m.cwiseAbs().maxCoeff()));
}

// The rotation nearest to `m`; nullopt if `m` is not a right-handed rotation within
// kMaxRotationError.
std::optional<Eigen::Quaterniond> nearest_rotation(const Eigen::Matrix3d& m) {
    if (!m.allFinite()) return std::nullopt;
    const double error = (m.transpose() * m - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(error < kMaxRotationError) || !(m.determinant() > 0.0)) return std::nullopt;
    return Eigen::Quaterniond(geometry::rotation_of(m)).normalized();
}

geometry::CalibratedCamera read_camera(TableReader& table, double unit_m) {
    geometry::CalibratedCamera camera;
    for (const char* key :
         {"name", "width", "height", "fx", "fy", "cx", "cy", "rotation", "translation"}) {
        table.require(key);
    }
    table.read("name", camera.name);
    if (!is_valid_name(camera.name))
        table.reject("name", "must be 1 to 63 characters of A-Z a-z 0-9 _ . -");
    geometry::PinholeCamera& k = camera.intrinsics;
    table.read("width", k.width, {16, 8192});
    table.read("height", k.height, {16, 8192});
    table.read("fx", k.fx, kFocal_px);
    table.read("fy", k.fy, kFocal_px);
    table.read("cx", k.cx, {-1e6, 1e6});
    table.read("cy", k.cy, {-1e6, 1e6});
    table.read("skew", k.skew, {-1e4, 1e4});
    table.read("distortion", k.distortion.data(), k.distortion.size(), {-100, 100});
    std::array<double, 9> r{1, 0, 0, 0, 1, 0, 0, 0, 1};
    table.read("rotation", r.data(), r.size());
    const Eigen::Matrix3d matrix =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data());
    if (const auto rotation = nearest_rotation(matrix)) {
        camera.camera_from_site.rotation = *rotation;
    } else {
        table.reject(
            "rotation",
            fmt::format("camera '{}': must be a right-handed rotation matrix (orthonormal to {}; "
                        "determinant here: {:.6g})",
                        camera.name,
                        kMaxRotationError,
                        matrix.determinant()));
    }
    read_lengths(table, "translation", unit_m, camera.camera_from_site.translation);
    return camera;
}

// A person-sized box around the point nearest to all optical axes, down to the floor.
geometry::Aabb default_bounds(const std::vector<geometry::CalibratedCamera>& cameras) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * 1e-6;
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const auto& camera : cameras) {
        const Eigen::Vector3d axis =
            camera.camera_from_site.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        const Eigen::Matrix3d off_axis = Eigen::Matrix3d::Identity() - axis * axis.transpose();
        a += off_axis;
        b += off_axis * camera.centre_site();
    }
    const Eigen::Vector3d centre = a.inverse() * b;
    geometry::Aabb box;
    box.min = {centre.x() - 1.0, centre.y() - 1.0, std::min(0.0, centre.z() - 1.0)};
    box.max = {centre.x() + 1.0, centre.y() + 1.0, std::max(2.3, centre.z() + 1.0)};
    return box;
}

// The error if `path` cannot be a rig or recording, because it is of another tool.
std::optional<Error> find_foreign(const std::filesystem::path& path) {
    std::error_code failure;
    if (std::filesystem::is_directory(path, failure) &&
        !std::filesystem::exists(path / "rig.toml", failure)) {
        return Error{
            ErrorKind::kNotFound,
            fmt::format(
                "{}: this folder has no rig.toml, so it is no recording of Atrium; pictures of "
                "another tool become one with `calibrate import CALIBRATION --recording '{}' -o "
                "NEW_FOLDER`",
                path.string(),
                path.string())};
    }
    constexpr std::array kForeign{".yml", ".yaml", ".json", ".xml", ".txt", ".xcp"};
    if (std::ranges::find(kForeign, path.extension()) == kForeign.end()) return std::nullopt;
    return Error{ErrorKind::kConfiguration,
                 fmt::format("{}: a rig is a .toml file; the calibration of another tool becomes "
                             "one with `calibrate import '{}' -o rig.toml`",
                             path.string(),
                             path.string())};
}

}  // namespace

std::uint64_t fingerprint(const Rig& rig) {
    Fnv1a hash;
    for (const geometry::CalibratedCamera& camera : rig.cameras) {
        const geometry::PinholeCamera& lens = camera.intrinsics;
        hash.add(camera.name);
        hash.add(static_cast<std::uint64_t>(lens.width));
        hash.add(static_cast<std::uint64_t>(lens.height));
        for (const double value : {lens.fx, lens.fy, lens.cx, lens.cy, lens.skew})
            hash.add_rounded(value);
        for (const double value : lens.distortion) hash.add_rounded(value);
        for (const double value : camera.camera_from_site.rotation.coeffs())
            hash.add_rounded(value);
        for (const double value : camera.camera_from_site.translation) hash.add_rounded(value);
    }
    return hash.value();
}

Expected<Rig> load_rig(const std::filesystem::path& path) {
    if (auto foreign = find_foreign(path)) return tl::unexpected(std::move(*foreign));
    std::error_code failure;
    const bool is_folder = std::filesystem::is_directory(path, failure);
    auto reader = TableReader::load(is_folder ? path / "rig.toml" : path);
    if (!reader) return tl::unexpected(reader.error());

    Rig rig;
    rig.unit_m = read_unit(*reader);
    reader->read("rate_hz", rig.rate_hz, {0.1, 1000});
    reader->require("camera");
    for (TableReader& table : reader->tables("camera")) {
        geometry::CalibratedCamera camera = read_camera(table, rig.unit_m);
        const bool taken =
            std::any_of(rig.cameras.begin(), rig.cameras.end(), [&](const auto& other) {
                return other.name == camera.name;
            });
        if (taken) table.reject("name", "must be different for every camera");
        rig.cameras.push_back(std::move(camera));
    }
    if (rig.cameras.size() < 2 || rig.cameras.size() > kMaxCameras) {
        reader->reject(
            "camera",
            fmt::format("must have 2 to {} cameras, has {}", kMaxCameras, rig.cameras.size()));
    }
    if (reader->has("bounds")) {
        TableReader bounds = reader->table("bounds");
        bounds.require("min");
        bounds.require("max");
        rig.bounds_site = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()};
        read_lengths(bounds, "min", rig.unit_m, rig.bounds_site.min);
        read_lengths(bounds, "max", rig.unit_m, rig.bounds_site.max);
        if (!(rig.bounds_site.size().array() >= kMinExtent_m).all()) {
            bounds.reject(
                "max", fmt::format("must be larger than min by {} m in x, y and z", kMinExtent_m));
        }
        rig.has_bounds = true;
    } else if (rig.cameras.size() >= 2) {
        rig.bounds_site = default_bounds(rig.cameras);
    }
    if (auto finished = reader->finish(); !finished) return tl::unexpected(finished.error());
    return rig;
}

}  // namespace atrium::config
