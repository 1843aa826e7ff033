#include "tools/record/record.hpp"

#include "core/app/lasting_log.hpp"
#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/base/split_list.hpp"
#include "core/base/write_check.hpp"
#include "core/bus/bus_options.hpp"
#include "core/bus/names.hpp"
#include "core/presence/membership.hpp"
#include "core/recording/recorder.hpp"
#include "tools/record/room_order.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <thread>

namespace atrium::record_tool {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLookPeriod{500};
constexpr std::chrono::seconds kTellPeriod{10};
constexpr std::chrono::seconds kAloneAfter{5};

std::set<std::string> names_in(const std::string& list) {
    std::vector<std::string> names = split_list(list);
    return {std::make_move_iterator(names.begin()), std::make_move_iterator(names.end())};
}

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

recording::RecorderOptions options_of(const RecordConfig& config) {
    recording::RecorderOptions options;
    options.writer.file = config.output;
    if (options.writer.file.empty()) {
        const std::time_t now =
            std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
        options.writer.file =
            fmt::format("{}-{:%Y%m%d-%H%M%S}.mcap", config.bus.world, fmt::localtime(now));
    }
    options.writer.world = config.bus.world;
    options.writer.host = presence::host_name();
    options.writer.version = app::version();
    options.writer.cut_bytes = static_cast<std::uint64_t>(config.cut_mb * 1e6);
    options.writer.cut_after = from_milliseconds(config.cut_s * 1e3);
    options.sites = names_in(config.sites);
    options.topics = names_in(config.topics);
    options.buffer_bytes = std::uint64_t{config.buffer_mb} << 20U;
    options.spare_disk_bytes = std::uint64_t{config.spare_disk_mb} << 20U;
    return options;
}

// Tells what goes on, until the recorder ends.
class Teller {
public:
    Teller(const recording::Recorder& recorder,
           const bus::Participant& participant,
           std::set<std::string> wanted_sites)
        : recorder_(recorder), participant_(participant), wanted_sites_(std::move(wanted_sites)) {}

    void look(Clock::time_point now) {
        const recording::RecorderCounters counters = recorder_.counters();
        for (const std::string& line : participant_.take_mismatches()) app::log::warn("{}", line);
        for (const std::string& line : participant_.take_dds_log()) app::log::warn("{}", line);
        for (const std::string& site : counters.sites) {
            if (sites_.insert(site).second) app::log::info("site site={}", site);
        }
        tell_missing_sites(counters, now);
        if (counters.files.size() > num_files_) {
            num_files_ = counters.files.size();
            app::log::info("file file={}", counters.files.back().string());
        }
        if (counters.num_dropped > num_dropped_) {
            slow_.warn("slow",
                       fmt::format("disk_too_slow dropped={} in_all={} remedy=\"record to a faster "
                                   "disk, fewer topics (--topics), or raise --buffer_mb\"",
                                   counters.num_dropped - num_dropped_,
                                   counters.num_dropped));
            num_dropped_ = counters.num_dropped;
        }
        if (counters.num_samples == 0 && now - begin_ > kAloneAfter && !is_alone_told_) {
            is_alone_told_ = true;
            app::log::warn(
                "nobody_there {}; world, domain and network must be the same in all "
                "programs; recording begins when somebody comes",
                participant_.place());
        }
        if (now < due_) return;
        due_ = now + kTellPeriod;
        app::log::info("recording seconds={:.0f} samples={} mb={:.1f} mb_per_s={:.2f} dropped={}",
                       std::chrono::duration<double>(now - begin_).count(),
                       counters.num_samples,
                       megabytes(counters.file_bytes),
                       megabytes(counters.file_bytes - told_bytes_) /
                           std::chrono::duration<double>(kTellPeriod).count(),
                       counters.num_dropped);
        told_bytes_ = counters.file_bytes;
    }

private:
    void tell_missing_sites(const recording::RecorderCounters& counters, Clock::time_point now) {
        if (now - begin_ < kAloneAfter || are_missing_told_) return;
        are_missing_told_ = true;
        std::vector<std::string> missing;
        std::ranges::set_difference(wanted_sites_, counters.sites, std::back_inserter(missing));
        if (missing.empty()) return;
        app::log::warn("sites_missing sites={} here={}: recorded as soon as they come",
                       fmt::join(missing, ","),
                       fmt::join(counters.other_sites, ","));
    }

    const recording::Recorder& recorder_;
    const bus::Participant& participant_;
    std::set<std::string> wanted_sites_;
    app::log::LastingLog slow_;
    Clock::time_point begin_ = Clock::now();
    Clock::time_point due_ = begin_ + kTellPeriod;
    std::set<std::string> sites_;
    std::size_t num_files_ = 0;
    std::uint64_t num_dropped_ = 0;
    std::uint64_t told_bytes_ = 0;
    bool is_alone_told_ = false;
    bool are_missing_told_ = false;
};

}  // namespace

