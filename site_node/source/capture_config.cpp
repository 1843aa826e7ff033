#include "site_node/source/capture_config.hpp"

#include "core/base/looked_up.hpp"

#include <fmt/format.h>

#include <system_error>

namespace atrium::site_node {
namespace {

namespace fs = std::filesystem;

// "site.toml:7: capture.rig", if the path is that of the file.
std::string place_of(const CaptureConfig& capture, const char* key, const fs::path& path) {
    const auto found = capture.places.find(fmt::format("{} {}", key, path.string()));
    return found == capture.places.end() ? std::string("--") + key
                                         : fmt::format("{}: {}", found->second, key);
}

Expected<void> check_exists(const CaptureConfig& capture, const char* key, const fs::path& path) {
    std::error_code failure;
    if (fs::exists(path, failure)) return {};
    const bool is_from_file = capture.places.contains(fmt::format("{} {}", key, path.string()));
    return make_error(
        ErrorKind::kNotFound,
        fmt::format("{}: '{}' does not exist{}",
                    place_of(capture, key, path),
                    path.lexically_normal().string(),
                    is_from_file ? "; a path in a file is relative to the file: after copying it, "
                                   "correct the path or copy what it names"
                                 : looked_up_from(path)));
}

}  // namespace

void declare(CaptureConfig& capture, config::OptionSet& set) {
    set.add("capture.source",
            capture.source,
            "source of the pictures",
            {"simulated", "recording", "cameras"});
    set.add("capture.rig", capture.rig, "rig.toml with the cameras of the simulated or real room");
    set.add("capture.recording", capture.recording, "folder of the recording");
    set.add("capture.rate_hz",
            capture.rate_hz,
            "metaframes per second [Hz]; 0: as recorded, or as in the rig",
            {0, 1000});
    set.add("capture.loop", capture.loop, "restart a recording at its end");
    set.add("capture.aligned",
            capture.aligned,
            "show instant n at n periods after the Unix epoch, as all hosts of a site do; plays a "
            "recording without end");
    set.add("every", capture.every, "recording: use each Nth instant only", {1, 1e6});
    set.add("capture.tolerance_ms",
            capture.tolerance_ms,
            "largest time between a trigger and its pictures [ms]; 0: a quarter of the period",
            {0, 1000});
    set.add("capture.deadline_ms",
            capture.deadline_ms,
            "how long a metaframe may stay incomplete [ms]",
            {1, 10000});
    set.add(
        "capture.min_cameras",
        capture.min_cameras,
        "cameras that must have delivered at the deadline to use an incomplete metaframe; 0: all",
        {0, 64});
    declare(capture.cameras, set);
}

void read_places(config::TableReader& reader, CaptureConfig& config) {
    config::TableReader table = reader.table("capture");
    const auto keep_place = [&](const char* key, const fs::path& path) {
        if (table.has(key))
            config.places[fmt::format("capture.{} {}", key, path.string())] = table.where(key);
    };
    keep_place("rig", config.rig);
    keep_place("recording", config.recording);
}

Expected<void> check(const CaptureConfig& config) {
    const auto wrong = [](std::string text) {
        return make_error(ErrorKind::kConfiguration, std::move(text));
    };
    if (config.source == "simulated" && config.rig.empty()) {
        return wrong(
            "capture.rig: must be set for a simulated room, for example "
            "deploy/rigs/full_body.toml");
    }
    if (config.source == "recording" && config.recording.empty()) {
        return wrong(
            "capture.recording: must be set for capture.source = \"recording\": the folder of the "
            "recording");
    }
    if (config.source != "recording") {
        if (config.every > 1) return wrong("--every: needs a recording; add --recording DIR");
        if (config.as_fast_as_possible)
            return wrong("--rate 0: needs a recording; add --recording DIR");
    }
    return {};
}

Expected<void> check_places(const CaptureConfig& config) {
    // an error of the recording's own is better if it is no folder
    if (config.source == "recording")
        return check_exists(config, "capture.recording", config.recording);
    if (config.rig.empty()) return {};
    return check_exists(config, "capture.rig", config.rig);
}

}  // namespace atrium::site_node
