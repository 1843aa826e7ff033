#include "core/recording/view_path.hpp"

#include "core/base/text_file.hpp"
#include "core/base/write_check.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <optional>

namespace atrium::recording {
namespace {

using Json = nlohmann::json;
using std::chrono::nanoseconds;

constexpr double kLongest_s = 1e6;
constexpr double kFarthest_m = 1e5;
constexpr nanoseconds kSameTime = std::chrono::milliseconds(10);
constexpr std::size_t kMaxKeys = 100'000;

double seconds(nanoseconds time) { return std::chrono::duration<double>(time).count(); }

std::optional<double> number(const Json& key, const char* name, double low, double high) {
    const auto found = key.find(name);
    if (found == key.end() || !found->is_number()) return std::nullopt;
    const double value = found->get<double>();
    if (!(value >= low && value <= high)) return std::nullopt;
    return value;
}

std::optional<Eigen::Vector3d> point(const Json& key, const char* name) {
    const auto found = key.find(name);
    if (found == key.end() || !found->is_array() || found->size() != 3) return std::nullopt;
    Eigen::Vector3d p;
    for (Eigen::Index i = 0; i < 3; ++i) {
        const Json& value = (*found)[static_cast<std::size_t>(i)];
        if (!value.is_number()) return std::nullopt;
        p[i] = value.get<double>();
    }
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest_m) return std::nullopt;
    return p;
}

// What is wrong with a key; empty: nothing, and `out` is filled.
std::string read_key(const Json& json, ViewKey& out) {
    if (!json.is_object()) return "must be an object";
    const auto time = number(json, "time_s", 0.0, kLongest_s);
    if (!time) return fmt::format("time_s: must be a number in [0, {:g}]", kLongest_s);
    const auto position = point(json, "position_m");
    if (!position) return "position_m: must be three numbers [x, y, z] in metres";
    const auto target = point(json, "target_m");
    if (!target) return "target_m: must be three numbers [x, y, z] in metres";
    if ((*position - *target).norm() < 1e-3) return "target_m: must differ from position_m";
    const auto fov = json.contains("fov_deg") ? number(json, "fov_deg", 1.0, 150.0)
                                              : std::optional(ViewKey().fov_deg);
    if (!fov) return "fov_deg: must be a number in [1, 150]";
    out = {nanoseconds(std::llround(*time * 1e9)), *position, *target, *fov};
    return {};
}

// Catmull-Rom with the tangents of uneven times.
template <typename T>
T between(const T& a, const T& b, const T& tangent_a, const T& tangent_b, double t) {
    const double t2 = t * t;
    const double t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * tangent_a + (3 * t2 - 2 * t3) * b +
           (t3 - t2) * tangent_b;
}

}  // namespace

Expected<ViewPath> ViewPath::load(const std::filesystem::path& file) {
    const auto text = read_text_file(file);
    if (!text) return tl::unexpected(text.error());
    const auto wrong = [&](const std::string& what) {
        return make_error(ErrorKind::kConfiguration, fmt::format("{}: {}", file.string(), what));
    };
    const Json json = Json::parse(*text, nullptr, /*allow_exceptions=*/false);
    if (!json.is_object() || !json.contains("keys") || !json["keys"].is_array())
        return wrong(
            "a camera path is JSON with \"keys\": [{\"time_s\", \"position_m\", "
            "\"target_m\", \"fov_deg\"}, ...]");
    if (json["keys"].empty()) return wrong("keys: there is none");
    if (json["keys"].size() > kMaxKeys) return wrong("keys: there are too many");
    ViewPath path;
    for (const Json& one : json["keys"]) {
        ViewKey key;
        if (const std::string fault = read_key(one, key); !fault.empty())
            return wrong(fmt::format("keys[{}].{}", path.keys_.size(), fault));
        if (!path.keys_.empty() && key.time <= path.keys_.back().time)
            return wrong(fmt::format("keys[{}].time_s: must be later than that of the key before",
                                     path.keys_.size()));
        path.keys_.push_back(key);
    }
    return path;
}

Expected<void> ViewPath::save(const std::filesystem::path& file) const {
    Json keys = Json::array();
    const auto list = [](const Eigen::Vector3d& p) { return Json{p.x(), p.y(), p.z()}; };
    for (const ViewKey& key : keys_) {
        keys.push_back({{"time_s", seconds(key.time)},
                        {"position_m", list(key.position_m)},
                        {"target_m", list(key.target_m)},
                        {"fov_deg", key.fov_deg}});
    }
    std::ofstream out(file);
    out << Json{{"keys", keys}}.dump(2) << '\n';
    out.close();
    if (!out) return tl::unexpected(cannot_write(file, "write it", errno));
    return {};
}

void ViewPath::add(const ViewKey& key) {
    const auto same = std::ranges::find_if(keys_, [&](const ViewKey& one) {
        return std::chrono::abs(one.time - key.time) < kSameTime;
    });
    if (same != keys_.end()) {
        *same = key;
        return;
    }
    keys_.insert(std::ranges::upper_bound(keys_, key.time, {}, &ViewKey::time), key);
}

std::size_t ViewPath::number_at(nanoseconds time) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(keys_, time, {}, &ViewKey::time) -
                                    keys_.begin());
}

ViewKey ViewPath::at(nanoseconds time) const {
    const auto after = std::ranges::upper_bound(keys_, time, {}, &ViewKey::time);
    ViewKey key;
    if (after == keys_.begin()) {
        key = keys_.front();
    } else if (after == keys_.end()) {
        key = keys_.back();
    } else {
        const auto i = static_cast<std::size_t>(after - keys_.begin());
        const ViewKey& a = keys_[i - 1];
        const ViewKey& b = keys_[i];
        const ViewKey& before = keys_[i >= 2 ? i - 2 : 0];
        const ViewKey& behind = keys_[std::min(i + 1, keys_.size() - 1)];
        const double length = seconds(b.time - a.time);
        const double t = seconds(time - a.time) / length;
        const double scale_a = length / seconds(b.time - before.time);
        const double scale_b = length / seconds(behind.time - a.time);
        const auto mix = [&](auto value) {
            return between(value(a),
                           value(b),
                           decltype(value(a))(scale_a * (value(b) - value(before))),
                           decltype(value(a))(scale_b * (value(behind) - value(a))),
                           t);
        };
        key.position_m = mix([](const ViewKey& one) -> Eigen::Vector3d { return one.position_m; });
        key.target_m = mix([](const ViewKey& one) -> Eigen::Vector3d { return one.target_m; });
        key.fov_deg = a.fov_deg + t * (b.fov_deg - a.fov_deg);
        // keys may differ so that the way between them leads through the target
        if ((key.position_m - key.target_m).norm() < 1e-3) key.target_m = b.target_m;
    }
    key.time = time;
    return key;
}

}  // namespace atrium::recording