void declare(RecordConfig& config, config::OptionSet& options) {
    options.add("output",
                config.output,
                "file to write, which ends in .mcap; empty: WORLD-DATE-TIME.mcap here");
    options.add_alias("o");
    options.add("site", config.site, "with --raw: the site whose cameras are recorded");
    options.add("raw",
                config.raw,
                "have the running site --site record what its cameras deliver, on its own host: "
                "name of the new folder in the folder of its option record.orders");
    options.add(
        "stop", config.stop, "with --site: end the recording of its cameras, whoever began it");
    options.add("sites",
                config.sites,
                "sites, \"a,b\", that are recorded, and what belongs to no site; empty: all");
    options.add("topics",
                config.topics,
                "topics, \"SiteMesh,SceneState\", that are recorded; empty: all but PersonProxy, "
                "which a world server computes only for those who read it");
    options.add("seconds", config.seconds, "end after this time [s]; 0: at Ctrl-C", {0, 1e9});
    options.add("cut_mb",
                config.cut_mb,
                "begin a new file at this size [MB]; each can be played alone; 0: one file",
                {0, 1e9});
    options.add(
        "cut_s", config.cut_s, "begin a new file after this time [s]; 0: one file", {0, 1e9});
    options.add("buffer_mb",
                config.buffer_mb,
                "memory for samples that wait for the disk [MiB]; what comes when it is full is "
                "dropped and counted",
                {1, 65536});
    options.add("spare_disk_mb",
                config.spare_disk_mb,
                "end the recording in order when the disk has less than this free [MiB]",
                {1, 1e6});
    bus::declare(config.bus, options);
}

Expected<void> check(const RecordConfig& config) {
    const bool is_of_room = !config.raw.empty() || config.stop;
    if (config.stop && !config.raw.empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "stop: ends a recording, raw begins one: give one of them");
    }
    if (is_of_room && !config.output.empty()) {
        return make_error(
            ErrorKind::kConfiguration,
            "output: not with --site: the site writes the recording, on its own host");
    }
    if (config.site.empty() == is_of_room) {
        return make_error(
            ErrorKind::kConfiguration,
            !is_of_room ? "site: goes with --raw FOLDER or --stop; for the world's recording it is "
                          "--sites"
                        : "raw and stop need --site, the site whose cameras are recorded");
    }
    if (!config.raw.empty() && !bus::is_valid_name(config.raw)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("raw: '{}': must be a name of 1 to 63 characters of "
                                      "[A-Za-z0-9_.-]: the site makes it in its own folder",
                                      config.raw));
    }
    if (!config.output.empty() && config.output.extension() != ".mcap") {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("output: '{}': the name must end in .mcap", config.output.string()));
    }
    return {};
}

Expected<void> run_record(const RecordConfig& config, std::stop_token stop) {
    if (!config.raw.empty())
        return record_room({config.bus, config.site, config.raw, config.seconds}, std::move(stop));
    if (config.stop) return stop_room({config.bus, config.site, "", 0.0}, std::move(stop));
    recording::RecorderOptions options = options_of(config);
    const std::filesystem::path file = std::filesystem::absolute(options.writer.file);
    if (auto can =
            check_folder_writable(file.parent_path(), 2 * options.spare_disk_bytes, "a recording");
        !can)
        return can;
    std::error_code failure;
    std::filesystem::create_directories(file.parent_path(), failure);
    auto participant = bus::Participant::create(config.bus);
    if (!participant) return tl::unexpected(participant.error());
    app::log::info("{}", participant->network().line);
    for (const std::string& warning : participant->network().warnings)
        app::log::warn("{}", warning);
    auto recorder = recording::Recorder::create(*participant, std::move(options));
    if (!recorder) return tl::unexpected(recorder.error());
    const Clock::time_point begin = Clock::now();
    Expected<void> done;
    {
        std::atomic<bool> is_over = false;
        std::stop_source ending;
        const std::stop_callback pass_on(stop, [&] { ending.request_stop(); });
        const std::jthread recording([&] {
            done = (*recorder)->run(ending.get_token());
            is_over = true;
        });
        Teller teller(**recorder, *participant, names_in(config.sites));
        while (!is_over && !stop.stop_requested()) {
            std::this_thread::sleep_for(kLookPeriod);
            const Clock::time_point now = Clock::now();
            teller.look(now);
            if (config.seconds > 0.0 &&
                std::chrono::duration<double>(now - begin).count() >= config.seconds)
                break;
        }
        ending.request_stop();
    }
    const recording::RecorderCounters counters = (*recorder)->counters();
    std::vector<std::string> files;
    for (const std::filesystem::path& one : counters.files) files.push_back(one.string());
    app::log::info(
        "recorded files={} seconds={:.1f} samples={} mb={:.1f} dropped={} rejected={} "
        "sites={}",
        fmt::join(files, ","),
        std::chrono::duration<double>(Clock::now() - begin).count(),
        counters.num_samples,
        megabytes(counters.file_bytes),
        counters.num_dropped,
        counters.num_rejected,
        fmt::join(counters.sites, ","));
    if (!done) return done;
    if (counters.num_samples == 0) {
        for (const std::filesystem::path& empty : counters.files)
            std::filesystem::remove(empty, failure);
        return make_error(ErrorKind::kNotFound,
                          fmt::format("nothing was recorded: nobody is there: {}; world, domain "
                                      "and network must be the same in all programs",
                                      participant->place()));
    }
    return {};
}

}  // namespace atrium::record_tool
