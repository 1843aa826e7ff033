#pragma once

#include "core/recording/player.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/recording/recording_samples.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <regex>
#include <thread>

/// A player in a world of its own, and all that it writes there.
namespace atrium::recording::testing {

using test_support::comes_true;
using Payloads = std::vector<std::vector<std::byte>>;

// Readers that forget nothing, however late they take: no test may depend on being fast.
inline std::filesystem::path patient_profiles(const test::TemporaryFolder& folder) {
    std::ifstream stream(test::source_dir() + "/qos/profiles.xml");
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    text = std::regex_replace(text, std::regex("<lifespan>.*</lifespan>\n"), "\n");
    text = std::regex_replace(text, std::regex("<depth>[18]</depth>"), "<depth>100000</depth>");
    text = std::regex_replace(text,
                              std::regex("<history_depth>1</history_depth>"),
                              "<history_depth>100000</history_depth>");
    for (const char* limit : {"max_samples", "max_samples_per_instance"}) {
        text = std::regex_replace(text,
                                  std::regex(std::string("<") + limit + ">[0-9]+<"),
                                  std::string("<") + limit + ">100000<");
    }
    std::ofstream(folder / "profiles.xml") << text;
    return folder / "profiles.xml";
}

inline Payloads joined(std::map<std::string, Payloads> by_key) {
    Payloads all;
    for (auto& [key, payloads] : by_key) {
        for (auto& payload : payloads) all.push_back(std::move(payload));
    }
    return all;
}

struct Heard {
    const bus::RawTopic* topic = nullptr;
    bus::RawKind kind = bus::RawKind::kSample;
    std::string key;
    std::int64_t written_ns = 0;
    std::vector<std::byte> cdr;
    std::chrono::steady_clock::time_point taken;
};

// All that is on the bus.
class Ear {
public:
    explicit Ear(const bus::Participant& participant) {
        for (const bus::RawTopic* topic : bus::raw_topics())
            readers_.emplace_back(topic, value(topic->reader(participant)));
    }
    // Adds what came since the last call.
    std::vector<Heard>& take() {
        for (const auto& [topic, reader] : readers_) {
            reader->take([&, topic = topic](const bus::RawSample& sample) {
                heard_.push_back({topic,
                                  sample.kind,
                                  value(topic->key_of(sample)),
                                  sample.written.ns,
                                  {sample.cdr.begin(), sample.cdr.end()},
                                  std::chrono::steady_clock::now()});
            });
        }
        return heard_;
    }
    void forget() {
        take();
        heard_.clear();
    }
    // Instance by instance, as Cyclone gives them: each in its order.
    Payloads payloads(std::string_view topic) {
        std::map<std::string, Payloads> by_key;
        for (const Heard& one : take()) {
            if (one.topic->name() == topic && one.kind == bus::RawKind::kSample)
                by_key[one.key].push_back(one.cdr);
        }
        return joined(std::move(by_key));
    }
    // The newest sample of each instance that has not ended.
    using Alive = std::map<std::pair<std::string, std::string>, std::vector<std::byte>>;
    const Alive& alive() {
        for (const Heard& one : take()) {
            const std::pair key{std::string(one.topic->name()), one.key};
            if (one.kind == bus::RawKind::kSample)
                alive_[key] = one.cdr;
            else
                alive_.erase(key);
        }
        heard_.clear();
        return alive_;
    }

private:
    std::vector<std::pair<const bus::RawTopic*, std::unique_ptr<bus::RawReader>>> readers_;
    std::vector<Heard> heard_;
    Alive alive_;
};

class PlayerTest : public ::testing::Test {
protected:
    std::shared_ptr<const WorldFile> make(const std::vector<Recorded>& samples) {
        const auto path = folder_ / (std::to_string(++num_files_) + ".mcap");
        write_recording(writer_options(path), samples);
        return value(WorldFile::open(path));
    }
    // In a world of its own.
    void open(std::shared_ptr<const WorldFile> world, PlaySelection selection = {}) {
        thread_ = {};
        player_.reset();
        ear_.reset();
        bus::BusOptions options;
        options.domain = 101;
        options.world =
            "player-" + std::to_string(::getpid()) + "-" + std::to_string(++num_worlds_);
        options.profiles_file = patient_profiles(folder_);
        participant_.emplace(value(bus::Participant::create(options)));
        ear_.emplace(*participant_);
        player_ = value(Player::create(std::move(world), *participant_, std::move(selection)));
        player_->set_speed(20.0);
    }
    void start() {
        thread_ = std::jthread([this](std::stop_token stop) { player_->run(std::move(stop)); });
    }
    void play_to_the_end() {
        start();
        player_->play();
        ASSERT_TRUE(comes_true([&] { return player_->state().is_at_end; }));
    }
    void shown() { ASSERT_TRUE(player_->wait_until_shown(std::chrono::minutes(1))); }

    test::TemporaryFolder folder_;
    int num_files_ = 0;
    int num_worlds_ = 0;
    std::optional<bus::Participant> participant_;
    std::optional<Ear> ear_;
    std::unique_ptr<Player> player_;
    std::jthread thread_;
};

// By topic; instance by instance.
inline std::map<std::string, Payloads> payloads_of(const std::vector<Recorded>& samples) {
    std::map<std::string, std::map<std::string, Payloads>> by_key;
    for (const Recorded& sample : samples) {
        if (sample.kind != bus::RawKind::kSample) continue;
        const auto key = value(sample.topic->key_of({sample.kind, {}, sample.cdr}));
        by_key[std::string(sample.topic->name())][key].push_back(sample.cdr);
    }
    std::map<std::string, Payloads> payloads;
    for (auto& [topic, instances] : by_key) payloads[topic] = joined(std::move(instances));
    return payloads;
}

}  // namespace atrium::recording::testing
