#include "tools/plan/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <random>
#include <tuple>

namespace atrium::plan {
namespace {

constexpr std::int64_t kFirst = -1;  // before all instants

/// Some cores with a queue: the oldest metaframe goes first.
struct Cores {
    struct Task {
        std::size_t host = 0;
        std::int64_t instant = 0;
        double work_ms = 0.0;
        std::function<void()> done;
        std::function<bool()> begin;  // false: a newer one has replaced it
    };
    int num_free = 1;
    double busy_ms = 0.0;
    std::multimap<std::int64_t, Task> waiting;
};

class Play {
public:
    Play(const SitePlan& plan, const SimulationOptions& options)
        : plan_(plan), options_(options), random_(options.seed) {
        period_ms_ = 1e3 / plan.input.rate_hz;
        for (std::size_t i = 0; i < plan.hosts.size(); ++i) {
            num_cameras_ += plan.hosts[i].cameras.size();
            if (plan.hosts[i].is_model) model_ = i;
            if (options.shared_cores > 0) continue;
            cores_.emplace_back().num_free = plan.hosts[i].cores;
        }
        if (options.shared_cores > 0) cores_.emplace_back().num_free = options.shared_cores;
        newest_.resize(num_cameras_, -1);
        num_running_.resize(plan.hosts.size(), 0);
        num_parts_.resize(plan.hosts.size(), 0);
    }

    SimulationResult run() {
        const auto num = static_cast<std::int64_t>(options_.seconds * plan_.input.rate_hz);
        for (std::int64_t instant = 0; instant < num; ++instant)
            at(static_cast<double>(instant) * period_ms_, [this, instant] { capture(instant); });
        while (!events_.empty()) {
            const Event event = events_.top();
            events_.pop();
            now_ms_ = event.time_ms;
            event.what();
        }
        SimulationResult result;
        const double lasted_ms = std::max(now_ms_, 1.0);
        result.metaframes_per_s = 1e3 * static_cast<double>(latencies_ms_.size()) / lasted_ms;
        result.dropped = 1.0 - static_cast<double>(latencies_ms_.size()) /
                                   static_cast<double>(std::max<std::int64_t>(num, 1));
        std::ranges::sort(latencies_ms_);
        if (!latencies_ms_.empty()) {
            result.median_ms = latencies_ms_[latencies_ms_.size() / 2];
            result.p99_ms = latencies_ms_[latencies_ms_.size() * 99 / 100];
        }
        for (std::size_t i = 0; i < cores_.size(); ++i) {
            const int num_cores =
                options_.shared_cores > 0 ? options_.shared_cores : plan_.hosts[i].cores;
            result.loads.push_back(cores_[i].busy_ms / lasted_ms / num_cores);
        }
        return result;
    }

private:
    struct Event {
        double time_ms = 0.0;
        std::uint64_t order = 0;
        std::function<void()> what;
        bool operator<(const Event& other) const {
            return std::tie(time_ms, order) > std::tie(other.time_ms, other.order);
        }
    };

    void at(double time_ms, std::function<void()> what) {
        events_.push({time_ms, num_events_++, std::move(what)});
    }
    Cores& cores_of(std::size_t host) { return cores_[options_.shared_cores > 0 ? 0 : host]; }
    // of one program, however many share its cores
    int threads_of(std::size_t host) const {
        return options_.shared_cores > 0 ? threads_on(plan_.input, options_.shared_cores)
                                         : plan_.hosts[host].threads;
    }
    double varied(double work_ms) {
        return work_ms * std::lognormal_distribution<>(0.0, options_.spread)(random_);
    }
    double work_ms(std::size_t host, const std::string& name) const {
        for (const Stage& stage : plan_.hosts[host].stages) {
            if (stage.name == name) return stage.work_ms;
        }
        return 0.0;
    }

    void add(Cores::Task task) {
        Cores& cores = cores_of(task.host);
        const std::int64_t instant = task.instant;
        cores.waiting.emplace(instant, std::move(task));
        begin_tasks(cores);
    }
    void begin_tasks(Cores& cores) {
        for (auto next = cores.waiting.begin();
             cores.num_free > 0 && next != cores.waiting.end();) {
            const std::size_t host = next->second.host;
            if (num_running_[host] >= threads_of(host)) {
                ++next;
                continue;
            }
            Cores::Task task = std::move(next->second);
            next = cores.waiting.erase(next);
            if (task.begin && !task.begin()) continue;
            --cores.num_free;
            ++num_running_[host];
            cores.busy_ms += task.work_ms;
            at(now_ms_ + task.work_ms, [this, &cores, host, done = std::move(task.done)] {
                ++cores.num_free;
                --num_running_[host];
                done();
                begin_tasks(cores);
            });
        }
    }

