#include "world_server/description/shared_entries.hpp"

#include "core/base/readable.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "core/config/spelling.hpp"
#include "core/geometry/roll_pitch_yaw.hpp"
#include "core/model/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <system_error>

namespace atrium::world_server {
namespace {

std::string file_names(const config::TableReader& reader) {
    return fmt::format(
        "must be at most 127 characters of A-Z a-z 0-9 _ . - / and lie in or below the folder of "
        "models, {} (world.models)",
        reader.folder().empty() ? "." : reader.folder().lexically_normal().string());
}

bool is_picture_name(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
    });
    return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

// " (did you mean models/chair.obj?)", or nothing.
std::string meant_instead_of(const std::filesystem::path& missing) {
    const std::string question = config::ask_which_path(missing);
    return question.empty() ? question : " (" + question + ")";
}

}  // namespace

std::filesystem::path file_of(const config::TableReader& reader, const std::string& name) {
    return (reader.folder() / name).lexically_normal();
}

void read_name(config::TableReader& reader, std::string& name) {
    reader.require("name");
    reader.read("name", name);
    if (!bus::is_valid_name(name))
        reader.reject("name", "must be 1 to 63 characters of A-Z a-z 0-9 _ . -");
}

void read_pose(config::TableReader& reader, geometry::RigidTransform& world_from_object) {
    for (const char* key : {"quaternion", "rotation", "rotation_deg", "orientation"})
        reader.forbid(key, "write roll_pitch_yaw_deg: degrees about x, then y, then z");
    reader.read("position_m", world_from_object.translation.data(), 3, kPositionRange);
    Eigen::Vector3d angles_deg = Eigen::Vector3d::Zero();
    reader.read("roll_pitch_yaw_deg", angles_deg.data(), 3, {-360.0, 360.0});
    world_from_object.rotation = geometry::rotation_of_roll_pitch_yaw(angles_deg);
}

void read_texture(config::TableReader& reader, std::string& texture) {
    std::string file;
    reader.read("texture", file);
    if (file.empty()) return;
    if (!bus::is_valid_model_file(file)) return reader.reject("texture", file_names(reader));
    if (!is_picture_name(file)) return reader.reject("texture", "must be a .png, .jpg or .jpeg");
    const std::filesystem::path path = file_of(reader, file);
    if (const auto readable = check_readable(path); !readable) {
        Error error = readable.error();
        if (error.kind == ErrorKind::kNotFound) error.message += meant_instead_of(path);
        return reader.reject("texture", std::move(error));
    }
    texture = file;
}

void read_colour(config::TableReader& reader,
                 const std::string& texture,
                 std::vector<Eigen::Vector3d>& own_colours,
                 Eigen::Vector3d& colour) {
    reader.read("colour", colour.data(), 3, {0.0, 1.0});
    if (reader.has("colour") || !texture.empty()) own_colours.clear();
    if (own_colours.size() == 1 && !reader.has("material")) colour = own_colours.front();
}

void reject_model(config::TableReader& reader, Error error) {
    std::string file;
    reader.read("model", file);
    if (error.kind == ErrorKind::kNotFound)
        error.message += meant_instead_of(file_of(reader, file));
    reader.reject("model", error);
}

bool read_model_name(config::TableReader& reader, std::string& model, double& scale) {
    reader.require("model");
    std::string file;
    reader.read("model", file);
    reader.read("scale", scale, {1e-4, bus::kMaxModelScale});
    if (file.empty()) return false;
    if (!bus::is_valid_model_file(file)) {
        reader.reject("model", file_names(reader));
        return false;
    }
    if (!model::is_model_name(file)) {
        reader.reject(
            "model",
            fmt::format("must be a {} file; export it as .glb in the program that made it",
                        model::model_endings()));
        return false;
    }
    model = file;
    return true;
}

std::string size_advice(const Eigen::Vector3d& size_m) {
    return fmt::format(
        "the model is {:.3g} x {:.3g} x {:.3g} m (scale = 0.01 reads centimetres, "
        "0.001 millimetres)",
        size_m.x(),
        size_m.y(),
        size_m.z());
}

std::string ask_unit(const Eigen::Vector3d& size_m,
                     const std::function<bool(const Eigen::Vector3d& size_m)>& allows) {
    const bool may_be_cm = allows(size_m / 100.0);
    const bool may_be_mm = allows(size_m / 1000.0);
    if (may_be_cm && may_be_mm)
        return "; are these centimetres or millimetres? Divide by 100 or 1000";
    if (may_be_cm) return "; are these centimetres? Divide by 100";
    return may_be_mm ? "; are these millimetres? Divide by 1000" : "";
}

std::string mass_advice(double volume_m3, double mass_kg) {
    const std::string mass =
        mass_kg < 1000.0 ? fmt::format("{:.3g}", mass_kg) : fmt::format("{:.0f}", mass_kg);
    return fmt::format("; its volume of {:.3g} m^3 gives {} kg: write mass_kg", volume_m3, mass);
}

const WorldObject* find_object(const std::vector<WorldObject>& objects, const std::string& name) {
    const auto found = std::ranges::find(objects, name, &WorldObject::name);
    return found == objects.end() ? nullptr : &*found;
}

std::string object_meant_by(const std::string& written, const std::vector<WorldObject>& objects) {
    std::vector<std::string> names;
    for (const WorldObject& object : objects) names.push_back(object.name);
    const std::string question = config::ask_which(config::names_meant_by(written, names));
    return question.empty() ? question : " (" + question + ")";
}

}  // namespace atrium::world_server
