#include "tools/visual_hull/judgement.hpp"

#include "core/geometry/triangle_mesh.hpp"
#include "site_node/rig_check/bounds_check.hpp"
#include "site_node/rig_check/diagnosis.hpp"
#include "site_node/rig_check/hull_size.hpp"
#include "site_node/rig_check/rig_geometry.hpp"

#include <fmt/format.h>

namespace atrium::hull_tool {
namespace {

constexpr std::size_t kCutPart = 20;  // bounds that cut a smaller part are meant to

}  // namespace

Expected<config::Rig> load_checked_rig(const std::filesystem::path& recording,
                                       std::vector<std::string>& warnings) {
    auto rig = config::load_rig(recording);
    if (!rig) return rig;
    for (const rig_check::Finding& finding : rig_check::check_rig(rig->cameras, rig->unit_m)) {
        std::string text = (recording / "rig.toml").string() + ": " + finding.text;
        if (finding.is_error) return make_error(ErrorKind::kConfiguration, std::move(text));
        warnings.push_back(std::move(text));
    }
    if (rig->has_bounds) {
        if (const auto doubt = rig_check::check_bounds(rig->bounds_site, rig->cameras, rig->unit_m))
            warnings.push_back((recording / "rig.toml").string() + ": " + doubt->text);
    }
    return rig;
}

std::vector<std::string> judge_cameras(std::span<const views::NamedView> views) {
    std::vector<geometry::CalibratedCamera> cameras;
    for (const views::NamedView& view : views)
        cameras.push_back({view.name, view.view.intrinsics, view.view.camera_from_site});
    std::vector<std::string> warnings;
    if (cameras.size() < 2) return warnings;
    for (rig_check::Finding& finding : rig_check::check_rig(cameras))
        warnings.push_back(std::move(finding.text));
    return warnings;
}

std::vector<std::string> judge_hull(std::span<const views::NamedView> views,
                                    const hull::VisualHull& hull,
                                    const std::optional<geometry::Aabb>& bounds,
                                    bool partial) {
    rig_check::AgreementOptions options;
    options.knows_outside = !partial;
    options.bounds = bounds;
    const rig_check::Agreement agreement = rig_check::measure_agreement(views, options);
    std::vector<std::string> warnings;
    if (const auto diagnosis = rig_check::diagnose(views, options)) {
        warnings.push_back(fmt::format("{:.0f} % of the silhouettes fit together: {}",
                                       100.0 * diagnosis->share,
                                       diagnosis->text));
    }
    std::size_t cut = 0;
    for (const rig_check::CameraAgreement& camera : agreement.cameras) cut += camera.cut;
    if (const std::size_t all = agreement.num_rays(); cut > 0 && cut * kCutPart > all) {
        warnings.push_back(
            fmt::format("the bounds cut away {:.0f} % of the silhouettes",
                        100.0 * static_cast<double>(cut) / static_cast<double>(all)));
    }
    if (hull.status != hull::HullStatus::kOk) return warnings;
    if (auto wrong = rig_check::check_size(
            geometry::bounds(hull.mesh), geometry::volume_m3(hull.mesh), agreement.share()))
        warnings.push_back(std::move(*wrong));
    return warnings;
}

}  // namespace atrium::hull_tool
