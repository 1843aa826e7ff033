// The whole site on two cores: eight cameras of one megapixel, from raw pixels in memory to coded
// mesh and textures ready to send, with the threads and slots of site_node. Only the network is
// missing. Metaframes come at a given rate, or one after another.

#include "bench/scenes/site_scene.hpp"
#include "core/base/latest_slot.hpp"
#include "core/base/thread_pool.hpp"
#include "core/base/two_stage_order.hpp"
#include "site_node/capture/metaframe_assembler.hpp"
#include "site_node/capture/pace.hpp"
#include "site_node/pipeline.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <semaphore>
#include <string>
#include <thread>
#include <utility>

namespace atrium::bench {
namespace {

using site_node::SiteFrame;

constexpr double kWarmUp_s = 1.0;

struct Case {
    image::PixelFormat format;
    double rate_hz;  // 0: the next one as soon as the last one is ready
};

const char* name_of(image::PixelFormat format) {
    return format == image::PixelFormat::kBgr ? "BGR" : "BayerRG8";
}

double cpu_ms() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](timeval t) {
        return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
}

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

// The values of one sample of a case; the table shows the median of each column.
struct Column {
    const char* name;
    std::function<double(const SiteFrame&)> value;
};

const std::vector<Column>& columns() {
    static const std::vector<Column> all = {
        {"silhouettes_ms", [](const SiteFrame& f) { return f.milliseconds.silhouettes; }},
        {"hull_ms", [](const SiteFrame& f) { return f.milliseconds.hull; }},
        {"encode_ms", [](const SiteFrame& f) { return f.milliseconds.encode; }},
        {"segmentation_work_ms",
         [](const SiteFrame& f) { return f.work_milliseconds.segmentation; }},
        {"polygons_work_ms", [](const SiteFrame& f) { return f.work_milliseconds.polygons; }},
        {"mesh_work_ms", [](const SiteFrame& f) { return f.work_milliseconds.mesh; }},
        {"textures_work_ms", [](const SiteFrame& f) { return f.work_milliseconds.textures; }},
        {"triangles",
         [](const SiteFrame& f) { return static_cast<double>(f.hull.mesh.triangles.size()); }},
        {"kilobytes",
         [](const SiteFrame& f) {
             std::size_t bytes = f.draco.size();
             for (const auto& c : f.cameras)
                 bytes += c.texture.colour.size() + c.texture.mask.size();
             return 1e-3 * static_cast<double>(bytes);
         }},
    };
    return all;
}

/// Offers, processes and takes results, each on its own thread, as site_node does.
class SiteRun {
public:
    SiteRun(SiteScene& scene, site_node::Pipeline& pipeline, std::size_t num_workers)
        : scene_(scene), pipeline_(pipeline), pool_(num_workers), samples_(columns().size()) {}

    void run(double rate_hz, double seconds) {
        std::jthread ready([this](std::stop_token stop) { take_ready(stop); });
        std::jthread work([this](std::stop_token stop) { compute(stop); });
        pthread_setname_np(work.native_handle(), "work");  // for profilers
        std::jthread silhouettes([this](std::stop_token stop) { find_silhouettes(stop); });
        pthread_setname_np(silhouettes.native_handle(), "silhouettes");
        offer_for(rate_hz, kWarmUp_s);
        begin_measuring();
        offer_for(rate_hz, seconds);
        measuring_ = false;
        seconds_ = seconds_since_begin();
        cpu_ms_ = cpu_ms() - cpu_ms_at_begin_;
        num_late_ = metaframes_.num_dropped() - late_at_begin_;
        // from the last to the first: no thread then waits for one that has ended
        silhouettes = {};
        work = {};
        ready = {};
    }

    double seconds() const { return seconds_; }
    std::uint64_t num_offered() const { return num_offered_; }
    std::uint64_t num_late() const { return num_late_; }
    std::uint64_t num_failed() const { return num_failed_; }
    std::size_t num_ready() const { return latencies_ms_.size(); }
    double latency_ms(double share) const { return quantile(latencies_ms_, share); }
    double core_ms() const {
        return cpu_ms_ / std::max(1.0, static_cast<double>(latencies_ms_.size()));
    }
    double median(std::size_t column) const { return quantile(samples_[column], 0.5); }

private:
    using Clock = std::chrono::steady_clock;

    void begin_measuring() {
        num_offered_ = 0;
        late_at_begin_ = metaframes_.num_dropped();
        begin_ = Clock::now();
        cpu_ms_at_begin_ = cpu_ms();
        measuring_ = true;
    }

    double seconds_since_begin() const {
        return std::chrono::duration<double>(Clock::now() - begin_).count();
    }

