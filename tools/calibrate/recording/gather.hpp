#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/recording/mask_reading.hpp"
#include "tools/calibrate/recording/matching.hpp"
#include "tools/calibrate/recording/shots.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace atrium::calibrate {

struct Material;

/// Where the pictures of a rig are searched.
struct PictureFolders {
    std::filesystem::path frames;
    std::string take;                   // pattern of their names; empty: all
    std::filesystem::path background;   // empty: below `frames`, by name
    std::filesystem::path masks;        // empty: below `frames`, by name
    bool ignore_masks = false;          // even those below `frames`
    bool is_rate_said = false;          // so the videos' rates decide nothing
    bool invert_masks = false;          // people are black in them
    std::vector<std::string> optional;  // cameras that moved: not missed without pictures
    /// Cameras that may take no pictures, and their models: not missed without pictures, unless the
    /// empty room or others of the model have some.
    std::map<std::string, std::string> for_markers;
    std::vector<std::string> walked;  // others, whose pictures belong to no camera
    /// The same, by name in the calibration, and why; empty: nobody misses them.
    std::map<std::string, std::string> left_out = {};
    std::string why_unknown = {};  // cameras are not in the calibration; or empty
    Originals originals = {};      // names of cameras in the calibration, if other ones
    /// Compares the frames, found and looked at, with the calibration. Before masks and rooms are
    /// compared with the frames: where those are wrong, advice about these would be too.
    std::function<Expected<void>(const Material&)> compare = {};
};

/// The pictures of a rig, found in folders of another program.
struct Material {
    std::map<std::string, Shots> frames;       // by camera
    std::map<std::string, Shots> backgrounds;  // by camera; may lack some
    std::map<std::string, Shots> masks;        // by camera; of all cameras with frames, or none
    MaskReading mask_reading;                  // what their values mean
    std::size_t first_frame = 0;               // number of the first instant, in frames
    std::size_t first_mask = 0;                // the same instant, in masks
    std::size_t first_complete = 0;            // instant of the recording that all cameras show
    std::map<std::string, Look> looks;         // of the frames
    std::vector<std::string> missing;          // cameras without frames
    std::vector<std::string> left_out;         // the same, of those that may lack them, or walked
    std::vector<std::string> told;
    std::vector<std::string> checks;    // assumptions, with the option that changes them
    std::vector<std::string> problems;  // that make a site fail, or lose people; with the cure
    double rate_hz = 0.0;               // of the videos, else of the times; 0: unknown
    bool is_rate_of_times = false;      // in the names of the pictures
};

/// Finds frames, backgrounds and masks of these cameras. Errors of `find_shots` and `match_shots`,
/// and kConfiguration if fewer than two cameras have frames, if their pictures have no number in
/// common, if only some have masks in a folder that the user named, or if masks have another size
/// than their pictures or look inverted; and those of `compare`.
Expected<Material> gather(const std::vector<std::string>& cameras, const PictureFolders& folders);

}  // namespace atrium::calibrate
