#include "site_node/views/views_file.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::views {
namespace {

using nlohmann::json;

// Coverage takes four bytes per pixel. 8192 x 8192, the largest picture of a rig.
constexpr std::int64_t kMaxPixels = 67'108'864;
constexpr double kMaxRotationError = 1e-3;  // allows for matrices typed with few digits

// Error of one value; the caller adds the file.
struct BadValue {
    std::string message;
};

// Rejects keys that nothing reads, for example `distortion`.
void refuse_unknown(const json& object,
                    const std::string& where,
                    std::initializer_list<std::string_view> known) {
    for (const auto& [key, value] : object.items()) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        std::string list;
        for (const std::string_view name : known)
            list.append(list.empty() ? "" : ", ").append(name);
        throw BadValue{where + ": unknown key \"" + key + "\"; known here: " + list};
    }
}

// Rejects repeated keys, of which JSON parsers silently take one.
class RepeatedKeys {
public:
    bool operator()(int, json::parse_event_t event, const json& parsed) {
        if (event == json::parse_event_t::object_start) {
            keys_.emplace_back();
        } else if (event == json::parse_event_t::object_end) {
            keys_.pop_back();
            if (keys_.size() == 1) ++num_views_;
        } else if (event == json::parse_event_t::key &&
                   !keys_.back().insert(parsed.get<std::string>()).second) {
            const std::string where =
                keys_.size() > 1 ? "views[" + std::to_string(num_views_) + "]" : "document";
            throw BadValue{where + ": key " + parsed.dump() + " is repeated"};
        }
        return true;
    }

private:
    std::vector<std::set<std::string>> keys_;  // of the enclosing objects
    std::size_t num_views_ = 0;                // complete ones
};

const json& member(const json& object, const std::string& where, const char* key) {
    const auto it = object.find(key);
    if (it == object.end()) throw BadValue{where + ": key \"" + key + "\" is missing"};
    return *it;
}

double number(const json& value, const std::string& where) {
    if (!value.is_number()) throw BadValue{where + ": must be a number"};
    const double v = value.get<double>();
    if (!std::isfinite(v)) throw BadValue{where + ": must be finite"};
    // pixels and metres of any room; larger values would lose all sub-pixel digits in products
    constexpr double kMax = 1e6;
    if (std::abs(v) > kMax) throw BadValue{where + ": must be between -1e6 and 1e6"};
    return v;
}

double number_at(const json& object, const std::string& where, const char* key) {
    return number(member(object, where, key), where + "." + key);
}

double positive_at(const json& object, const std::string& where, const char* key) {
    const double v = number_at(object, where, key);
    if (v <= 0.0) throw BadValue{where + "." + key + ": must be positive"};
    return v;
}

int size_at(const json& object, const std::string& where, const char* key) {
    constexpr int kMaxSize_px = 32768;
    const json& value = member(object, where, key);
    const bool fits = value.is_number_integer() && value.get<std::int64_t>() >= 1 &&
                      value.get<std::int64_t>() <= kMaxSize_px;
    if (!fits) throw BadValue{where + "." + key + ": must be an integer in [1, 32768]"};
    return value.get<int>();
}

std::vector<double> numbers_at(const json& object,
                               const std::string& where,
                               const char* key,
                               std::size_t count) {
    const json& value = member(object, where, key);
    const std::string here = where + "." + key;
    if (!value.is_array() || value.size() != count) {
        throw BadValue{here + ": must be a list of " + std::to_string(count) + " numbers"};
    }
    std::vector<double> out;
    for (const json& v : value) out.push_back(number(v, here));
    return out;
}

geometry::RigidTransform read_pose(const json& object, const std::string& where) {
    const std::vector<double> r = numbers_at(object, where, "rotation", 9);
    const std::vector<double> t = numbers_at(object, where, "translation", 3);
    Eigen::Matrix3d rotation;
    rotation << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
    const double error =
        (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(error < kMaxRotationError) || rotation.determinant() <= 0.0) {
        throw BadValue{where + ".rotation: must be a rotation matrix, row by row"};
    }
    return {Eigen::Quaterniond(rotation).normalized(), {t[0], t[1], t[2]}};
}

std::vector<Eigen::Vector2d> read_contour(const json& value, const std::string& where) {
    if (!value.is_array() || value.size() < 3)
        throw BadValue{where + ": must be a list of at least 3 points"};
    std::vector<Eigen::Vector2d> contour;
    contour.reserve(value.size());
    for (const json& point : value) {
        const std::string here = where + "[" + std::to_string(contour.size()) + "]";
        if (!point.is_array() || point.size() != 2) throw BadValue{here + ": must be [x, y]"};
        contour.emplace_back(number(point[0], here), number(point[1], here));
    }
    return contour;
}

