#include "tools/visual_hull/tool.hpp"

#include "core/base/descriptor.hpp"
#include "core/base/thread_pool.hpp"
#include "core/base/write_check.hpp"
#include "core/config/spelling.hpp"
#include "core/geometry/decimate.hpp"
#include "core/geometry/mesh_file.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/field_of_view.hpp"
#include "site_node/hull/input_limits.hpp"
#include "site_node/silhouette/picture_field.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/views/views_file.hpp"
#include "tools/visual_hull/coverage.hpp"
#include "tools/visual_hull/judgement.hpp"
#include "tools/visual_hull/limits.hpp"
#include "tools/visual_hull/recording_views.hpp"

#include <fcntl.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <new>
#include <optional>
#include <system_error>
#include <vector>

namespace atrium::hull_tool {
namespace {

constexpr std::uint64_t kLeastSpace = 1U << 20;  // a person's mesh is smaller

std::string name_of_input(const ToolOptions& options) {
    if (options.recording.empty()) return options.views_file.string();
    return options.recording.string() + ", frame " + std::to_string(options.frame);
}

// Gives each view a field: that of silhouettes with this tolerance.
Expected<void> add_fields(double tolerance_px, std::vector<views::NamedView>& views) {
    const double inset_px = silhouette::field_inset_px(tolerance_px);
    for (views::NamedView& view : views) {
        auto field = silhouette::picture_field(view.view.intrinsics, inset_px);
        if (!field || !hull::is_usable_field(*field)) {
            return make_error(ErrorKind::kConfiguration,
                              "--partial: view \"" + view.name +
                                  "\": the lens distortion cannot be inverted along the border "
                                  "of its picture");
        }
        view.view.field = std::move(*field);
    }
    return {};
}

Expected<void> remove_views(const std::vector<std::string>& names,
                            std::vector<views::NamedView>& views) {
    for (const std::string& name : names) {
        const auto has_name = [&](const views::NamedView& view) { return view.name == name; };
        if (std::erase_if(views, has_name) > 0) continue;
        if (std::count(names.begin(), names.end(), name) > 1) {
            return make_error(ErrorKind::kConfiguration,
                              "--without: view \"" + name + "\" is named twice");
        }
        std::string known;
        for (const views::NamedView& view : views) known += (known.empty() ? "" : ", ") + view.name;
        return make_error(ErrorKind::kConfiguration,
                          "--without: no view is named \"" + name + "\"; the views are " + known);
    }
    return {};
}

// Loads the views to intersect.
Expected<std::vector<views::NamedView>> load_views(const ToolOptions& options) {
    const auto silhouettes = read_silhouette_options(options.config);
    if (!silhouettes) return tl::unexpected(silhouettes.error());
    auto views = options.recording.empty()
                     ? views::load_views_file(options.views_file)
                     : load_recording_views(options.recording,
                                            static_cast<std::size_t>(options.frame),
                                            options.without,
                                            *silhouettes);
    if (!views) return views;
    if (auto done = remove_views(options.without, *views); !done)
        return tl::unexpected(done.error());
    if (options.min_views > views->size()) {
        return make_error(ErrorKind::kConfiguration,
                          "--min-views: must not exceed the number of views, " +
                              std::to_string(views->size()) + ", got " +
                              std::to_string(options.min_views));
    }
    if (options.partial) {
        if (auto added = add_fields(silhouettes->silhouette.tolerance_px, *views); !added)
            return tl::unexpected(added.error());
    }
    if (auto within = check_limits(*views, options.bounds.has_value()); !within) {
        return make_error(within.error().kind,
                          name_of_input(options) + ": " + within.error().message);
    }
    return views;
}

struct Measured {
    hull::VisualHull hull;
    std::optional<geometry::TriangleMesh> decimated;
    double distance_bound_m = 0.0;
    hull::StageTimes fastest;
    std::vector<double> totals_ms;  // sorted
};

Measured compute(const std::vector<views::NamedView>& views, const ToolOptions& options) {
    std::vector<hull::SilhouetteView> silhouettes;
    for (const views::NamedView& view : views) silhouettes.push_back(view.view);
    hull::HullOptions hull_options;
    hull_options.bounds = options.bounds;
    hull_options.min_views = options.min_views;
    hull_options.keep_phantoms = options.keep_phantoms;
    hull_options.min_component_volume_m3 = 1e-3 * options.min_litres;
    hull::HullScratch scratch;
    ThreadPool pool(static_cast<std::size_t>(options.threads));
    Measured measured;
    for (int i = 0; i < options.repeat; ++i) {
        hull::compute_visual_hull(silhouettes, hull_options, scratch, pool, measured.hull);
        const hull::StageTimes& times = measured.hull.times;
        if (i == 0 || times.total_ms < measured.fastest.total_ms) measured.fastest = times;
        measured.totals_ms.push_back(times.total_ms);
    }
    std::sort(measured.totals_ms.begin(), measured.totals_ms.end());
    return measured;
}

nlohmann::ordered_json report_views(const std::vector<views::NamedView>& views,
                                    const geometry::TriangleMesh& mesh) {
    CoverageScratch scratch;
    auto list = nlohmann::ordered_json::array();
    for (const views::NamedView& view : views) {
        const Coverage coverage = measure_coverage(mesh, view.view, scratch);
        nlohmann::ordered_json entry;
        entry["name"] = view.name;
        entry["coverage"] = nullptr;  // the camera sees nobody: nothing to cover
        if (coverage.silhouette_px > 0) entry["coverage"] = coverage.share();
        entry["excess_px"] = coverage.excess_px;
        list.push_back(entry);
    }
    return list;
}

nlohmann::ordered_json report(const std::vector<views::NamedView>& views,
                              const ToolOptions& options,
                              const std::vector<std::string>& warnings,
                              const Measured& measured) {
    const hull::VisualHull& hull = measured.hull;
    const geometry::MeshReport mesh = geometry::inspect(hull.mesh);
    nlohmann::ordered_json out;
    out["status"] = hull::to_string(hull.status);
    out["vertices"] = hull.mesh.vertices.size();
    out["triangles"] = hull.mesh.triangles.size();
    out["components"] = mesh.num_components;
    out["euler_characteristic"] = mesh.euler_characteristic;
    out["volume_m3"] = mesh.volume_m3;
    out["closed"] = mesh.closed;
    out["manifold"] = mesh.manifold;
    out["phantoms_dropped"] = hull.num_phantoms_dropped;
    out["fragments_dropped"] = hull.num_fragments_dropped;
    out["contours_dropped"] = hull.num_contours_dropped;
    out["contours_repaired"] = hull.num_contours_repaired;
    out["views_merged"] = hull.num_views_merged;
    out["attempts"] = hull.num_attempts;
    if (measured.decimated) {
        out["decimated_triangles"] = measured.decimated->triangles.size();
        out["distance_bound_mm"] = 1e3 * measured.distance_bound_m;
    }
    if (!options.without.empty()) out["views_left_out"] = options.without;
    if (options.bounds) {
        const geometry::Aabb& box = *options.bounds;
        out["bounds"] = {
            box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z()};
    }
    if (!warnings.empty()) out["warnings"] = warnings;
    out["views"] = report_views(views, hull.mesh);
    const hull::StageTimes& times = measured.fastest;
    nlohmann::ordered_json& ms = out["milliseconds"];
    ms["silhouettes"] = times.silhouettes_ms;
    ms["pencils"] = times.pencils_ms;
    ms["sweep"] = times.sweep_ms;
    ms["assembly"] = times.assembly_ms;
    ms["total"] = times.total_ms;
    if (measured.totals_ms.size() > 1) {
        const std::size_t n = measured.totals_ms.size();
        ms["repeats"] = n;
        ms["total_min"] = measured.totals_ms.front();
        ms["total_median"] = 0.5 * (measured.totals_ms[(n - 1) / 2] + measured.totals_ms[n / 2]);
    }
    return out;
}

Expected<void> decimate(Measured& measured, const ToolOptions& options) {
    geometry::DecimateScratch scratch;
    const auto report = geometry::decimate(measured.hull.mesh,
                                           {.max_distance_m = 1e-3 * options.decimate_mm},
                                           scratch,
                                           measured.decimated.emplace());
    if (!report) return tl::unexpected(report.error());
    measured.distance_bound_m = report->distance_bound_m;
    return {};
}

Expected<void> write(const geometry::TriangleMesh& mesh, const ToolOptions& options) {
    std::vector<Eigen::Vector3f> normals;
    if (options.normals) normals = geometry::vertex_normals(mesh);
    return geometry::write_mesh(options.output, mesh, normals);
}

// Checks that the output can be written, before the slow computation. Changes nothing.
Expected<void> try_output(const std::filesystem::path& path) {
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(path, failure);
    const bool is_new = status.type() == std::filesystem::file_type::not_found;
    const bool is_other = !is_new && !std::filesystem::is_regular_file(status) &&
                          !std::filesystem::is_directory(status);
    if (path.empty() || is_other) return {};  // opening a pipe would be visible to its reader
    if (auto space = check_folder_writable(
            std::filesystem::absolute(path).parent_path(), kLeastSpace, "--output");
        !space && !std::filesystem::is_directory(status))
        return space;
    const Descriptor file(open(path.c_str(), O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC, 0644));
    if (file.get() < 0) {
        const int reason = errno;
        Error error = cannot_write(path, "create", reason);
        if (const auto meant = config::ask_which_path(path.parent_path()); !meant.empty())
            error.message += ", or " + meant;
        return tl::unexpected(std::move(error));
    }
    if (is_new) std::filesystem::remove(path, failure);
    return {};
}

std::string advice(hull::HullStatus status,
                   const std::vector<views::NamedView>& views,
                   const std::vector<std::string>& warnings) {
    const bool may_be_the_rig = status == hull::HullStatus::kUnbounded;
    if (may_be_the_rig && !warnings.empty()) return "; " + warnings.back();
    if (status == hull::HullStatus::kTooFewViews)
        return "; the hull needs at least two cameras at different places";
    if (status == hull::HullStatus::kUnbounded) return "; add --bounds to close it";
    if (status == hull::HullStatus::kTooComplex) return explain_too_complex(views);
    return "";
}

// Takes the bounds of the recording's rig unless the command line has its own, and judges the rig.
Expected<void> apply_rig(ToolOptions& options, std::vector<std::string>& warnings) {
    if (options.recording.empty()) return {};
    const auto rig = load_checked_rig(options.recording, warnings);
    if (!rig) return tl::unexpected(rig.error());
    const bool fits = rig->cameras.size() + hull::kViewsOfBounds <= hull::kMaxViews;
    if (!options.bounds && !options.no_bounds && rig->has_bounds && fits)
        options.bounds = rig->bounds_site;
    return {};
}

Expected<std::string> run_unguarded(ToolOptions options,
                                    const std::function<void(const std::string&)>& warn) {
    if (!options.output.empty() && !geometry::is_mesh_path(options.output)) {
        return make_error(
            ErrorKind::kConfiguration,
            options.output.string() + ": unknown mesh format; use .ply, .obj, .gltf or .glb");
    }
    if (auto writable = try_output(options.output); !writable)
        return tl::unexpected(writable.error());
    std::vector<std::string> warnings;
    // a missing folder has a better error of its own below
    if (std::filesystem::is_directory(options.recording)) {
        if (auto applied = apply_rig(options, warnings); !applied)
            return tl::unexpected(applied.error());
    }
    if (options.partial && !options.bounds) {
        return make_error(ErrorKind::kConfiguration,
                          "--partial: needs --bounds, or [bounds] in the rig of the recording, "
                          "because no camera limits the space outside the pictures");
    }
    const auto views = load_views(options);
    if (!views) return tl::unexpected(views.error());
    if (options.recording.empty()) warnings = judge_cameras(*views);
    Measured measured = compute(*views, options);
    const hull::HullStatus status = measured.hull.status;
    if (status != hull::HullStatus::kInvalidInput && status != hull::HullStatus::kTooComplex) {
        for (std::string& text : judge_hull(*views, measured.hull, options.bounds, options.partial))
            warnings.push_back(std::move(text));
    }
    for (const std::string& text : warnings) {
        if (warn) warn(text);
    }
    if (status != hull::HullStatus::kOk && status != hull::HullStatus::kEmptyIntersection) {
        const bool is_input =
            status == hull::HullStatus::kTooFewViews || status == hull::HullStatus::kInvalidInput;
        return make_error(is_input ? ErrorKind::kConfiguration : ErrorKind::kInvalidData,
                          name_of_input(options) + ": no hull: " + hull::to_string(status) +
                              advice(status, *views, warnings));
    }
    if (options.decimate_mm > 0.0) {
        if (auto done = decimate(measured, options); !done) return tl::unexpected(done.error());
    }
    if (!options.output.empty()) {
        const auto& mesh = measured.decimated ? *measured.decimated : measured.hull.mesh;
        if (auto written = write(mesh, options); !written) return tl::unexpected(written.error());
    }
    return report(*views, options, warnings, measured).dump(2);
}

}  // namespace

Expected<std::string> run(const ToolOptions& options,
                          const std::function<void(const std::string&)>& warn) {
    try {
        return run_unguarded(options, warn);
    } catch (const std::bad_alloc&) {
        return make_error(ErrorKind::kInternal, name_of_input(options) + ": not enough memory");
    } catch (const std::system_error& error) {
        return make_error(ErrorKind::kInternal,
                          "--threads: " + std::to_string(options.threads) +
                              " cannot be started: " + error.code().message());
    }
}

}  // namespace atrium::hull_tool
