// Compares what arrives on the bus with a recording, sample by sample: replay_check FILE --world W.
// Or measures how long jumps take: replay_check FILE --seeks 100. For record_world.sh.
#include "core/base/fnv1a.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/limits.hpp"
#include "core/recording/cursor.hpp"
#include "core/recording/player.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace atrium {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kIdle{5};
// Meanwhile the writers learn of their readers, and the player goes to the begin of the file: in
// pause it shows the first whole frame.
constexpr std::chrono::seconds kToTheBegin{2};

struct Seen {
    std::uint64_t hash = 0;
    std::int64_t time_ns = 0;
};
using Topics = std::map<std::string, std::map<std::string, std::vector<Seen>>>;  // topic, instance

std::uint64_t hash_of(std::span<const std::byte> bytes) {
    return fnv1a(std::span(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

Topics recorded(const std::shared_ptr<const recording::WorldFile>& world) {
    Topics topics;
    recording::Cursor cursor(world);
    for (const auto* next = cursor.peek(); next != nullptr; cursor.pop(), next = cursor.peek()) {
        if (next->raw.kind != bus::RawKind::kSample) continue;
        if (const auto key = next->topic->key_of(next->raw))
            topics[std::string(next->topic->name())][*key].push_back(
                {hash_of(next->raw.cdr), next->time.ns});
    }
    return topics;
}

Expected<Topics> received(const bus::BusOptions& options, const Topics& expected) {
    auto participant = bus::Participant::create(options);
    if (!participant) return tl::unexpected(participant.error());
    auto waiter = bus::Waiter::create(*participant);
    if (!waiter) return tl::unexpected(waiter.error());
    std::vector<std::pair<const bus::RawTopic*, std::unique_ptr<bus::RawReader>>> readers;
    for (const auto& [name, instances] : expected) {
        const bus::RawTopic* const topic = bus::find_raw_topic(name);
        auto reader = topic->reader(*participant);
        if (!reader) return tl::unexpected(reader.error());
        (*reader)->add_to(*waiter);
        readers.emplace_back(topic, std::move(*reader));
    }
    const auto all_matched = [&] {
        return std::ranges::all_of(readers,
                                   [](const auto& one) { return one.second->num_writers() > 0; });
    };
    while (!all_matched()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::printf("matched\n");
    std::fflush(stdout);
    std::this_thread::sleep_for(kToTheBegin);
    for (auto& [topic, reader] : readers) reader->take([](const bus::RawSample&) {});
    std::printf("ready\n");
    std::fflush(stdout);
    Topics topics;
    Clock::time_point last = Clock::time_point::max();
    while (last == Clock::time_point::max() || Clock::now() - last < kIdle) {
        waiter->wait(std::chrono::milliseconds(200));
        for (auto& [topic, reader] : readers) {
            reader->take([&, topic = topic](const bus::RawSample& sample) {
                last = Clock::now();
                if (sample.kind != bus::RawKind::kSample) return;
                const std::int64_t now = std::chrono::nanoseconds(last.time_since_epoch()).count();
                if (const auto key = topic->key_of(sample))
                    topics[std::string(topic->name())][*key].push_back({hash_of(sample.cdr), now});
            });
        }
    }
    return topics;
}

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

nlohmann::json compare(const Topics& expected, const Topics& got) {
    nlohmann::json out;
    std::vector<double> offsets;
    std::vector<std::int64_t> times;
    for (const auto& [name, instances] : expected) {
        std::size_t num_expected = 0;
        std::size_t num_equal = 0;
        std::size_t num_got = 0;
        Fnv1a of_file;
        Fnv1a of_bus;
        for (const auto& [key, samples] : instances) {
            num_expected += samples.size();
            const auto topic = got.find(name);
            const auto found =
                topic == got.end() ? decltype(topic->second.end()){} : topic->second.find(key);
            for (const Seen& one : samples) of_file.add(one.hash);
            if (topic == got.end() || found == topic->second.end()) continue;
            num_got += found->second.size();
            for (const Seen& one : found->second) of_bus.add(one.hash);
            for (std::size_t i = 0; i < std::min(samples.size(), found->second.size()); ++i) {
                num_equal += samples[i].hash == found->second[i].hash ? 1 : 0;
                times.push_back(found->second[i].time_ns - samples[i].time_ns);
            }
        }
        out["topics"][name] = {{"recorded", num_expected},
                               {"received", num_got},
                               {"equal", num_equal},
                               {"hashes_equal", of_file.value() == of_bus.value()}};
    }
    if (times.empty()) return out;
    auto sorted = times;
    std::ranges::nth_element(sorted,
                             sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
    const std::int64_t middle = sorted[sorted.size() / 2];
    for (const std::int64_t time : times)
        offsets.push_back(std::abs(static_cast<double>(time - middle)) * 1e-6);
    out["time_error_ms"] = {{"median", quantile(offsets, 0.5)},
                            {"p99", quantile(offsets, 0.99)},
                            {"max", quantile(offsets, 1.0)}};
    return out;
}

Expected<nlohmann::json> seeks(const std::shared_ptr<const recording::WorldFile>& world, int num) {
    bus::BusOptions options;
    options.network = "private";
    options.domain = bus::kMaxDomain;
    auto participant = bus::Participant::create(options);
    if (!participant) return tl::unexpected(participant.error());
    auto player = recording::Player::create(world, *participant, {});
    if (!player) return tl::unexpected(player.error());
    std::vector<double> times_ms;
    const std::jthread playing([&](std::stop_token stop) { (*player)->run(std::move(stop)); });
    (*player)->wait_until_shown(std::chrono::seconds(10));
    std::mt19937_64 random(22);
    std::uniform_int_distribution<std::int64_t> places(0, world->duration().count());
    for (int i = 0; i < num; ++i) {
        const Clock::time_point begin = Clock::now();
        (*player)->seek(std::chrono::nanoseconds(places(random)));
        (*player)->wait_until_shown(std::chrono::seconds(10));
        times_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    }
    return nlohmann::json{{"seeks", num},
                          {"median_ms", quantile(times_ms, 0.5)},
                          {"p90_ms", quantile(times_ms, 0.9)},
                          {"max_ms", quantile(times_ms, 1.0)}};
}

int run(int argc, char** argv) {
    std::string file;
    std::string world_name = "replay";
    int num_seeks = 0;
    CLI::App cli("Compares what arrives on the bus with a recording, or measures its jumps.");
    cli.add_option("FILE", file)->required();
    cli.add_option("--world", world_name);
    cli.add_option("--seeks", num_seeks);
    CLI11_PARSE(cli, argc, argv);
    const auto world = recording::WorldFile::open(file);
    if (!world) return std::fprintf(stderr, "%s\n", world.error().message.c_str()), 1;
    Expected<nlohmann::json> out;
    if (num_seeks > 0) {
        out = seeks(*world, num_seeks);
    } else {
        const Topics expected = recorded(*world);
        bus::BusOptions options;
        options.world = world_name;
        const auto got = received(options, expected);
        out = got ? compare(expected, *got) : Expected<nlohmann::json>(tl::unexpected(got.error()));
    }
    if (!out) return std::fprintf(stderr, "%s\n", out.error().message.c_str()), 1;
    std::printf("%s\n", out->dump().c_str());
    return 0;
}

}  // namespace
}  // namespace atrium

int main(int argc, char** argv) { return atrium::run(argc, argv); }
