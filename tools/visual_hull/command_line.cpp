#include "tools/visual_hull/tool.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <sstream>
#include <string>

namespace atrium::hull_tool {
namespace {

constexpr const char* kSummary =
    "Computes the exact polyhedral visual hull of a set of silhouettes and prints a report as one "
    "JSON object.";

constexpr const char* kDetails =
    "Report: vertices, triangles, components, euler_characteristic, volume_m3, closed, manifold; "
    "per view its name,\n"
    "coverage (share of the silhouette's pixels that the projected hull covers) and excess_px "
    "(covered pixels\n"
    "outside the silhouette); milliseconds of each stage of the fastest computation and "
    "in total.\n"
    "Exit codes: 0 done (also with an empty hull), 1 no hull (unbounded, too complex, numeric "
    "failure), no memory\n"
    "or no threads, 2 wrong command line or input file, 3 something is missing: a file, space or "
    "rights to "
    "write.\n"
    "Examples:\n"
    "  visual_hull views.json -o hull.ply\n"
    "  visual_hull --recording recordings/room --frame 12 --threads 2 --repeat 50\n"
    "  visual_hull views.json --partial --bounds -1,-1,0,1,1,2.3 --min-views 3 --without cam4";

constexpr int kExitUsage = 2;
constexpr int kMaxFrame = 1'000'000'000;
constexpr double kMaxCoordinate_m = 1e4;
constexpr double kMinExtent_m = 0.01;
constexpr const char* kNone = "none";

// An option of whole numbers.
CLI::Option* integer(CLI::Option* option, int low, int high) {
    return option->type_name(fmt::format("INTEGER in [{}, {}]", low, high))
        ->check(CLI::Validator(
            [low, high](std::string& text) {
                int value = 0;
                const bool inside =
                    CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
                return inside
                           ? std::string()
                           : fmt::format("must be an integer in [{}, {}], got {}", low, high, text);
            },
            ""));
}

// CLI::Range alone accepts NaN, which is neither below nor above a limit.
CLI::Option* number(CLI::Option* option, double low, double high) {
    return option->type_name(fmt::format("NUMBER in [{}, {}]", low, high))
        ->check(CLI::Validator(
            [low, high](std::string& text) {
                double value = 0.0;
                const bool inside =
                    CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
                return inside
                           ? std::string()
                           : fmt::format("must be a number in [{}, {}], got {}", low, high, text);
            },
            ""));
}

// Parses six numbers, the corners of a box with a positive extent.
std::optional<geometry::Aabb> parse_bounds(const std::string& text) {
    geometry::Aabb box;
    std::istringstream stream(text);
    for (int i = 0; i < 6; ++i) {
        double& value = i < 3 ? box.min[i] : box.max[i - 3];
        char comma = ',';
        if ((i > 0 && !(stream >> comma)) || comma != ',' || !(stream >> value) ||
            !(std::abs(value) <= kMaxCoordinate_m)) {
            return std::nullopt;
        }
    }
    if (stream.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
    if (!(box.size().array() >= kMinExtent_m).all()) return std::nullopt;
    return box;
}

std::string refuse_bounds(std::string& text) {
    if (text == kNone || parse_bounds(text)) return "";
    return fmt::format(
        "must be six numbers X0,Y0,Z0,X1,Y1,Z1 in [{}, {}] m, with the second corner above "
        "the first by at least {} m in x, y and z, got {}",
        -kMaxCoordinate_m,
        kMaxCoordinate_m,
        kMinExtent_m,
        text);
}

// Options that change the hull.
void add_hull_options(CLI::App& app, ToolOptions& options) {
    app.add_option_function<std::string>(
           "--bounds",
           [&](const std::string& text) {
               options.no_bounds = text == kNone;
               options.bounds = parse_bounds(text);
           },
           "box that contains all people and cuts the hull; lowest and highest corner in metres; "
           "none: not even that of the recording's rig")
        ->type_name("X0,Y0,Z0,X1,Y1,Z1")
        ->check(CLI::Validator(refuse_bounds, ""));
    app.add_flag(
        "--partial",
        options.partial,
        "people may extend beyond the pictures: space outside a line 2 px inside the border "
        "is unknown and not cut away; needs bounds, here or in the recording's rig");
    integer(app.add_option("--min-views",
                           options.min_views,
                           "a point seen by fewer cameras is not in the hull; 0: off"),
            0,
            64)
        ->capture_default_str();
    number(app.add_option(
               "--min-litres", options.min_litres, "drop components smaller than this, in litres"),
           0.0,
           1e6)
        ->capture_default_str();
    app.add_option("--without", options.without, "ignore the view of this name; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app.add_flag("--keep-phantoms",
                 options.keep_phantoms,
                 "keep components that no silhouette needs (without a viewing edge) and tiny ones: "
                 "the exact intersection");
}

}  // namespace

namespace {

Start end_with(const std::string& what) {
    fmt::print(stderr, "visual_hull: error: {}; --help lists the options\n", what);
    return {false, kExitUsage};
}

}  // namespace

Start parse_command_line(int argc, char** argv, ToolOptions& options) {
    // `atrium hull` runs it under the name atrium-hull
    const bool is_tool = argc > 0 && std::string(argv[0]).ends_with("atrium-hull");
    CLI::App app{kSummary, is_tool ? "atrium hull" : "visual_hull"};
    app.footer(kDetails);
    app.set_version_flag("--version", "visual_hull " ATRIUM_VERSION);
    app.add_option("views", options.views_file, "JSON file with cameras and silhouettes")
        ->type_name("FILE");
    app.add_option(
           "--recording", options.recording, "folder of a recording, instead of a views file")
        ->type_name("FOLDER");
    auto* frame =
        integer(app.add_option("--frame", options.frame, "frame of the recording"), 0, kMaxFrame)
            ->capture_default_str();
    app.add_option("--config",
                   options.config,
                   "site file: its [segmentation] and [silhouette] apply to the recording")
        ->type_name("FILE");
    app.add_option("-o,--output", options.output, "write the mesh: .ply, .obj, .gltf or .glb")
        ->type_name("FILE")
        ->check(CLI::Validator(
            [](std::string& text) { return text.empty() ? "must not be empty" : ""; }, ""));
    integer(app.add_option("--threads", options.threads, "number of threads"), 1, 256)
        ->capture_default_str();
    integer(app.add_option("--repeat",
                           options.repeat,
                           "number of computations; adds the minimum and median of the total time"),
            1,
            1'000'000)
        ->capture_default_str();
    add_hull_options(app, options);
    number(app.add_option(
               "--decimate",
               options.decimate_mm,
               "remove vertices while the surface stays within this distance, in millimetres; "
               "adds decimated_triangles and distance_bound_mm to the report"),
           1e-3,
           1e3);
    app.add_flag("--normals", options.normals, "also write vertex normals");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& asked) {
        return {false, app.exit(asked)};
    } catch (const CLI::ParseError& error) {
        return end_with(error.what());
    }
    const bool is_recording = !options.recording.empty();
    if (options.views_file.empty() && !is_recording)
        return end_with("a views file or --recording is required");
    if (!options.views_file.empty() && is_recording)
        return end_with("a views file and --recording exclude each other");
    if (frame->count() > 0 && !is_recording) return end_with("--frame: needs --recording");
    if (!options.config.empty() && !is_recording) return end_with("--config: needs --recording");
    if (options.partial && !is_recording && !options.bounds)
        return end_with("--partial: needs --bounds");
    return {true, 0};
}

}  // namespace atrium::hull_tool
