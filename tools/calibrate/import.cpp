#include "tools/calibrate/import.hpp"

#include "core/base/write_check.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/rig_check/rig_geometry.hpp"
#include "tools/calibrate/compare_sizes.hpp"
#include "tools/calibrate/formats/rig_file.hpp"
#include "tools/calibrate/judge/other_size.hpp"
#include "tools/calibrate/picture_size.hpp"
#include "tools/calibrate/recording/make_recording.hpp"
#include "tools/calibrate/recording/room_checks.hpp"
#include "tools/calibrate/recording/words.hpp"
#include "tools/calibrate/said_floor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

constexpr double kSameRate = 0.05;  // relative difference

std::vector<std::string> names_of(const ForeignRig& rig) {
    std::vector<std::string> names;
    for (const ForeignCamera& camera : rig.cameras) names.push_back(camera.name);
    return names;
}

Originals originals_of(const ForeignRig& rig) {
    Originals result;
    for (const ForeignCamera& camera : rig.cameras)
        if (!camera.original.empty()) result[camera.name] = camera.original;
    return result;
}

std::vector<std::string> walked(const ForeignRig& rig) {
    std::vector<std::string> names;
    for (const Walked& camera : rig.walked) names.push_back(camera.name);
    return names;
}

// Those of `left_out` have no pictures, so that nobody misses them.
void report_walked(ForeignRig& rig, const std::vector<std::string>& left_out) {
    for (const Walked& camera : rig.walked) {
        if (std::ranges::find(left_out, camera.name) == left_out.end())
            rig.problems.push_back(camera.problem);
    }
}

std::vector<std::string> moved(const ForeignRig& rig) {
    std::vector<std::string> names;
    for (const ForeignCamera& camera : rig.cameras)
        if (camera.spread > kStillSpread) names.push_back(camera.name);
    return names;
}

// With their models.
std::map<std::string, std::string> for_markers(const ForeignRig& rig) {
    std::map<std::string, std::string> models;
    for (const ForeignCamera& camera : rig.cameras)
        if (camera.is_for_markers) models[camera.name] = camera.model;
    return models;
}

// Those of `missed` are reported already.
void report_markers(ForeignRig& rig,
                    const std::vector<std::string>& missed,
                    const std::function<bool(const std::string&)>& has_pictures) {
    std::vector<std::string> used;
    std::vector<std::string> unused;
    for (const ForeignCamera& camera : rig.cameras) {
        const bool is_missed = std::ranges::find(missed, camera.name) != missed.end();
        if (camera.is_for_markers && !is_missed)
            (has_pictures(camera.name) ? used : unused).push_back(camera.known_name());
    }
    if (!unused.empty()) {
        rig.notes.push_back(fmt::format(
            "cameras for markers were left out: {}: they have no pictures, and their models "
            "neither Video nor Hybrid in their names",
            listed(unused)));
    }
    if (!used.empty()) {
        rig.notes.push_back(fmt::format(
            "cameras {} have pictures, so they are used, although their models have neither Video "
            "nor Hybrid in their names",
            listed(used)));
    }
}

// Without pictures only the models tell what a camera is for.
void drop_markers(ForeignRig& rig) {
    const auto markers = for_markers(rig);
    if (markers.size() == rig.cameras.size()) return;
    report_markers(rig, {}, [](const std::string& /*name*/) { return false; });
    keep_cameras(rig, [&](const std::string& name) { return !markers.contains(name); });
}

std::vector<std::string> comments(const ForeignRig& foreign,
                                  const ImportOptions& options,
                                  const Conclusion& conclusion) {
    std::string files;
    for (const auto& file : options.files) files += (files.empty() ? "" : ", ") + file.string();
    std::vector<std::string> lines{
        fmt::format("Imported from {} ({}) by `calibrate import`.", files, foreign.format)};
    lines.insert(lines.end(), conclusion.told.begin(), conclusion.told.end());
    for (const std::string& check : conclusion.checks) lines.push_back("check: " + check);
    for (const std::string& problem : conclusion.problems) lines.push_back("problem: " + problem);
    return lines;
}

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

std::string size_text(const std::array<int, 2>& size) {
    return fmt::format("{}x{}", size[0], size[1]);
}

