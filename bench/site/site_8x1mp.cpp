// The whole site on two cores: eight cameras of one megapixel, from raw pixels in memory to coded
// mesh and textures ready to send, with the threads and slots of site_node. Only the network is
// missing. Metaframes come at a given rate, or one after another.

#include "bench/site/site_run.hpp"
#include "site_node/start_check.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

namespace atrium::bench {
namespace {

struct Case {
    image::PixelFormat format;
    double rate_hz;              // 0: the next one as soon as the last one is ready
    std::string refine = "off";  // the hull, as hull.refine
};

std::string name_of(const Case& c) {
    std::string name = c.format == image::PixelFormat::kBgr ? "BGR" : "BayerRG8";
    return c.refine == "off" ? name : name + " " + c.refine;
}

// All columns of a case, in the order of the table.
struct Figure {
    const char* name;
    std::string value;
};

std::vector<Figure> figures_of(const Case& c, std::size_t workers, const SiteRun& run) {
    const auto two_digits = [](double value) { return fmt::format("{:.2f}", value); };
    std::vector<Figure> figures = {
        {"format", name_of(c)},
        {"offered_hz", fmt::format("{:g}", c.rate_hz)},  // 0: one after another
        {"workers", std::to_string(workers)},
        {"seconds", fmt::format("{:.1f}", run.seconds())},
        {"offered", std::to_string(run.num_offered())},
        {"ready", std::to_string(run.num_ready())},
        {"late", std::to_string(run.num_late())},
        {"failed", std::to_string(run.num_failed())},
        {"rate_hz", two_digits(static_cast<double>(run.num_ready()) / run.seconds())},
        {"median_ms", two_digits(run.latency_ms(0.5))},
        {"p90_ms", two_digits(run.latency_ms(0.9))},
        {"p99_ms", two_digits(run.latency_ms(0.99))},
        {"max_ms", two_digits(run.latency_ms(1.0))},
        {"core_ms", two_digits(run.core_ms())},
    };
    for (std::size_t i = 0; i < columns().size(); ++i)
        figures.push_back({columns()[i].name, two_digits(run.median(i))});
    return figures;
}

void print(const std::vector<Figure>& figures) {
    for (const Figure& figure : figures) fmt::print("{} {}  ", figure.name, figure.value);
    fmt::print("\n");
    std::fflush(stdout);
}

// The cases, with the column names above the first one.
void write(const std::vector<Figure>& figures, bool is_first, std::FILE* csv) {
    const auto line = [&](const auto& text_of) {
        for (std::size_t i = 0; i < figures.size(); ++i)
            fmt::print(csv, "{}{}", i == 0 ? "" : ",", text_of(figures[i]));
        fmt::print(csv, "\n");
    };
    if (is_first) line([](const Figure& figure) { return figure.name; });
    line([](const Figure& figure) { return figure.value; });
}

int measure(const std::vector<Case>& cases, double seconds, std::size_t workers, std::FILE* csv) {
    bool is_first = true;
    std::optional<SiteScene> scene;
    std::optional<site_node::Pipeline> pipeline;
    std::optional<image::PixelFormat> format;
    std::string refine;
    for (const Case& c : cases) {
        if (format != c.format || refine != c.refine) {
            SiteSceneOptions options;
            options.format = c.format;
            auto made = SiteScene::create(options);
            if (!made) return fmt::print(stderr, "{}\n", made.error().message), 1;
            scene = std::move(*made);
            site_node::PipelineOptions pipeline_options;
            pipeline_options.hull.refine = refine = c.refine;
            site_node::take_bounds(scene->rig(), pipeline_options.hull);
            auto created = site_node::Pipeline::create(*scene, pipeline_options, {});
            if (!created) return fmt::print(stderr, "{}\n", created.error().message), 1;
            pipeline = std::move(*created);
            format = c.format;
        }
        SiteRun run(*scene, *pipeline, workers);
        run.run(c.rate_hz, seconds);
        const std::vector<Figure> figures = figures_of(c, workers, run);
        print(figures);
        if (csv != nullptr) write(figures, std::exchange(is_first, false), csv);
        if (run.num_failed() > 0 || run.num_ready() == 0) return 1;
    }
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) {
    using namespace atrium;
    if (argc > 4 || (argc > 1 && std::atof(argv[1]) <= 0.0)) {
        std::fputs("usage: site_8x1mp [SECONDS of each case, 8] [CSV] [WORKERS, 2]\n", stderr);
        return 2;
    }
    const double seconds = argc > 1 ? std::atof(argv[1]) : 8.0;
    const auto workers = static_cast<std::size_t>(argc > 3 ? std::max(std::atoi(argv[3]), 1) : 2);
    std::FILE* csv = argc > 2 ? std::fopen(argv[2], "a") : nullptr;
    if (argc > 2 && csv == nullptr) return std::perror(argv[2]), 1;
    using image::PixelFormat;
    const int result = bench::measure({{PixelFormat::kBayerRG, 30.0},
                                       {PixelFormat::kBayerRG, 60.0},
                                       {PixelFormat::kBayerRG, 0.0},
                                       {PixelFormat::kBgr, 60.0},
                                       {PixelFormat::kBgr, 0.0},
                                       {PixelFormat::kBayerRG, 30.0, "photo"},
                                       {PixelFormat::kBayerRG, 0.0, "photo"},
                                       {PixelFormat::kBayerRG, 30.0, "round_photo"},
                                       {PixelFormat::kBayerRG, 0.0, "round_photo"}},
                                      seconds,
                                      workers,
                                      csv);
    if (csv != nullptr) std::fclose(csv);
    return result;
}
