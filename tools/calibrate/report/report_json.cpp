#include "core/base/write_check.hpp"
#include "tools/calibrate/formats/rig_file.hpp"
#include "tools/calibrate/report/report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace atrium::calibrate {
namespace {

using Json = nlohmann::ordered_json;

Json list_of(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json json_of(const ReportedCamera& one) {
    const geometry::PinholeCamera& lens = one.camera.intrinsics;
    const geometry::RigidTransform site_from_camera = one.camera.camera_from_site.inverse();
    const Eigen::Quaterniond& q = site_from_camera.rotation;
    return Json{{"name", one.camera.name},
                {"width", lens.width},
                {"height", lens.height},
                {"fx", lens.fx},
                {"fy", lens.fy},
                {"cx", lens.cx},
                {"cy", lens.cy},
                {"distortion", lens.distortion},
                {"centre_site_m", list_of(site_from_camera.translation)},
                {"site_from_camera_xyzw", Json::array({q.x(), q.y(), q.z(), q.w()})},
                {"held_out_px", one.held_out_px},
                {"rms_px", one.rms_px},
                {"middle_mm", one.middle_mm},
                {"coverage", one.coverage},
                {"late_instants", one.late_instants},
                {"num_used", one.num_used},
                {"num_outliers", one.num_outliers}};
}

Json json_of(const CalibrationReport& report, const RigComparison& compared) {
    Json moves = Json::array();
    for (const CameraMove& move : compared.moves)
        moves.push_back({{"name", move.name},
                         {"moved_mm", 1000.0 * move.moved_m},
                         {"turned_deg", move.turned_deg},
                         {"focal_ratio", move.focal_ratio},
                         {"stays", move.stays}});
    return Json{{"file", report.previous},
                {"length_ratio", compared.length_ratio},
                {"cameras", moves},
                {"only_in_old", compared.only_in_old},
                {"only_in_new", compared.only_in_new}};
}

}  // namespace

std::string report_json(const CalibrationReport& report) {
    Json json{{"command", report.command},
              {"source", report.source},
              {"date_utc", report.date},
              {"grade",
               report.grade == Grade::kGood     ? "good"
               : report.grade == Grade::kUsable ? "usable"
                                                : "wrong"},
              {"told", report.told},
              {"checks", report.checks},
              {"problems", report.problems},
              {"outcome", report.outcome}};
    Json cameras = Json::array();
    for (const ReportedCamera& one : report.cameras) cameras.push_back(json_of(one));
    json["cameras"] = std::move(cameras);
    json["previous"] = report.comparison ? json_of(report, *report.comparison) : Json(nullptr);
    // names and paths may hold bytes that are no UTF-8
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Expected<void> write_report(const CalibrationReport& report, const std::filesystem::path& file) {
    const std::string page = report_page(report);
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (auto writable = check_folder_writable(folder, page.size(), "--report"); !writable)
        return writable;
    if (auto written = write_text(file, page, true); !written) return written;
    std::filesystem::path json = file;
    return write_text(json.replace_extension(".json"), report_json(report), true);
}

}  // namespace atrium::calibrate
