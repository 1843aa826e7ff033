#include "core/recording/moment.hpp"

#include "core/recording/topic_roles.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/recording/recording_samples.hpp"

#include <gmock/gmock.h>

#include <set>

namespace atrium::recording {
namespace {

using namespace recording::testing;

constexpr std::chrono::nanoseconds kStream = std::chrono::seconds(1);
constexpr std::chrono::nanoseconds kStatus = std::chrono::milliseconds(2500);

// The moment by its definition: from all samples up to it, one after the other.
std::vector<Kept> folded(const std::vector<Recorded>& samples, Timestamp time) {
    std::map<std::pair<const bus::RawTopic*, std::string>, const Recorded*> last;
    std::vector<const Recorded*> meshes;
    std::vector<const Recorded*> textures;
    for (const Recorded& sample : samples) {
        if (sample.time > time) break;
        const bus::RawTopic& topic = *sample.topic;
        if (is_command(topic)) continue;
        const auto life = topic.qos_class() == "status" ? kStatus : kStream;
        if (!is_kept(topic) && sample.time < time + -life) continue;
        if (topic.name() == "SiteMesh") meshes.push_back(&sample);
        if (topic.name() == "CameraTexture") textures.push_back(&sample);
        if (is_of_people(topic)) continue;
        const auto key = value(topic.key_of({sample.kind, sample.written, sample.cdr}));
        if (sample.kind == bus::RawKind::kSample)
            last[{&topic, key}] = &sample;
        else
            last.erase({&topic, key});
    }
    // What came first of an instance within a second was there before the recorder.
    std::set<std::pair<const bus::RawTopic*, std::string>> known;
    for (const Recorded& sample : samples) {
        if (!is_kept(*sample.topic) || sample.time > samples.front().time + kStream) continue;
        const auto key = value(sample.topic->key_of({sample.kind, sample.written, sample.cdr}));
        if (!known.insert({sample.topic, key}).second || sample.time <= time) continue;
        if (sample.kind == bus::RawKind::kSample) last[{sample.topic, key}] = &sample;
    }
    std::vector<Kept> expected;
    for (const auto& [key, sample] : last) expected.push_back(kept(*sample));
    for (const std::string site : {"alice", "bob"}) {
        for (auto one = meshes.rbegin(); one != meshes.rend(); ++one) {
            const auto found =
                value(bus::from_raw<bus::SiteMesh>({(*one)->kind, (*one)->written, (*one)->cdr}));
            if (found.site != site) continue;
            if ((*one)->kind != bus::RawKind::kSample) break;
            std::vector<Kept> frame;
            for (const std::uint32_t camera : found.textured_cameras) {
                const auto wanted = bus::to_cdr(texture(site, camera, found.frame_id));
                const auto its = std::ranges::find(textures, wanted, &Recorded::cdr);
                if (its != textures.end()) frame.push_back(kept(**its));
            }
            if (frame.size() < found.textured_cameras.size()) continue;
            frame.push_back(kept(**one));
            expected.insert(expected.end(), frame.begin(), frame.end());
            break;
        }
    }
    return expected;
}

class MomentTest : public ::testing::Test {
protected:
    test::TemporaryFolder folder_;
};

TEST_F(MomentTest, IsWhatAllSamplesBeforeItLeave) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE(seed);
        const auto samples = random_world(100 + seed, 400);
        const auto path = folder_ / (std::to_string(seed) + ".mcap");
        write_recording(writer_options(path), samples);
        const auto world = value(WorldFile::open(path));
        test::Random random(seed);
        for (int i = 0; i < 30; ++i) {
            // Between samples, and just at one.
            const auto& near = samples[static_cast<std::size_t>(
                test::between(random, 0, static_cast<int>(samples.size()) - 1))];
            const Timestamp time =
                near.time + std::chrono::nanoseconds(test::between(random, -1, 1));
            std::vector<Kept> got;
            for (const KeyedSample& one : moment(world, time)) {
                EXPECT_EQ(one.key, value(one.sample.topic->key_of(one.sample.raw)));
                got.push_back(kept(one.sample));
            }
            auto expected = folded(samples, time);
            std::ranges::sort(got);
            std::ranges::sort(expected);
            EXPECT_EQ(got, expected);
        }
    }
}

TEST_F(MomentTest, HasWhatIsKeptFirstAndTexturesBehindTheirMesh) {
    std::vector<Recorded> samples;
    samples.push_back(recorded(description("alice"), at(0.0)));
    samples.push_back(recorded(placement("alice", 1.0), at(0.1)));
    samples.push_back(recorded(state(1), at(10.0)));
    samples.push_back(recorded(texture("alice", 0, 1), at(10.01)));
    samples.push_back(recorded(texture("alice", 1, 1), at(10.02)));
    samples.push_back(recorded(mesh("alice", 1), at(10.03)));
    write_recording(writer_options(folder_ / "a.mcap"), samples);
    const auto world = value(WorldFile::open(folder_ / "a.mcap"));
    std::vector<std::string> names;
    for (const KeyedSample& one : moment(world, at(10.1)))
        names.emplace_back(one.sample.topic->name());
    EXPECT_EQ(names,
              (std::vector<std::string>{"SiteDescription",
                                        "SitePlacement",
                                        "SiteMesh",
                                        "CameraTexture",
                                        "CameraTexture",
                                        "SceneState"}));
    EXPECT_EQ(moment(world, at(12.0)).size(), 2u);  // the streams are over
    EXPECT_TRUE(moment(world, at(-1.0)).empty());
}

// A mesh names other pictures than its own time's where camera nodes number theirs.
TEST_F(MomentTest, FindsTexturesByTheFramesThatTheMeshNames) {
    bus::SiteMesh of_nodes = mesh("alice", 50);
    of_nodes.texture_frames = {{1, {1'000'000}}, {2, {2'000'000}}};
    std::vector<Recorded> samples;
    samples.push_back(recorded(texture("alice", 0, 1), at(1.0)));
    samples.push_back(recorded(texture("alice", 1, 2), at(1.1)));
    samples.push_back(recorded(of_nodes, at(1.2)));
    write_recording(writer_options(folder_ / "a.mcap"), samples);
    EXPECT_EQ(moment(value(WorldFile::open(folder_ / "a.mcap")), at(1.3)).size(), 3u);
}

}  // namespace
}  // namespace atrium::recording
