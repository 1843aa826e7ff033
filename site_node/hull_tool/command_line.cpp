#include "site_node/hull_tool/tool.hpp"

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
    "coverage (share of the silhouette's pixels that the hull projects onto) and excess_px (pixels "
    "outside the\n"
    "silhouette that it projects onto); milliseconds of each stage of the fastest computation and "
    "in total.\n"
    "Exit codes: 0 done (also where the hull is empty), 1 no hull (unbounded, too complex, numeric "
    "failure) or no\n"
    "memory or threads, 2 wrong command line or input file, 3 a file is not there or cannot be "
    "written.\n"
    "Examples:\n"
    "  visual_hull views.json -o hull.ply\n"
    "  visual_hull --recording recordings/room --frame 12 --threads 2 --repeat 50\n"
    "  visual_hull views.json --partial --bounds -1,-1,0,1,1,2.3 --min-views 3 --without cam4";

constexpr int kExitUsage = 2;
constexpr double kMaxCoordinate_m = 1e4;
constexpr double kMinExtent_m = 0.01;

// A range alone lets through what is not a number, which is neither below nor above.
CLI::Validator number_in(double low, double high) {
    CLI::Validator range = CLI::Range(low, high);
    range.operation([low, high](std::string& text) {
        double value = 0.0;
        const bool inside = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
        return inside ? std::string()
                      : fmt::format("must be a number in [{}, {}], got {}", low, high, text);
    });
    return range;
}

// Six numbers, the corners of a box that has an extent.
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
    if (parse_bounds(text)) return "";
    return fmt::format(
        "must be six numbers X0,Y0,Z0,X1,Y1,Z1 in [{}, {}] m, the second corner higher "
        "than the first by at least {} m in x, y and z, got {}",
        -kMaxCoordinate_m,
        kMaxCoordinate_m,
        kMinExtent_m,
        text);
}

// What decides which hull it is.
void add_hull_options(CLI::App& app, ToolOptions& options) {
    auto* bounds =
        app.add_option_function<std::string>(
               "--bounds",
               [&](const std::string& text) { options.bounds = parse_bounds(text); },
               "where people can be: the hull is cut there; lowest and highest corner in metres")
            ->type_name("X0,Y0,Z0,X1,Y1,Z1")
            ->check(CLI::Validator(refuse_bounds, ""));
    app.add_flag("--partial",
                 options.partial,
                 "people may reach out of the pictures: what lies beyond 2 px inside of the border "
                 "is unknown and not cut away; needs --bounds")
        ->needs(bounds);
    app.add_option("--min-views",
                   options.min_views,
                   "where fewer cameras see a point of space, it is not in the hull")
        ->check(CLI::Range(0, 64))
        ->capture_default_str();
    app.add_option("--min-litres", options.min_litres, "drop smaller components, in litres")
        ->check(number_in(0.0, 1e6))
        ->capture_default_str();
    app.add_option("--without", options.without, "leave out the view of this name; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app.add_flag("--keep-phantoms",
                 options.keep_phantoms,
                 "keep components that no silhouette needs (without viewing edge) or that are "
                 "tiny: the exact intersection");
}

}  // namespace

Start parse_command_line(int argc, char** argv, ToolOptions& options) {
    CLI::App app{kSummary, "visual_hull"};
    app.footer(kDetails);
    app.set_version_flag("--version", "visual_hull " ATRIUM_VERSION);
    auto* file =
        app.add_option("views", options.views_file, "JSON file with cameras and silhouettes");
    auto* recording = app.add_option(
        "--recording", options.recording, "folder of a recording, instead of a file");
    file->excludes(recording);
    app.add_option("--frame", options.frame, "frame of the recording")
        ->check(CLI::Range(0, 1'000'000'000))
        ->capture_default_str()
        ->needs(recording);
    app.add_option("-o,--output", options.output, "write the mesh: .ply, .obj, .gltf or .glb")
        ->check(CLI::Validator(
            [](std::string& text) { return text.empty() ? "must not be empty" : ""; }, ""));
    app.add_option("--threads", options.threads, "threads to compute with")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    app.add_option("--repeat",
                   options.repeat,
                   "compute this often; adds the minimum and median of the total time")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    add_hull_options(app, options);
    app.add_option("--decimate",
                   options.decimate_mm,
                   "leave out vertices while the surface stays within this distance, in "
                   "millimetres; adds decimated_triangles and distance_bound_mm to the report")
        ->check(number_in(1e-3, 1e3));
    app.add_flag("--normals", options.normals, "write vertex normals as well");
    try {
        app.parse(argc, argv);
        if (options.views_file.empty() && options.recording.empty()) {
            throw CLI::RequiredError("a views file or --recording");
        }
    } catch (const CLI::ParseError& error) {
        return {false, app.exit(error) == 0 ? 0 : kExitUsage};
    }
    return {true, 0};
}

}  // namespace atrium::hull_tool
