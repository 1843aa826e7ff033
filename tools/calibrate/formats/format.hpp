#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/formats/data_tree.hpp"
#include "tools/calibrate/formats/foreign_rig.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Calibration files of other programs. Facts about each format, and what it cannot hold:
/// docs/calibrate.md. All bytes are treated as hostile.
namespace atrium::calibrate {

using Files = std::vector<std::filesystem::path>;

enum class Format : std::uint8_t { kOpenCv, kQualisys, kVicon, kColmap, kToml, kKalibr };

/// Names for --format: "opencv", "qualisys", "vicon", "colmap", "kalibr", and "caliscope",
/// "pose2sim", "anipose", which are one format.
const std::vector<std::string>& format_names();
std::optional<Format> format_of(const std::string& name);

/// Most cameras of a rig, as in core/config/rig.cpp.
inline constexpr std::size_t kMaxCameras = 64;
/// Most cameras of a calibration, of which a rig may take some.
inline constexpr std::size_t kMaxCamerasRead = 1024;

/// Reads all files as one rig, of the format with this name; "auto" finds it from the content.
/// Several files may each hold some cameras, or some values of each camera. Keeps the cameras whose
/// names match one of `wanted`, patterns of a shell such as "00_*", and none of those that begin
/// with '!'; if there are no others, all. Error kConfiguration for a pattern that no name matches,
/// and if fewer than 2 remain.
Expected<ForeignRig> read_foreign(const Files& files,
                                  const std::string& format,
                                  const std::vector<std::string>& wanted = {});

/// For more than `kMaxCamerasRead` in a file: kInvalidData.
tl::unexpected<Error> too_many_cameras(const std::string& where);

/// Removes all cameras but those that `is_wanted` names, and the notes and checks on them.
void keep_cameras(ForeignRig& rig, const std::function<bool(const std::string&)>& is_wanted);

/// Replaces each folder that is no model of COLMAP by the calibration files in it, in the order of
/// their names, without rigs that an import wrote beside them; else by the only model of COLMAP in
/// it or in its folder sparse, else by those rigs. Error kNotFound for a folder without any,
/// kConfiguration for several models.
Expected<Files> with_folders_opened(const Files& files);

Expected<ForeignRig> read_opencv(const Files& files);
Expected<ForeignRig> read_qualisys(const Files& files);
Expected<ForeignRig> read_vicon(const Files& files);
/// `files`: the folder of a model, or its cameras and images files, as text or binary.
Expected<ForeignRig> read_colmap(const Files& files);
Expected<ForeignRig> read_toml_cameras(const Files& files);
Expected<ForeignRig> read_kalibr(const Files& files);

/// Writes a rig as a file (COLMAP: a folder) of this format. Returns sentences on what the format
/// cannot hold and was lost.
Expected<std::vector<std::string>> write_foreign(const config::Rig& rig,
                                                 Format format,
                                                 const std::filesystem::path& output);

}  // namespace atrium::calibrate
