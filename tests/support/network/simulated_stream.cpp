#include "tests/support/network/simulated_stream.hpp"

#include "viewer/receive/feedback.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <queue>
#include <random>
#include <tuple>

namespace atrium::test {
namespace {

using Random = std::mt19937_64;

constexpr double kDatagramBytes = 1344.0;
const std::string kSite = "site";
constexpr double kTick_s = 0.001;
constexpr double kLookAgain_s = 0.005;  // as viewer/receive/session.cpp

stream::Time at(double seconds) {
    return stream::Time{} + std::chrono::duration_cast<stream::Time::duration>(
                                std::chrono::duration<double>(seconds));
}

// Time stamp of `seconds` on a clock with this offset, in a world that starts in the year 2001.
Timestamp on_clock(double seconds, double offset_ms) {
    return Timestamp{1'000'000'000'000'000'000 +
                     static_cast<std::int64_t>(1e9 * seconds + 1e6 * offset_ms)};
}

double uniform(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

// The true size of colours relative to the best level. It differs from the controller's first
// estimate.
double true_ratio(const stream::Level& level) {
    const double quality = std::pow(level.jpeg_quality / 85.0, 1.15);
    return quality * (level.colour_divisor == 2 ? 0.28 : 1.0);
}

// Waits and runs in turn, for the durations of the two functions. All durations are drawn at the
// start, because calls repeat times and can go back.
Runs in_turn(const std::function<double()>& next_wait_s,
             const std::function<double()>& next_run_s) {
    constexpr double kLength_s = 600.0;
    std::vector<double> changes{0.0};  // waits from the even ones on
    while (changes.back() < kLength_s) {
        changes.push_back(changes.back() + next_wait_s());
        changes.push_back(changes.back() + next_run_s());
    }
    return [changes](double time_s) {
        const auto after = std::upper_bound(changes.begin(), changes.end(), time_s);
        return (after - changes.begin()) % 2 == 0;
    };
}

struct Sample {
    double arrival_s;
    double written_s;
    double bytes;
    std::size_t frame;  // index into StreamRecord::sent
    bool operator>(const Sample& other) const {
        return std::tie(arrival_s, frame) > std::tie(other.arrival_s, other.frame);
    }
};

struct FrameState {
    int num_missing;
    double bytes;
};

// One direction: a queue of bytes that drains at the link's rate and delivers in order per writer.
class Way {
public:
    Way(const SimulatedLink& link, const SimulatedSite& site, std::uint64_t seed)
        : link_(&link), site_(&site), random_(seed) {}

    void send(double now_s, std::size_t frame, double fixed, double colour) {
        const int num_samples = site_->num_cameras + 1;
        frames_.resize(frame + 1, {0, 0.0});
        frames_[frame] = {num_samples, fixed + colour};
        // textures first: a sixth of the fixed bytes are masks
        const double texture_bytes = (colour + fixed / 6.0) / site_->num_cameras;
        for (int camera = 0; camera < site_->num_cameras; ++camera)
            send_sample(now_s, frame, texture_bytes, 0);
        send_sample(now_s, frame, fixed * 5.0 / 6.0, 1);
    }

    void receive(double now_s, const StreamRecord& record, ViewerRecord& viewer) {
        if (link_->is_paused(now_s)) {
            while (is_in_socket(now_s)) under_way_.pop();
            return;
        }
        if (link_->receiver_runs(now_s)) {
            for (; is_in_socket(now_s); under_way_.pop()) in_reader_.push(under_way_.top());
        }
        const bool looks = !in_reader_.empty() || now_s - looked_s_ >= kLookAgain_s;
        if (!looks || !link_->taker_runs(now_s)) return;
        looked_s_ = now_s;
        for (; !in_reader_.empty(); in_reader_.pop())
            take(in_reader_.front(), now_s, record, viewer);
        feedback_.looked(by_viewer(now_s), !is_in_socket(now_s));
    }

    // Reports everything received since the last report. It reaches the site after the link's
    // delay.
    void report(double now_s) {
        if (link_->is_paused(now_s) || !link_->taker_runs(now_s)) return;
        feedback_.report(link_->viewer, by_viewer(now_s), [&](const bus::StreamFeedback& feedback) {
            reports_.push({now_s + 1e-3 * link_->delay_ms,
                           {feedback.num_complete,
                            feedback.num_incomplete,
                            feedback.num_samples,
                            8.0 * feedback.payload_bytes_per_s,
                            feedback.min_delay_ms,
                            feedback.sure_delay_ms,
                            feedback.longest_wait_ms}});
        });
    }

    std::optional<stream::LinkReport> take_report(double now_s) {
        if (reports_.empty() || reports_.front().first > now_s) return std::nullopt;
        const stream::LinkReport report = reports_.front().second;
        reports_.pop();
        return report;
    }

private:
    Timestamp by_viewer(double now_s) const {
        return on_clock(now_s, link_->clock_offset_ms(now_s));
    }

    bool is_in_socket(double now_s) const {
        return !under_way_.empty() && under_way_.top().arrival_s <= now_s;
    }

    void take(const Sample& sample,
              double now_s,
              const StreamRecord& record,
              ViewerRecord& viewer) {
        const Timestamp now = by_viewer(now_s);
        const Timestamp written = on_clock(sample.written_s, 0.0);
        const auto num_bytes = static_cast<std::size_t>(sample.bytes);
        feedback_.arrived(kSite, written, written, num_bytes, now);
        FrameState& frame = frames_[sample.frame];
        if (--frame.num_missing > 0 || sample.frame < next_) return;
        feedback_.lost(kSite, sample.frame - next_, 0);
        viewer.num_incomplete += static_cast<int>(sample.frame - next_);
        next_ = sample.frame + 1;
        feedback_.completed(kSite, sample.frame, written, now);
        viewer.arrived.push_back(
            {now_s, 1e3 * (now_s - record.sent[sample.frame].time_s), frame.bytes});
    }

    void send_sample(double written_s, std::size_t frame, double bytes, std::size_t writer) {
        const double now_s = std::max(written_s, interrupted_until_s_);
        if (site_->interrupted > 0.0 && uniform(random_, 0.0, 1.0) < site_->interrupted)
            interrupted_until_s_ = now_s + uniform(random_, 0.004, 0.024);
        put_on_way(now_s, std::max(now_s, interrupted_until_s_), frame, bytes, writer);
    }

    void put_on_way(
        double written_s, double now_s, std::size_t frame, double bytes, std::size_t writer) {
        busy_until_s_ = std::max(busy_until_s_, now_s);
        if (busy_until_s_ - now_s > 1e-3 * link_->buffer_ms) return;  // its frame stays incomplete
        busy_until_s_ += 8.0 * bytes / link_->bit_per_s(now_s);
        double arrival_s = busy_until_s_ + 1e-3 * link_->delay_ms +
                           1e-3 * uniform(random_, -link_->jitter_ms, link_->jitter_ms);
        const double num_datagrams = std::ceil(bytes / kDatagramBytes);
        const double all_arrive = std::pow(1.0 - link_->loss, num_datagrams);
        if (uniform(random_, 0.0, 1.0) > all_arrive) arrival_s += 2.1e-3 * link_->delay_ms;
        arrival_s = std::max(arrival_s, last_arrival_s_[writer]);
        last_arrival_s_[writer] = arrival_s;
        under_way_.push({arrival_s, written_s, bytes, frame});
    }

    const SimulatedLink* link_;
    const SimulatedSite* site_;
    Random random_;
    double busy_until_s_ = 0.0;
    double last_arrival_s_[2] = {0.0, 0.0};
    std::priority_queue<Sample, std::vector<Sample>, std::greater<>> under_way_;
    double interrupted_until_s_ = 0.0;
    std::queue<Sample> in_reader_;
    double looked_s_ = 0.0;
    std::vector<FrameState> frames_;
    std::size_t next_ = 0;  // first frame that can still become complete
    viewer::Feedback feedback_;
    std::queue<std::pair<double, stream::LinkReport>> reports_;
};

double default_colour_bytes(double time_s) {
    // 20 to 40 Mbit/s at 30 Hz, of which 2.9 are fixed
    return (30e6 + 9e6 * std::sin(2.0 * std::numbers::pi * time_s / 20.0)) / 8.0 / 30.0 - 12e3;
}

}  // namespace

Runs with_quota(double share, std::uint64_t seed) {
    constexpr double kPeriod_s = 0.1;
    const auto random = std::make_shared<Random>(seed);
    const auto run_s = std::make_shared<double>(0.0);
    return in_turn(
        [=] {
            *run_s = share * kPeriod_s / uniform(*random, 1.0, 2.0);
            return kPeriod_s - *run_s;
        },
        [=] { return *run_s; });
}

Runs beside_busy_loops(std::uint64_t seed) {
    const auto random = std::make_shared<Random>(seed);
    return in_turn([=] { return uniform(*random, 0.004, 0.024); },
                   [=] { return uniform(*random, 0.0005, 0.010); });
}

Runs with_freezes(std::uint64_t seed) {
    const auto random = std::make_shared<Random>(seed);
    return in_turn([=] { return 0.5; }, [=] { return uniform(*random, 2.0, 5.0); });
}

StreamRecord simulate(const SimulatedSite& site,
                      const std::vector<SimulatedLink>& links,
                      double seconds) {
    stream::RateController controller(site.jpeg_quality, site.rate_hz);
    stream::ViewerLinks viewers(site.options);
    StreamRecord record;
    record.ladder = controller.ladder();
    record.viewers.resize(links.size());
    Random random(site.seed);
    std::vector<Way> ways;
    for (const SimulatedLink& link : links) ways.emplace_back(link, site, random());
    double next_frame_s = 0.0;
    for (int tick = 0; tick * kTick_s < seconds; ++tick) {
        const double now_s = tick * kTick_s;
        for (std::size_t i = 0; i < ways.size(); ++i) {
            ways[i].receive(now_s, record, record.viewers[i]);
            ways[i].report(now_s);
        }
        if (now_s < next_frame_s || !site.runs(now_s)) continue;
        while (next_frame_s <= now_s) next_frame_s += 1.0 / site.rate_hz;  // the newest wins
        for (std::size_t i = 0; i < ways.size(); ++i) {
            while (const auto report = ways[i].take_report(now_s))
                viewers.add(links[i].viewer, *report, controller.next_bit_per_s(), at(now_s));
        }
        const stream::StreamCap cap = viewers.cap(at(now_s));
        controller.set_cap(cap.cap);
        const std::size_t before = controller.level();
        const auto level = controller.offer(at(now_s));
        if (controller.level() != before)
            record.steps.push_back({now_s, before, controller.level(), std::string(cap.set_by)});
        const double best =
            site.colour_bytes ? site.colour_bytes(now_s) : default_colour_bytes(now_s);
        record.caps.push_back(
            {now_s, cap.cap.bit_per_s, 8.0 * (best + site.fixed_bytes) * site.rate_hz});
        if (!level) continue;
        const double colour =
            best * true_ratio(controller.ladder()[*level]) * uniform(random, 0.95, 1.05);
        record.sent.push_back({now_s, *level, site.fixed_bytes + colour});
        for (Way& way : ways) way.send(now_s, record.sent.size() - 1, site.fixed_bytes, colour);
        controller.coded(
            *level,
            {static_cast<std::size_t>(site.fixed_bytes), static_cast<std::size_t>(colour)},
            at(now_s));
    }
    return record;
}

namespace {

std::vector<double> ages_ms(const ViewerRecord& viewer, double from_s, double to_s) {
    std::vector<double> ages;
    for (const ArrivedFrame& frame : viewer.arrived) {
        if (frame.time_s >= from_s && frame.time_s < to_s) ages.push_back(frame.age_ms);
    }
    return ages;
}

}  // namespace

double max_age_ms(const ViewerRecord& viewer, double from_s, double to_s) {
    const std::vector<double> ages = ages_ms(viewer, from_s, to_s);
    return ages.empty() ? std::numeric_limits<double>::infinity()
                        : *std::max_element(ages.begin(), ages.end());
}

double median_age_ms(const ViewerRecord& viewer, double from_s, double to_s) {
    std::vector<double> ages = ages_ms(viewer, from_s, to_s);
    if (ages.empty()) return std::numeric_limits<double>::infinity();
    const auto middle = ages.begin() + static_cast<std::ptrdiff_t>(ages.size() / 2);
    std::nth_element(ages.begin(), middle, ages.end());
    return *middle;
}

double carried_bit_per_s(const ViewerRecord& viewer, double from_s, double to_s) {
    double bytes = 0.0;
    for (const ArrivedFrame& frame : viewer.arrived) {
        if (frame.time_s >= from_s && frame.time_s < to_s) bytes += frame.bytes;
    }
    return 8.0 * bytes / (to_s - from_s);
}

double sent_bit_per_s(const StreamRecord& record, double from_s, double to_s) {
    double bytes = 0.0;
    for (const SentFrame& frame : record.sent) {
        if (frame.time_s >= from_s && frame.time_s < to_s) bytes += frame.bytes;
    }
    return 8.0 * bytes / (to_s - from_s);
}

int num_steps(const StreamRecord& record, double from_s, double to_s) {
    return static_cast<int>(
        std::count_if(record.steps.begin(), record.steps.end(), [&](const Step& step) {
            return step.time_s >= from_s && step.time_s < to_s;
        }));
}

double busiest_second_bits(const StreamRecord& record) {
    double busiest = 0.0;
    for (std::size_t begin = 0; begin < record.sent.size(); ++begin) {
        double bytes = 0.0;
        double largest = 0.0;
        for (std::size_t i = begin; i < record.sent.size(); ++i) {
            if (record.sent[i].time_s - record.sent[begin].time_s >= 1.0) break;
            bytes += record.sent[i].bytes;
            largest = std::max(largest, record.sent[i].bytes);
        }
        busiest = std::max(busiest, 8.0 * (bytes - largest));
    }
    return busiest;
}

}  // namespace atrium::test
