#include "core/recording/recorder.hpp"

#include "core/recording/topic_roles.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/recording/recording_samples.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <thread>

namespace atrium::recording {
namespace {

using namespace recording::testing;
using test_support::comes_true;

bus::Participant own_world(const std::string& name) {
    bus::BusOptions options;
    options.domain = 101;
    options.world = name + "-" + std::to_string(::getpid());
    return value(bus::Participant::create(options));
}

// A recorder that runs until `stop`.
class Running {
public:
    Running(const bus::Participant& participant, RecorderOptions options)
        : recorder_(value(Recorder::create(participant, std::move(options)))),
          thread_([this](std::stop_token stop) { result_ = recorder_->run(std::move(stop)); }) {}
    Expected<void> stop() {
        thread_.request_stop();
        thread_.join();
        return result_;
    }
    // Until the recorder ends by itself.
    Expected<void> join() {
        thread_.join();
        return result_;
    }
    bool has(std::uint64_t num_samples) const {
        return comes_true([&] { return recorder_->counters().num_samples >= num_samples; });
    }
    RecorderCounters counters() const { return recorder_->counters(); }

private:
    std::unique_ptr<Recorder> recorder_;
    Expected<void> result_;
    std::jthread thread_;
};

template <typename Message>
class Source {
public:
    explicit Source(const bus::Participant& participant)
        : writer_(value(bus::Writer<Message>::create(participant))) {}
    // Waits for the recorder: streams are not kept for late joiners.
    void write(const Message& message) {
        ASSERT_TRUE(comes_true([&] { return writer_.num_readers() > 0; }));
        const auto done = writer_.write(message);
        ASSERT_TRUE(done) << done.error().message;
    }
    void dispose(const Message& message) { ASSERT_TRUE(writer_.dispose(message)); }

private:
    bus::Writer<Message> writer_;
};

std::vector<nlohmann::json> notes_in(const std::filesystem::path& path) {
    const auto file = value(mcap::File::open(path));
    std::vector<nlohmann::json> notes;
    for (std::size_t i = 0; i < file.contents().chunks.size(); ++i) {
        const auto chunk = value(file.read(i));
        for (const mcap::Message& message : chunk.messages) {
            if (file.contents().channels.at(message.channel).topic != "recorder") continue;
            const std::string text(reinterpret_cast<const char*>(message.data.data()),
                                   message.data.size());
            notes.push_back(nlohmann::json::parse(text));
        }
    }
    return notes;
}

class RecorderTest : public ::testing::Test {
protected:
    RecorderOptions options(const std::string& name = "a.mcap") const {
        RecorderOptions options;
        options.writer = writer_options(folder_ / name);
        options.spare_disk_bytes = 1;
        return options;
    }
    std::vector<Kept> recorded_samples() const {
        return all_samples(value(WorldFile::open(folder_ / "a.mcap")));
    }

