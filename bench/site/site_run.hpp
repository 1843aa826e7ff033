#pragma once

#include "bench/scenes/site_scene.hpp"
#include "core/base/latest_slot.hpp"
#include "core/base/thread_pool.hpp"
#include "core/base/two_stage_order.hpp"
#include "site_node/capture/metaframe_assembler.hpp"
#include "site_node/capture/pace.hpp"
#include "site_node/pipeline.hpp"

#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <semaphore>
#include <string>
#include <thread>
#include <utility>
#include <vector>

// The whole site without its network, for benchmarks.
namespace atrium::bench {

using site_node::SiteFrame;

inline constexpr double kWarmUp_s = 1.0;

inline double cpu_ms() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](timeval t) {
        return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
}

inline double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

/// The values of one sample of a case; the table shows the median of each column.
struct Column {
    const char* name;
    std::function<double(const SiteFrame&)> value;
};

inline const std::vector<Column>& columns() {
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
    /// `on_picture` is called with each picture, before the site gets it.
    SiteRun(SiteScene& scene,
            site_node::Pipeline& pipeline,
            std::size_t num_workers,
            std::function<void(const capture::CameraFrame&)> on_picture = {})
        : scene_(scene),
          pipeline_(pipeline),
          pool_(num_workers),
          on_picture_(std::move(on_picture)),
          samples_(columns().size()) {}

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
                capture::CameraFrame frame{camera, now, scene_.picture(instant_, camera), nullptr};
                if (on_picture_) on_picture_(frame);
                auto metaframe = assembler.add(std::move(frame), Clock::now());
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
    std::function<void(const capture::CameraFrame&)> on_picture_;
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

}  // namespace atrium::bench