// The calibration was made for pictures of another size, which fits no silhouette.
std::string problem_of(const OtherSize& other, const config::Rig& rig) {
    const geometry::PinholeCamera& lens = rig.cameras.front().intrinsics;
    const std::string points =
        fmt::format("lens: the principal points of {} of {} cameras lie in the middle of pictures",
                    other.num_agreeing,
                    rig.cameras.size());
    constexpr const char* kSo =
        "so the cameras were probably calibrated at another size, and people will be missing or "
        "broken; ";
    if (!other.size) {
        return fmt::format(
            "{} about {:.3g} times as large as yours, {}divide fx, fy, cx and cy of the "
            "calibration by that number",
            points,
            other.factor,
            kSo);
    }
    return fmt::format(
        "{0} of about {1} px, but yours have {2} px, {3}if yours were scaled from {1} px, say "
        "--calibrated-size {1}, else give the size from which they were scaled",
        points,
        size_text(*other.size),
        size_text({lens.width, lens.height}),
        kSo);
}

// Usually it is the same with all cameras.
void check_lenses(const config::Rig& rig, ImportReport& report) {
    const auto other = find_other_size(rig.cameras);
    if (other) report.problems.push_back(problem_of(*other, rig));
    std::vector<std::string> doubts;
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        if (other && other->agrees[i]) continue;
        for (const auto& finding : rig_check::check_lens(rig.cameras[i]))
            doubts.push_back(finding.text);
    }
    if (doubts.empty()) return;
    report.checks.push_back("lens: " + doubts.front() +
                            (doubts.size() == 1
                                 ? std::string()
                                 : fmt::format("; and {} more like it", doubts.size() - 1)));
}

// The user knows better than the file.
void set_calibrated_size(ForeignRig& rig, const Said& said) {
    if (!said.calibrated_size) return;
    for (ForeignCamera& camera : rig.cameras) {
        camera.lens.width = (*said.calibrated_size)[0];
        camera.lens.height = (*said.calibrated_size)[1];
    }
}

std::vector<std::string> next_commands(const ImportOptions& options) {
    const auto program = [&](const char* name) { return quoted(options.programs + name); };
    const bool is_recording = !options.recording.empty();
    return {program("world_server"),
            fmt::format("{} --site.name lab {} {}{}",
                        program("site_node"),
                        is_recording ? "--recording" : "--capture.source simulated --capture.rig",
                        quoted(options.output.string()),
                        is_recording ? " --capture.loop" : ""),
            program("viewer") + " --world atrium"};
}

// Reads the recording as a site will.
Expected<void> prove(const fs::path& folder, std::size_t first_complete) {
    const auto source = capture::RecordingSource::open({.folder = folder});
    if (!source) return tl::unexpected(source.error());
    const auto frame = (*source)->read_frame(first_complete);
    if (!frame) return tl::unexpected(frame.error());
    return {};
}

Expected<void> check_number(const ForeignRig& rig, const ImportOptions& options) {
    if (rig.cameras.size() <= kMaxCameras) return {};
    const std::string start = rig.cameras.front().name.substr(0, 2);
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format("{}: {} cameras{}, but a rig has {} at most; choose some by their names, for "
                    "example --cameras '{}*'{}",
                    options.files.front().string(),
                    rig.cameras.size(),
                    options.recording.empty() ? "" : " with pictures",
                    kMaxCameras,
                    start,
                    options.recording.empty()
                        ? ", or give --recording: cameras without pictures are left out"
                        : ""));
}

Expected<Material> gather_for(ForeignRig& rig, const ImportOptions& options) {
    const bool ignore_masks = options.masks == kNoMasks;
    auto material = gather(
        names_of(rig),
        {options.recording,
         options.take,
         options.background,
         ignore_masks ? fs::path() : options.masks,
         ignore_masks,
         options.has_rate,
         options.invert_masks,
         moved(rig),
         for_markers(rig),
         walked(rig),
         rig.left_out,
         rig.format == "COLMAP" ? "; if they are cameras of the room, COLMAP did not register "
                                  "them: solve again with more pictures of them"
                                : "",
         originals_of(rig),
         [&](const Material& found) { return compare_sizes(rig, found, options.said); }});
    if (!material) return material;
    report_walked(rig, material->left_out);
    const auto has_pictures = [&](const std::string& name) {
        return material->frames.contains(name);
    };
    report_markers(rig, material->missing, has_pictures);
    keep_cameras(rig, has_pictures);
    if (auto counted = check_number(rig, options); !counted) return tl::unexpected(counted.error());
    return material;
}

// A calibration becomes a file, a recording a folder.
Expected<void> check_output(const ImportOptions& options) {
    std::error_code failure;
    const bool is_folder = fs::is_directory(options.output, failure);
    if (options.recording.empty() && is_folder) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{0}: -o names a folder, but without --recording it is the "
                                      "rig.toml to write, for example -o {1}",
                                      options.output.string(),
                                      (options.output / "rig.toml").string()));
    }
    if (!options.recording.empty() && !is_folder && fs::exists(options.output, failure)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: -o names a file, but with --recording it is the folder "
                                      "of the new recording",
                                      options.output.string()));
    }
    return {};
}

