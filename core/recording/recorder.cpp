#include "core/recording/recorder.hpp"

#include "core/base/named_thread.hpp"
#include "core/recording/topic_roles.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace atrium::recording {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kTakePeriod{200};
constexpr std::chrono::microseconds kBurst{1000};
constexpr std::chrono::milliseconds kWritePeriod{100};  // earlier if much waits
constexpr std::chrono::seconds kNotePeriod{1};
// The memory of a sample besides its bytes.
constexpr std::uint64_t kSampleOverhead = 128;

bool is_wanted(const bus::RawTopic& topic, const std::set<std::string>& topics) {
    // A world server computes it only for those who read it.
    if (topics.empty()) return topic.name() != "PersonProxy";
    return topics.contains(std::string(topic.name()));
}

}  // namespace

Recorder::Recorder(RecorderOptions options,
                   WorldWriter writer,
                   bus::Waiter waiter,
                   std::vector<Source> sources)
    : options_(std::move(options)),
      writer_(std::move(writer)),
      waiter_(std::move(waiter)),
      sources_(std::move(sources)) {}

Recorder::~Recorder() = default;

Expected<std::unique_ptr<Recorder>> Recorder::create(const bus::Participant& participant,
                                                     RecorderOptions options) {
    for (const std::string& name : options.topics) {
        if (bus::find_raw_topic(name) != nullptr) continue;
        std::string names;
        for (const bus::RawTopic* topic : bus::raw_topics())
            names += fmt::format("{}{}", names.empty() ? "" : ", ", topic->name());
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("topics: '{}' is none; there are {}", name, names));
    }
    auto waiter = bus::Waiter::create(participant);
    if (!waiter) return tl::unexpected(waiter.error());
    std::vector<Source> sources;
    for (const bus::RawTopic* topic : bus::raw_topics()) {
        if (!is_wanted(*topic, options.topics)) continue;
        auto reader = topic->reader(participant);
        if (!reader) return tl::unexpected(reader.error());
        (*reader)->add_to(*waiter);
        sources.push_back({topic, std::move(*reader)});
    }
    auto writer = WorldWriter::create(options.writer);
    if (!writer) return tl::unexpected(writer.error());
    return std::unique_ptr<Recorder>(new Recorder(
        std::move(options), std::move(*writer), std::move(*waiter), std::move(sources)));
}

Timestamp Recorder::now() const { return begin_ + (Clock::now() - steady_begin_); }

void Recorder::receive(const bus::RawTopic& topic, const bus::RawSample& sample) {
    // The key costs a copy of the sample: only where it is needed.
    if (!options_.sites.empty() || is_kept(topic)) {
        const auto key = topic.key_of(sample);
        if (!key) {
            const std::lock_guard lock(mutex_);
            ++counters_.num_rejected;
            return;
        }
        const auto site = site_of(topic, *key);
        if (site && !options_.sites.empty() && !options_.sites.contains(*site)) {
            if (topic.name() != "SiteDescription") return;
            const std::lock_guard lock(mutex_);
            counters_.other_sites.insert(*site);
            return;
        }
        if (site && topic.name() == "SiteDescription") {
            const std::lock_guard lock(mutex_);
            counters_.sites.insert(*site);
        }
    }
    // As for the line: a reader may hold thousands of samples of hostile programs.
    const std::uint64_t size = sample.cdr.size() + kSampleOverhead;
    if (batch_bytes_ + size > options_.buffer_bytes) {
        const std::lock_guard lock(mutex_);
        drop(topic);
        return;
    }
    batch_bytes_ += size;
    batch_.push_back({&topic,
                      sample.kind,
                      {},
                      sample.written,
                      std::vector<std::byte>(sample.cdr.begin(), sample.cdr.end())});
}

// Textures go before meshes, as their sites write them: a mesh was taken before the textures, thus
// its textures are among them, or were taken earlier.
void Recorder::put_in_line() {
    std::stable_partition(batch_.begin(), batch_.end(), [](const Recorded& one) {
        return one.topic->name() != "SiteMesh";
    });
    const std::lock_guard lock(mutex_);
    for (Recorded& sample : batch_) {
        sample.time = now();
        const std::uint64_t size = sample.cdr.size() + kSampleOverhead;
        // The last quarter is for what is kept: without it, what follows would show nothing.
        const std::uint64_t room =
            options_.buffer_bytes - (is_kept(*sample.topic) ? 0 : options_.buffer_bytes / 4);
        if (waiting_bytes_ + size > room || is_over_) {
            drop(*sample.topic);
            continue;
        }
        waiting_bytes_ += size;
        line_.push_back(std::move(sample));
    }
    batch_.clear();
    batch_bytes_ = 0;
}