    void capture(std::int64_t instant) {
        std::size_t camera = 0;
        for (std::size_t h = 0; h < plan_.hosts.size(); ++h) {
            const auto num = static_cast<double>(plan_.hosts[h].cameras.size());
            for (std::size_t i = 0; i < plan_.hosts[h].cameras.size(); ++i, ++camera) {
                newest_[camera] = instant;
                const double own_ms =
                    varied((work_ms(h, "silhouettes") + work_ms(h, "messages")) / num);
                add({h,
                     instant,
                     own_ms,
                     [this, h, instant, num] {
                         at(now_ms_ + (plan_.hosts.size() > 1 ? kWay_ms : 0.0),
                            [this, instant] { take(instant); });
                         add({h, instant, varied(work_ms(h, "textures") / num), [] {}, {}});
                     },
                     [this, camera, instant] { return newest_[camera] == instant; }});
            }
        }
    }

    // The silhouettes of one camera reach the model part. With cameras of its own, their work has
    // that of its messages.
    void take(std::int64_t instant) {
        const bool has_cameras = !plan_.hosts[model_].cameras.empty();
        const double messages_ms =
            has_cameras ? 0.0 : work_ms(model_, "messages") / static_cast<double>(num_cameras_);
        if (messages_ms <= 0.0) return arrive(instant);
        // a thread of its own takes them: none waits behind older hulls
        add({model_, kFirst, varied(messages_ms), [this, instant] { arrive(instant); }, {}});
    }

    void arrive(std::int64_t instant) {
        if (++num_arrived_[instant] < num_cameras_) return;
        num_arrived_.erase(num_arrived_.begin(), num_arrived_.upper_bound(instant));
        next_ = instant;  // replaces one that still waits
        if (!is_model_busy_) begin_model();
    }

    // The hulls of all hosts that compute some; then the mesh is there.
    void begin_model() {
        if (next_ < 0) return;
        const std::int64_t instant = std::exchange(next_, -1);
        is_model_busy_ = true;
        // the model part takes the meshes of others when its own work is done
        num_hulls_ = 1 + std::ranges::count_if(plan_.hosts, [](const HostPlan& host) {
                         return !host.is_model && !host.regions.empty();
                     });
        for (std::size_t h = 0; h < plan_.hosts.size(); ++h) {
            if (h == model_)
                begin_hull(h, instant);
            else if (!plan_.hosts[h].regions.empty())
                at(now_ms_ + plan_.order_ms, [this, h, instant] { begin_hull(h, instant); });
        }
    }
    // Messages where no cameras have them, a serial part, then one task per thread; then the mesh.
    void begin_hull(std::size_t host, std::int64_t instant) {
        const double messages_ms = host == model_ || !plan_.hosts[host].cameras.empty()
                                       ? 0.0
                                       : varied(work_ms(host, "messages"));
        const int threads = threads_of(host);
        const double hull_ms = varied(work_ms(host, "hull"));
        const double serial = std::clamp(2.0 / plan_.input.costs.hull_two_threads - 1.0, 0.0, 1.0);
        add({host,
             instant,
             messages_ms + serial * hull_ms,
             [this, host, instant, threads, hull_ms, serial] {
                 num_parts_[host] = threads;
                 for (int i = 0; i < threads; ++i)
                     add({host,
                          instant,
                          (1.0 - serial) * hull_ms / threads,
                          [this, host, instant] { end_part(host, instant); },
                          {}});
             },
             {}});
    }
    void end_part(std::size_t host, std::int64_t instant) {
        if (--num_parts_[host] > 0) return;
        add({host,
             instant,
             varied(work_ms(host, "mesh")),
             [this, host, instant] {
                 at(now_ms_ + (host == model_ ? 0.0 : kWay_ms),
                    [this, instant] { end_hull(instant); });
             },
             {}});
    }
    void end_hull(std::int64_t instant) {
        if (--num_hulls_ > 0) return;
        latencies_ms_.push_back(now_ms_ - static_cast<double>(instant) * period_ms_);
        is_model_busy_ = false;
        begin_model();
    }

    const SitePlan& plan_;
    SimulationOptions options_;
    std::mt19937_64 random_;
    double period_ms_ = 0.0;
    double now_ms_ = 0.0;
    std::priority_queue<Event> events_;
    std::uint64_t num_events_ = 0;
    std::vector<Cores> cores_;
    std::size_t model_ = 0;
    std::size_t num_cameras_ = 0;
    std::vector<std::int64_t> newest_;  // per camera
    std::vector<int> num_running_;      // tasks of each host
    std::map<std::int64_t, std::size_t> num_arrived_;
    std::int64_t next_ = -1;
    bool is_model_busy_ = false;
    std::vector<int> num_parts_;    // of the hulls of each host
    std::ptrdiff_t num_hulls_ = 0;  // hosts that have not finished theirs
    std::vector<double> latencies_ms_;
};

}  // namespace

SimulationResult simulate(const SitePlan& plan, const SimulationOptions& options) {
    return Play(plan, options).run();
}

}  // namespace atrium::plan