Expected<ImportReport> import_recording(ForeignRig& foreign, const ImportOptions& options) {
    std::error_code failure;
    if (fs::equivalent(options.output, options.recording, failure)) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: the new recording needs a folder of its own, not that of "
                        "the pictures; give another -o",
                        options.output.string()));
    }
    if (auto writable = check_folder_writable(options.output, 0, "-o"); !writable)
        return tl::unexpected(writable.error());
    const auto material = gather_for(foreign, options);
    if (!material) return tl::unexpected(material.error());
    Said said = options.said;
    said.size.reset();  // done, camera by camera
    if (!options.has_rate && material->rate_hz > 0.0) said.rate_hz = material->rate_hz;
    auto conclusion = conclude(foreign, said);
    if (!conclusion) return tl::unexpected(conclusion.error());
    const fs::path rig_file = options.output / "rig.toml";
    if (fs::exists(rig_file, failure) && !options.force) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: exists already; give another -o, or --force", rig_file.string()));
    }
    const auto made = make_recording(*material, options.output, {options.copy, options.force});
    if (!made) return tl::unexpected(made.error());
    const std::string text = rig_text(conclusion->rig, comments(foreign, options, *conclusion));
    if (auto written = write_text(rig_file, text, options.force); !written) {
        remove_made(*made);
        return tl::unexpected(written.error());
    }
    if (auto proven = prove(options.output, material->first_complete); !proven) {
        fs::remove(rig_file, failure);
        remove_made(*made);
        return make_error(proven.error().kind,
                          fmt::format("{}; nothing was kept in {}: correct this in {}, and import "
                                      "again",
                                      proven.error().message,
                                      options.output.string(),
                                      options.recording.string()));
    }
    ImportReport report{
        material->told, material->checks, material->problems, next_commands(options)};
    append(report.told, conclusion->told);
    append(report.checks, conclusion->checks);
    append(report.problems, conclusion->problems);
    for (const RoomDoubt& doubt : doubt_rooms(*material))
        (doubt.is_in_most_cameras ? report.problems : report.checks).push_back(doubt.text);
    if (auto doubt = doubt_floor(*material, conclusion->rig.cameras, said); !doubt.empty())
        report.checks.push_back(std::move(doubt));
    check_lenses(conclusion->rig, report);
    const double rate_hz = conclusion->rig.rate_hz;
    if (!options.has_rate && material->rate_hz > 0.0)
        report.told.push_back(fmt::format("rate: {:.4g} Hz, as the {} say",
                                          rate_hz,
                                          material->is_rate_of_times ? "times" : "videos"));
    if (options.has_rate && material->is_rate_of_times &&
        std::abs(rate_hz / material->rate_hz - 1.0) > kSameRate) {
        report.checks.push_back(
            fmt::format("rate: --rate says {:.4g} Hz, the times in the names of the pictures "
                        "{:.4g} Hz; {:.4g} Hz is taken; if people move too fast or too slowly, "
                        "leave --rate out",
                        rate_hz,
                        material->rate_hz,
                        rate_hz));
    }
    if (!options.has_rate && material->rate_hz <= 0.0) {
        report.checks.push_back(
            fmt::format("rate: {:.4g} Hz is assumed; if people move too fast or too slowly, say "
                        "--rate",
                        rate_hz));
    }
    return report;
}

}  // namespace

Expected<ImportReport> import(const ImportOptions& options) {
    if (auto checked = check_output(options); !checked) return tl::unexpected(checked.error());
    const auto files = with_folders_opened(options.files);
    if (!files) return tl::unexpected(files.error());
    auto foreign = read_foreign(*files, options.format, options.cameras);
    if (!foreign) return tl::unexpected(foreign.error());
    set_calibrated_size(*foreign, options.said);
    read_point_offsets(*foreign);  // before they are scaled
    if (!options.recording.empty()) return import_recording(*foreign, options);
    drop_markers(*foreign);
    if (auto counted = check_number(*foreign, options); !counted)
        return tl::unexpected(counted.error());
    report_walked(*foreign, {});
    const auto conclusion = conclude(*foreign, options.said);
    if (!conclusion) return tl::unexpected(conclusion.error());
    const std::string text = rig_text(conclusion->rig, comments(*foreign, options, *conclusion));
    if (auto written = write_text(options.output, text, options.force); !written)
        return tl::unexpected(written.error());
    const auto checked = config::load_rig(options.output);
    if (!checked) return tl::unexpected(checked.error());
    ImportReport report{
        conclusion->told, conclusion->checks, conclusion->problems, next_commands(options)};
    check_lenses(conclusion->rig, report);
    return report;
}

}  // namespace atrium::calibrate