    test::TemporaryFolder folder_;
};

TEST_F(RecorderTest, RecordsWhatComesBitForBit) {
    const auto participant = own_world("recorder");
    Source<bus::SiteDescription> descriptions(participant);
    Source<bus::SceneState> states(participant);
    Running recorder(participant, options());
    const Timestamp before = Timestamp::now();
    descriptions.write(description("alice"));
    for (std::uint64_t i = 0; i < 5; ++i) {
        states.write(state(i));
        ASSERT_TRUE(recorder.has(i + 2));
    }
    descriptions.dispose(description("alice"));
    ASSERT_TRUE(recorder.has(7));
    EXPECT_EQ(recorder.counters().sites, std::set<std::string>{"alice"});
    ASSERT_TRUE(recorder.stop());
    EXPECT_EQ(recorder.counters().num_dropped, 0u);

    const auto samples = recorded_samples();
    std::vector<std::vector<std::byte>> states_written;
    std::vector<std::pair<bus::RawKind, std::vector<std::byte>>> descriptions_written;
    for (const auto& [topic, kind, time, written, cdr] : samples) {
        EXPECT_GE(time, written);
        EXPECT_GE(written, before.ns);
        if (topic == "SceneState") states_written.push_back(cdr);
        if (topic == "SiteDescription") descriptions_written.emplace_back(kind, cdr);
    }
    ASSERT_EQ(states_written.size(), 5u);
    for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ(states_written[i], bus::to_cdr(state(i)));
    ASSERT_EQ(descriptions_written.size(), 2u);
    EXPECT_EQ(descriptions_written[0].first, bus::RawKind::kSample);
    EXPECT_EQ(descriptions_written[0].second, bus::to_cdr(description("alice")));
    EXPECT_EQ(descriptions_written[1].first, bus::RawKind::kDisposed);
    const auto notes = notes_in(folder_ / "a.mcap");
    ASSERT_FALSE(notes.empty());
    EXPECT_EQ(notes.back()["num_dropped"], 0);
    EXPECT_EQ(notes.back()["num_samples"], 7);
}

// A mesh that arrives with its textures must not be in front of them: it could not be shown.
TEST_F(RecorderTest, PutsTexturesInFrontOfTheirMesh) {
    const auto participant = own_world("recorder-order");
    Source<bus::SiteMesh> meshes(participant);
    Source<bus::CameraTexture> textures(participant);
    Running recorder(participant, options());
    for (std::uint64_t frame = 1; frame <= 50; ++frame) {
        textures.write(texture("alice", 0, frame));
        textures.write(texture("alice", 1, frame));
        meshes.write(mesh("alice", frame));
        ASSERT_TRUE(recorder.has(3 * frame));
    }
    ASSERT_TRUE(recorder.stop());
    std::set<std::uint64_t> seen[2];
    int num_meshes = 0;
    Cursor cursor(value(WorldFile::open(folder_ / "a.mcap")));
    for (const PlayedSample* next = cursor.peek(); next != nullptr;
         cursor.pop(), next = cursor.peek()) {
        if (next->topic->name() == "CameraTexture") {
            const auto one = value(bus::from_raw<bus::CameraTexture>(next->raw));
            seen[one.camera].insert(one.frame_id);
        } else {
            const auto one = value(bus::from_raw<bus::SiteMesh>(next->raw));
            EXPECT_TRUE(seen[0].contains(one.frame_id) && seen[1].contains(one.frame_id))
                << one.frame_id;
            ++num_meshes;
        }
    }
    EXPECT_EQ(num_meshes, 50);
}

// The smallest slow disk: a line in which one large sample has no room.
TEST_F(RecorderTest, CountsWhatItDropsAlsoInTheFile) {
    const auto participant = own_world("recorder-drops");
    Source<bus::SiteMesh> meshes(participant);
    Source<bus::SceneState> states(participant);
    RecorderOptions small = options();
    small.buffer_bytes = 20'000;
    Running recorder(participant, small);
    bus::SiteMesh large = mesh("alice", 1);
    large.draco.assign(50'000, 7);
    meshes.write(large);
    ASSERT_TRUE(comes_true([&] { return recorder.counters().num_dropped > 0; }));
    states.write(state(1));
    ASSERT_TRUE(recorder.has(1));
    ASSERT_TRUE(recorder.stop());
    const RecorderCounters counters = recorder.counters();
    EXPECT_EQ(counters.num_dropped, 1u);
    EXPECT_EQ(counters.dropped, (std::map<std::string, std::uint64_t>{{"SiteMesh", 1}}));
    EXPECT_EQ(counters.waiting_bytes, 0u);
    const auto notes = notes_in(folder_ / "a.mcap");
    EXPECT_EQ(notes.back()["num_dropped"], 1);
    EXPECT_EQ(notes.back()["dropped"]["SiteMesh"], 1);
    EXPECT_EQ(recorded_samples().size(), 1u);
}

// A file without a description would show nothing of its site; one without a mesh lacks a frame.
TEST_F(RecorderTest, DropsStreamsBeforeDescriptions) {
    const auto participant = own_world("recorder-kept");
    Source<bus::SiteDescription> descriptions(participant);
    Source<bus::SiteMesh> meshes(participant);
    const Recorded small_one = recorded(description("alice"), kBegin);
    RecorderOptions small = options();
    small.buffer_bytes = small_one.cdr.size() + 200;
    Running recorder(participant, small);
    bus::SiteMesh same_size = mesh("alice", 1);
    same_size.draco.assign(small_one.cdr.size() - 100, 7);
    meshes.write(same_size);
    ASSERT_TRUE(comes_true([&] { return recorder.counters().num_dropped > 0; }));
    descriptions.write(description("alice"));
    ASSERT_TRUE(recorder.has(1));
    ASSERT_TRUE(recorder.stop());
    EXPECT_EQ(recorder.counters().dropped, (std::map<std::string, std::uint64_t>{{"SiteMesh", 1}}));
}

TEST_F(RecorderTest, RecordsOnlyTheSitesThatAreWanted) {
    const auto participant = own_world("recorder-sites");
    Source<bus::SiteDescription> descriptions(participant);
    Source<bus::SiteMesh> meshes(participant);
    Source<bus::SceneState> states(participant);
    RecorderOptions only = options();
    only.sites = {"alice"};
    Running recorder(participant, only);
    for (const std::string site : {"bob", "alice"}) {
        descriptions.write(description(site));
        meshes.write(mesh(site, 1));
    }
    states.write(state(1));
    ASSERT_TRUE(recorder.has(3));
    ASSERT_TRUE(recorder.stop());
    EXPECT_EQ(recorder.counters().sites, std::set<std::string>{"alice"});
    for (const auto& [topic, kind, time, written, cdr] : recorded_samples()) {
        const auto* const known = bus::find_raw_topic(topic);
        EXPECT_NE(site_of(*known, value(known->key_of({kind, {}, cdr}))), "bob");
    }
    EXPECT_EQ(recorder.counters().num_samples, 3u);
}

TEST_F(RecorderTest, RecordsOnlyTheTopicsThatAreWanted) {
    const auto participant = own_world("recorder-topics");
    Source<bus::SceneState> states(participant);
    auto meshes = value(bus::Writer<bus::SiteMesh>::create(participant));
    RecorderOptions only = options();
    only.topics = {"SceneState"};
    Running recorder(participant, only);
    ASSERT_TRUE(meshes.write(mesh("alice", 1)));
    states.write(state(1));
    ASSERT_TRUE(recorder.has(1));
    EXPECT_EQ(meshes.num_readers(), 0);
    ASSERT_TRUE(recorder.stop());
    const auto samples = recorded_samples();
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_EQ(std::get<0>(samples[0]), "SceneState");

    only.topics = {"SceneStates"};
    const auto wrong = Recorder::create(participant, only);
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(wrong.error().message,
                ::testing::HasSubstr("'SceneStates' is none; there are SiteDescription, "));
}

TEST_F(RecorderTest, EndsInOrderWhenTheDiskIsNearlyFull) {
    const auto participant = own_world("recorder-full");
    Source<bus::SceneState> states(participant);
    RecorderOptions full = options();
    full.spare_disk_bytes = std::uint64_t{1} << 62U;  // no disk has so much
    Running recorder(participant, full);
    states.write(state(1));
    const auto ended = recorder.join();
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(ended.error().message, ::testing::HasSubstr("a.mcap: the disk is full"));
    EXPECT_EQ(value(WorldFile::open(folder_ / "a.mcap"))->file().fault(), "");
    EXPECT_EQ(recorded_samples().size(), 1u);
}

// What cannot be written is not counted as recorded, and everything else is in the file.
TEST_F(RecorderTest, CountsWhatAFullDiskLost) {
    const auto participant = own_world("recorder-write");
    Source<bus::SiteMesh> meshes(participant);
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    ::sigaction(SIGXFSZ, &ignore, nullptr);
    rlimit limit{};
    ::getrlimit(RLIMIT_FSIZE, &limit);
    const rlimit old = limit;
    Running recorder(participant, options());
    test::Random random(1);
    bus::SiteMesh large = mesh("alice", 1);
    large.draco.resize(200'000);
    for (std::uint8_t& byte : large.draco)
        byte = static_cast<std::uint8_t>(test::between(random, 0, 255));
    meshes.write(large);
    ASSERT_TRUE(recorder.has(1));
    ASSERT_TRUE(comes_true([&] { return recorder.counters().file_bytes > 200'000; }));
    limit.rlim_cur = 300'000;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    large.frame_id = 2;
    meshes.write(large);
    const auto ended = recorder.join();
    ::setrlimit(RLIMIT_FSIZE, &old);
    ASSERT_FALSE(ended);
    EXPECT_THAT(ended.error().message, ::testing::HasSubstr("a.mcap"));
    const auto samples = recorded_samples();
    EXPECT_EQ(samples.size(), 1u);
    EXPECT_EQ(recorder.counters().num_samples, samples.size());
    EXPECT_EQ(value(WorldFile::open(folder_ / "a.mcap"))->file().fault(), "");
}

TEST_F(RecorderTest, RefusesAFileThatExists) {
    const auto participant = own_world("recorder-exists");
    std::ofstream(folder_ / "a.mcap") << "x";
    const auto recorder = Recorder::create(participant, options());
    ASSERT_FALSE(recorder);
    EXPECT_EQ(recorder.error().kind, ErrorKind::kConfiguration);
}

TEST_F(RecorderTest, LeavesAValidFileWhenNothingCame) {
    const auto participant = own_world("recorder-nothing");
    Running recorder(participant, options());
    ASSERT_TRUE(recorder.stop());
    EXPECT_EQ(recorder.counters().num_samples, 0u);
    EXPECT_EQ(value(mcap::File::open(folder_ / "a.mcap")).fault(), "");
}

}  // namespace
}  // namespace atrium::recording
