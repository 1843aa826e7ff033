#include "tests/fuzz/file_check.hpp"

#include "core/bus/qos_profiles.hpp"
#include "core/config/rig.hpp"
#include "site_node/segmentation/background_file.hpp"
#include "site_node/views/views_file.hpp"
#include "tests/fuzz/file_folder.hpp"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

namespace atrium::test {
namespace {

namespace fs = std::filesystem;

std::string refusal(const Error& error, ErrorKind expected, const std::string& must_name) {
    if (error.kind != expected) return "another kind of error";
    return error.message.find(must_name) == std::string::npos ? "an error without the file" : "";
}

bool is_sound(const geometry::CalibratedCamera& camera) {
    const geometry::PinholeCamera& intrinsics = camera.intrinsics;
    return config::is_valid_name(camera.name) && intrinsics.width >= 16 &&
           intrinsics.width <= 8192 && intrinsics.height >= 16 && intrinsics.height <= 8192 &&
           intrinsics.fx > 0.0 && intrinsics.fy > 0.0 && std::isfinite(intrinsics.fx) &&
           std::isfinite(intrinsics.fy) &&
           std::abs(camera.camera_from_site.rotation.norm() - 1.0) < 1e-12 &&
           camera.camera_from_site.translation.allFinite();
}

bool same(const views::NamedView& a, const views::NamedView& b) {
    const geometry::PinholeCamera& p = a.view.intrinsics;
    const geometry::PinholeCamera& q = b.view.intrinsics;
    return a.name == b.name && p.width == q.width && p.height == q.height && p.fx == q.fx &&
           p.fy == q.fy && p.cx == q.cx && p.cy == q.cy && p.skew == q.skew &&
           a.view.contours == b.view.contours &&
           a.view.camera_from_site.translation == b.view.camera_from_site.translation &&
           a.view.camera_from_site.rotation.angularDistance(b.view.camera_from_site.rotation) <
               1e-6;
}

// FNV-1a, which background_file.hpp does not document. If it changes, no seed is accepted any more.
std::uint64_t checksum(std::span<const std::uint8_t> bytes) {
    std::uint64_t hash = 14695981039346656037ULL;
    for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211ULL;
    return hash;
}

}  // namespace

std::string check_rig_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    const fs::path file = folder().write("rig.toml", bytes);
    const auto rig = config::load_rig(file);
    was_accepted = rig.has_value();
    if (!rig) return refusal(rig.error(), ErrorKind::kConfiguration, "rig.toml");
    if (rig->cameras.size() < 2 || rig->cameras.size() > 64) return "a number of cameras";
    for (const geometry::CalibratedCamera& camera : rig->cameras) {
        if (!is_sound(camera)) return "a camera";
    }
    if (!(rig->rate_hz >= 0.1 && rig->rate_hz <= 1000.0)) return "a rate";
    const geometry::Aabb& bounds = rig->bounds_site;
    if (!bounds.min.allFinite() || !bounds.max.allFinite() || bounds.empty()) return "the bounds";
    return "";
}

std::string check_views_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    const auto views = views::load_views_file(folder().write("views.json", bytes));
    was_accepted = views.has_value();
    if (!views) return refusal(views.error(), ErrorKind::kConfiguration, "views.json");
    for (const views::NamedView& named : *views) {
        if (!(std::abs(named.view.camera_from_site.rotation.norm() - 1.0) < 1e-12))
            return "a rotation";
        for (const auto& contour : named.view.contours) {
            if (contour.size() < 3) return "a contour";
            for (const Eigen::Vector2d& point : contour) {
                if (!point.allFinite()) return "a point";
            }
        }
    }
    const fs::path copy = folder().path() / "copy.json";
    if (!views::save_views_file(*views, copy)) return "cannot be written again";
    const auto again = views::load_views_file(copy);
    if (!again) return "refuses what it accepted: " + again.error().message;
    return std::equal(views->begin(), views->end(), again->begin(), again->end(), same)
               ? ""
               : "other views on the way back";
}

std::string check_profiles_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto profiles = bus::parse_qos_profiles(text, "file.xml");
    was_accepted = profiles.has_value();
    if (!profiles) return refusal(profiles.error(), ErrorKind::kConfiguration, "file.xml");
    if (!bus::check_compatible(*profiles, "file.xml")) return "a profile that does not fit itself";
    for (const auto& [name, profile] : *profiles) {
        for (const bus::EndpointQos& qos : {profile.writer, profile.reader}) {
            for (const auto duration :
                 {qos.max_blocking_time, qos.lease, qos.deadline, qos.latency_budget, qos.lifespan})
                if (duration.count() < 0) return "a duration";
            if (!qos.history.keep_all && qos.history.depth < 1) return "a depth";
        }
    }
    return "";
}

std::string check_background_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    was_accepted = false;
    if (bytes.empty()) return "";
    std::vector<std::uint8_t> file(bytes.begin() + 1, bytes.end());
    if (bytes[0] % 2 == 1 && file.size() >= sizeof(std::uint64_t)) {
        const std::size_t size = file.size() - sizeof(std::uint64_t);
        const std::uint64_t sum = checksum({file.data(), size});
        std::memcpy(file.data() + size, &sum, sizeof(sum));
    }
    folder().write("c.background", file);
    const auto room = segmentation::load_background(folder().path(), "c");
    was_accepted = room.has_value();
    if (!room) return refusal(room.error(), ErrorKind::kInvalidData, "c.background");
    if (room->width < 2 || room->height < 2 || room->width % 2 != 0 || room->height % 2 != 0)
        return "a size";
    const std::size_t num_pixels =
        static_cast<std::size_t>(room->width) * static_cast<std::size_t>(room->height);
    if (room->luma.size() != num_pixels || room->luma_sigma.size() != num_pixels)
        return "a plane's size";
    for (const auto* plane : {&room->u, &room->v, &room->uu, &room->uv, &room->vv}) {
        if (plane->size() != num_pixels / 4) return "a plane's size";
    }
    if (!segmentation::save_background(*room, folder().path(), "c")) return "cannot be written";
    std::ifstream stream(folder().path() / "c.background", std::ios::binary);
    const std::vector<std::uint8_t> again{std::istreambuf_iterator<char>(stream), {}};
    return again == file ? "" : "is written in another way again";
}

}  // namespace atrium::test