void Recorder::drop(const bus::RawTopic& topic) {
    ++counters_.num_dropped;
    ++counters_.dropped[std::string(topic.name())];
}

void Recorder::take() {
    for (Source& source : sources_) {
        const bus::TakeReport report = source.reader->take(
            [&](const bus::RawSample& sample) { receive(*source.topic, sample); });
        if (report.num_rejected == 0) continue;
        const std::lock_guard lock(mutex_);
        counters_.num_rejected += report.num_rejected;
    }
    put_in_line();
}

Expected<void> Recorder::run(std::stop_token stop) {
    const std::stop_callback wake(stop, [this] { waiter_.wake(); });
    {
        const std::jthread writing =
            named_thread("write", [this](const std::stop_token&) { write_until_stopped(); });
        while (!stop.stop_requested()) {
            // A frame is ten samples that come one after the other: taken at once they cost a
            // third.
            if (waiter_.wait(kTakePeriod)) std::this_thread::sleep_for(kBurst);
            take();
            const std::lock_guard lock(mutex_);
            if (!written_) break;
            if (waiting_bytes_ > options_.buffer_bytes / 4) changed_.notify_one();
        }
        const std::lock_guard lock(mutex_);
        is_over_ = true;
        changed_.notify_one();
    }
    const std::lock_guard lock(mutex_);
    return written_;
}

Expected<void> Recorder::check_disk() {
    std::error_code failure;
    const auto space = std::filesystem::space(
        std::filesystem::absolute(options_.writer.file).parent_path(), failure);
    if (failure || space.available >= options_.spare_disk_bytes) return {};
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("{}: the disk is full: {} MiB are left free; the recording ends "
                                  "here and is complete up to here",
                                  writer_.files().back().string(),
                                  options_.spare_disk_bytes >> 20U));
}

std::string Recorder::note() const {
    const std::lock_guard lock(mutex_);
    return nlohmann::json{{"num_samples", counters_.num_samples},
                          {"num_dropped", counters_.num_dropped},
                          {"dropped", counters_.dropped},
                          {"num_rejected", counters_.num_rejected},
                          {"waiting_bytes", waiting_bytes_}}
        .dump();
}

void Recorder::write_until_stopped() {
    Clock::time_point note_due = Clock::now() + kNotePeriod;
    Expected<void> done;
    while (done) {
        std::deque<Recorded> samples;
        bool is_last = false;
        {
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, kWritePeriod, [&] {
                return is_over_ || waiting_bytes_ > options_.buffer_bytes / 4;
            });
            samples = std::exchange(line_, {});
            is_last = is_over_;
        }
        while (done && !samples.empty()) {
            const Recorded& sample = samples.front();
            done = writer_.write(sample);
            const std::lock_guard lock(mutex_);
            waiting_bytes_ -= sample.cdr.size() + kSampleOverhead;
            ++counters_.num_samples;  // unless the writer tells that it lost it
            counters_.num_bytes += sample.cdr.size();
            samples.pop_front();
        }
        if (!done) {
            const std::lock_guard lock(mutex_);
            for (const Recorded& sample : samples) drop(*sample.topic);
        }
        const Clock::time_point now = Clock::now();
        if (done) done = writer_.flush_due(now);
        if (done && (now >= note_due || is_last)) {
            note_due = now + kNotePeriod;
            done = writer_.note(Recorder::now(), note());
            if (done) done = check_disk();
        }
        {
            const std::lock_guard lock(mutex_);
            counters_.file_bytes = writer_.num_bytes();
            counters_.files = writer_.files();
        }
        if (is_last) break;
    }
    // After an error, too: the chunks that are there get their summary, if there is room for it.
    const Expected<void> finished = writer_.finish();
    if (done) done = finished;
    const std::lock_guard lock(mutex_);
    counters_.file_bytes = writer_.num_bytes();
    counters_.files = writer_.files();
    for (const auto& [topic, num] : writer_.lost()) {
        counters_.num_samples -= std::min(counters_.num_samples, num);
        counters_.num_dropped += num;
        counters_.dropped[topic] += num;
    }
    if (!done) {
        for (const Recorded& sample : std::exchange(line_, {})) drop(*sample.topic);
        waiting_bytes_ = 0;
        is_over_ = true;
        written_ = std::move(done);
        waiter_.wake();
    }
}

RecorderCounters Recorder::counters() const {
    const std::lock_guard lock(mutex_);
    RecorderCounters counters = counters_;
    counters.waiting_bytes = waiting_bytes_;
    return counters;
}

}  // namespace atrium::recording