NamedView read_view(const json& object, std::size_t index) {
    std::string where = "views[" + std::to_string(index) + "]";
    if (!object.is_object()) throw BadValue{where + ": must be an object"};
    NamedView out;
    refuse_unknown(object,
                   where,
                   {"name",
                    "width",
                    "height",
                    "fx",
                    "fy",
                    "cx",
                    "cy",
                    "skew",
                    "rotation",
                    "translation",
                    "contours"});
    const json& name = member(object, where, "name");
    if (!name.is_string()) throw BadValue{where + ".name: must be text"};
    out.name = name.get<std::string>();
    where = "view \"" + out.name + "\"";
    geometry::PinholeCamera& camera = out.view.intrinsics;
    camera.width = size_at(object, where, "width");
    camera.height = size_at(object, where, "height");
    if (std::int64_t{camera.width} * camera.height > kMaxPixels) {
        throw BadValue{where + ": width times height must be at most " +
                       std::to_string(kMaxPixels)};
    }
    camera.fx = positive_at(object, where, "fx");
    camera.fy = positive_at(object, where, "fy");
    camera.cx = number_at(object, where, "cx");
    camera.cy = number_at(object, where, "cy");
    if (object.contains("skew")) camera.skew = number_at(object, where, "skew");
    out.view.camera_from_site = read_pose(object, where);
    const json& contours = member(object, where, "contours");
    if (!contours.is_array()) throw BadValue{where + ".contours: must be a list of polygons"};
    for (const json& contour : contours) {
        const std::string here =
            where + ".contours[" + std::to_string(out.view.contours.size()) + "]";
        out.view.contours.push_back(read_contour(contour, here));
    }
    return out;
}

std::vector<NamedView> read_views(const json& document) {
    if (!document.is_object()) throw BadValue{"must be a JSON object"};
    refuse_unknown(document, "document", {"views"});
    const json& list = member(document, "document", "views");
    if (!list.is_array()) throw BadValue{"views: must be a list"};
    std::vector<NamedView> views;
    std::set<std::string> names;
    for (const json& object : list) {
        views.push_back(read_view(object, views.size()));
        if (!names.insert(views.back().name).second) {
            throw BadValue{"view \"" + views.back().name + "\": the name is used twice"};
        }
    }
    return views;
}

}  // namespace

Expected<std::vector<NamedView>> load_views_file(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file || std::filesystem::is_directory(path)) {
        return make_error(ErrorKind::kNotFound, path.string() + ": cannot be read");
    }
    try {
        return read_views(json::parse(file, RepeatedKeys()));
    } catch (const BadValue& bad) {
        return make_error(ErrorKind::kConfiguration, path.string() + ": " + bad.message);
    } catch (const json::exception& error) {
        return make_error(ErrorKind::kConfiguration, path.string() + ": " + error.what());
    }
}

Expected<void> save_views_file(const std::vector<NamedView>& views,
                               const std::filesystem::path& path) {
    json list = json::array();
    for (const NamedView& named : views) {
        const geometry::PinholeCamera& camera = named.view.intrinsics;
        const Eigen::Matrix3d r = named.view.camera_from_site.rotation.toRotationMatrix();
        const Eigen::Vector3d& t = named.view.camera_from_site.translation;
        json view{{"name", named.name},
                  {"width", camera.width},
                  {"height", camera.height},
                  {"fx", camera.fx},
                  {"fy", camera.fy},
                  {"cx", camera.cx},
                  {"cy", camera.cy}};
        if (camera.skew != 0.0) view["skew"] = camera.skew;
        view["rotation"] = {
            r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)};
        view["translation"] = {t.x(), t.y(), t.z()};
        view["contours"] = json::array();
        for (const auto& contour : named.view.contours) {
            json points = json::array();
            for (const Eigen::Vector2d& point : contour)
                points.push_back(json::array({point.x(), point.y()}));
            view["contours"].push_back(std::move(points));
        }
        list.push_back(std::move(view));
    }
    std::ofstream file(path);
    file << json{{"views", std::move(list)}}.dump() << '\n';
    file.close();
    if (!file) return make_error(ErrorKind::kUnavailable, path.string() + ": cannot be written");
    return {};
}

}  // namespace atrium::views
