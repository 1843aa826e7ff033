#include "tools/export/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace atrium::exporting {
namespace {

struct Format {
    const char* name;
    const char* ending;
    bool is_numbered;  // a file per frame
};
constexpr std::array<Format, 5> kFormats{{{"glb", ".glb", false},
                                          {"obj", ".obj", true},
                                          {"ply", ".ply", true},
                                          {"points", ".ply", true},
                                          {"usd", ".usda", false}}};

tl::unexpected<Error> wrong_option(const std::string& message) {
    return make_error(ErrorKind::kConfiguration, message);
}

const Format& format_named(const std::string& name) {
    return *std::ranges::find(kFormats, name, &Format::name);
}

}  // namespace

void declare(ExportConfig& config, config::OptionSet& options) {
    options.add("file", config.file, "the recording; also without the name of the option");
    options.add("output",
                config.output,
                "file NAME.glb, NAME.usda, NAME.obj, NAME.ply; a folder for sequences of .obj and "
                ".ply, with --format");
    options.add_alias("o");
    options.add("site", config.site, "the site whose people are exported; empty: the only one");
    options.add("format",
                config.format,
                "glb, usd, obj (with material and picture), ply (a colour per vertex), points "
                "(a point cloud as .ply); auto: by the ending",
                {"auto", "glb", "usd", "obj", "ply", "points"});
    options.add("from", config.from_s, "begin here [s]", {0, 1e9});
    options.add("to", config.to_s, "end here [s]; 0: at the end", {0, 1e9});
    options.add("every", config.every, "only each n-th frame", {1, 100'000});
    options.add("frame",
                config.frame,
                "frame of reference: of the site, or of the world, where the site was placed",
                {"site", "world"});
    options.add(
        "path", config.path, "a camera path of the viewer (PATH.json), as a camera in the .glb");
    options.add(
        "eye",
        config.eye,
        "for whom the colours are blended: seen from in front of each point of the surface, "
        "or by the camera of --path, whose shot then looks as in the viewer",
        {"normals", "path"});
    options.add("quality", config.quality, "quality of the JPEG pictures", {1, 100});
    options.add("draco",
                config.draco,
                "compress the meshes of .glb by Draco: a fifth of the size, but not every program "
                "reads it");
    options.add("chunk_mb",
                config.chunk_mb,
                "begin another .glb after so much [MB]; it is the memory that is needed",
                {1, 4000});
    options.add("chunk_frames",
                config.chunk_frames,
                "begin another .glb after so many frames; 0: never",
                {0, 1e9});
    options.add("points", config.points, "points of a point cloud", {1, 100e6});
    options.add("threads", config.threads, "frames at a time; 0: one per core", {0, 1024});
}

Expected<std::string> format_of(const ExportConfig& config) {
    const std::string ending = config.output.extension().string();
    if (config.format != "auto") {
        const Format& format = format_named(config.format);
        const bool is_other = std::ranges::any_of(
            kFormats, [&](const Format& other) { return ending == other.ending; });
        if (is_other && ending != format.ending) {
            return wrong_option(fmt::format("format: '{}' does not fit the ending of {}",
                                            config.format,
                                            config.output.string()));
        }
        if (ending != format.ending && !format.is_numbered) {
            return wrong_option(fmt::format(
                "output: '{}': the name must end in {}", config.output.string(), format.ending));
        }
        return config.format;
    }
    for (const Format& format : kFormats) {
        if (ending == format.ending) return std::string(format.name);
    }
    return wrong_option(
        fmt::format("output: '{}': the name must end in .glb, .usda, .obj or .ply; "
                    "for a folder give --format obj, ply or points",
                    config.output.string()));
}

bool is_single_frame(const ExportConfig& config) {
    const std::string ending = config.output.extension().string();
    return ending == ".obj" || ending == ".ply";
}

Expected<void> check(const ExportConfig& config) {
    if (config.file.empty()) return wrong_option("FILE is missing: the recording, FILE.mcap");
    if (config.output.empty())
        return wrong_option("-o is missing: the file or folder to write, for example -o alice.glb");
    const auto format = format_of(config);
    if (!format) return tl::unexpected(format.error());
    if (config.to_s > 0.0 && config.to_s < config.from_s) {
        return wrong_option(fmt::format("to: must not be earlier than from ({:g})", config.from_s));
    }
    if (is_single_frame(config) && config.to_s > 0.0) {
        return wrong_option(
            fmt::format("to: {} is one frame, that of --from; for a sequence give "
                        "a folder: -o FOLDER --format {}",
                        config.output.string(),
                        *format));
    }
    if (config.eye == "path" && config.path.empty())
        return wrong_option("eye: 'path' needs --path PATH.json");
    if (!config.path.empty() && *format != "glb" && config.eye != "path")
        return wrong_option("path: only .glb files have cameras; others take it with --eye path");
    return {};
}

}  // namespace atrium::exporting