    void offer_for(double rate_hz, double seconds) {
        capture::AssemblerOptions options;
        options.tolerance = std::chrono::microseconds(1);
        options.deadline = std::chrono::seconds(1);
        capture::MetaframeAssembler assembler(scene_.rig().cameras.size(), options);
        capture::Pace pace(
            std::chrono::nanoseconds(rate_hz > 0.0 ? static_cast<std::int64_t>(1e9 / rate_hz) : 1));
        const auto end = Clock::now() + std::chrono::duration<double>(seconds);
        while (Clock::now() < end) {
            if (rate_hz > 0.0) {
                pace.wait({});
            } else {
                done_.acquire();
            }
            const Timestamp now = Timestamp::now();
            for (std::size_t camera = 0; camera < scene_.rig().cameras.size(); ++camera) {
                auto metaframe = assembler.add(
                    {camera, now, scene_.picture(instant_, camera), nullptr}, Clock::now());
                if (metaframe) metaframes_.offer(std::move(*metaframe));
            }
            ++instant_;
            ++num_offered_;
        }
    }

    struct Between {
        std::unique_ptr<site_node::Pipeline::Silhouettes> silhouettes;
        ThreadPool::Priority priority;
    };

    void find_silhouettes(std::stop_token stop) {
        while (auto begun = metaframes_.begin(stop)) {
            std::unique_ptr<site_node::Pipeline::Silhouettes> memory;
            if (begun->dropped) memory = std::move(begun->dropped->silhouettes);
            begun->dropped.reset();
            if (memory == nullptr) memory = spare_silhouettes_.try_take().value_or(nullptr);
            if (memory == nullptr) memory = std::make_unique<site_node::Pipeline::Silhouettes>();
            if (pipeline_.find_silhouettes(begun->value, pool_.background(), *memory)) {
                metaframes_.hand_over({std::move(memory), ThreadPool::Priority(pool_)});
            } else {
                ++num_failed_;
                done_.release();
            }
        }
    }

    void compute(std::stop_token stop) {
        while (auto between = metaframes_.take(stop)) {
            auto frame = spare_frames_.try_take().value_or(nullptr);
            if (frame == nullptr) frame = std::make_unique<SiteFrame>();
            if (pipeline_.compute(*between->silhouettes, {}, pool_, *frame)) {
                site_frames_.put(std::move(frame));
            } else {
                ++num_failed_;
            }
            spare_silhouettes_.put(std::move(between->silhouettes));
            done_.release();
        }
    }

    void take_ready(std::stop_token stop) {
        while (auto frame = site_frames_.take(stop)) {
            const auto latency = Timestamp::now() - (*frame)->capture_time;
            if (measuring_) {
                latencies_ms_.push_back(std::chrono::duration<double, std::milli>(latency).count());
                for (std::size_t i = 0; i < samples_.size(); ++i)
                    samples_[i].push_back(columns()[i].value(**frame));
            }
            spare_frames_.put(std::move(*frame));
        }
    }

    SiteScene& scene_;
    site_node::Pipeline& pipeline_;
    ThreadPool pool_;
    TwoStageOrder<capture::Metaframe, Between> metaframes_;
    LatestSlot<std::unique_ptr<site_node::Pipeline::Silhouettes>> spare_silhouettes_;
    LatestSlot<std::unique_ptr<SiteFrame>> site_frames_;
    LatestSlot<std::unique_ptr<SiteFrame>> spare_frames_;
    std::counting_semaphore<> done_{1};  // at full speed: one metaframe at a time

    std::size_t instant_ = 0;
    std::uint64_t num_offered_ = 0;
    std::uint64_t num_late_ = 0;
    std::uint64_t late_at_begin_ = 0;
    std::atomic<std::uint64_t> num_failed_{0};
    std::atomic<bool> measuring_{false};
    Clock::time_point begin_;
    double seconds_ = 0.0;
    double cpu_ms_ = 0.0;
    double cpu_ms_at_begin_ = 0.0;
    std::vector<double> latencies_ms_;
    std::vector<std::vector<double>> samples_;  // [column]
};

// All columns of a case, in the order of the table.
struct Figure {
    const char* name;
    std::string value;
};

std::vector<Figure> figures_of(const Case& c, std::size_t workers, const SiteRun& run) {
    const auto two_digits = [](double value) { return fmt::format("{:.2f}", value); };
    std::vector<Figure> figures = {
        {"format", name_of(c.format)},
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
    for (const Case& c : cases) {
        if (format != c.format) {
            SiteSceneOptions options;
            options.format = c.format;
            auto made = SiteScene::create(options);
            if (!made) return fmt::print(stderr, "{}\n", made.error().message), 1;
            scene = std::move(*made);
            auto created = site_node::Pipeline::create(*scene, {}, {});
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
                                       {PixelFormat::kBgr, 0.0}},
                                      seconds,
                                      workers,
                                      csv);
    if (csv != nullptr) std::fclose(csv);
    return result;
}
