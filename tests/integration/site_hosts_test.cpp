#include "core/base/timestamp.hpp"
#include "core/bus/bus.hpp"
#include "core/config/rig.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/network/hosted_process.hpp"
#include "tests/support/network/impaired_network.hpp"
#include "tests/support/network/network_host.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/unit/site_node/capsule_room.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

// A site of which two hosts have the cameras and a third one computes the hull, as programs that
// users would start. Faults: hosts that are killed, stand still, are cut off, have a wrong clock,
// come back, and come twice.
namespace atrium::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr auto kPatience = 120s;
constexpr std::uint32_t kDomain = 194;  // used by this test only
constexpr int kRate_hz = 10;
constexpr int kNumInstants = 6;

template <typename T>
T value(Expected<T> expected) {
    if (!expected) throw std::runtime_error(expected.error().message);
    return std::move(*expected);
}

// A person who sways, as masks of eight cameras.
void write_recording(const fs::path& folder) {
    const fs::path file = test::source_dir() + "/deploy/rigs/full_body.toml";
    fs::create_directories(folder);
    fs::copy_file(file, folder / "rig.toml");
    const config::Rig rig = value(config::load_rig(file));
    for (int instant = 0; instant < kNumInstants; ++instant) {
        const auto body =
            site_node::test::make_body({0.05 * instant, 0.1 * std::sin(instant), 0.0});
        for (const geometry::CalibratedCamera& camera : rig.cameras) {
            const image::Mask mask = site_node::test::draw(body, camera);
            const cv::Mat white(
                mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.row(0)));
            const cv::Mat picture = 90 + 0.4 * white;
            for (const auto& [what, pixels] :
                 {std::pair("frames", picture), std::pair("silhouettes", white)}) {
                fs::create_directories(folder / camera.name / what);
                const std::string name = fmt::format("{:06}.png", instant);
                ASSERT_TRUE(cv::imwrite((folder / camera.name / what / name).string(), pixels));
            }
        }
    }
}

std::string site_file(const fs::path& recording) {
    return fmt::format(R"([site]
name = "hall"
[capture]
source = "recording"
recording = "{}"
rate_hz = {}
min_cameras = 4
aligned = true
)",
                       recording.string(),
                       kRate_hz);
}

constexpr const char* kHosts = R"(
[[host]]
name = "left"
cameras = ["cam0", "cam1", "cam2", "cam3"]
[[host]]
name = "right"
cameras = ["cam4", "cam5", "cam6", "cam7"]
[[host]]
name = "hull"
model = true
)";

// The person stands in both regions.
constexpr const char* kRegions = R"(
[[hull.region]]
name = "front"
bounds = { min = [-2.0, -2.0, -0.1], max = [2.0, 0.0, 2.5] }
[[hull.region]]
name = "back"
bounds = { min = [-2.0, 0.0, -0.1], max = [2.0, 2.0, 2.5] }
cameras = ["cam0", "cam1", "cam2", "cam3", "cam4", "cam5", "cam6"]
)";

constexpr const char* kHelper = R"(
[[host]]
name = "help"
regions = ["front"]
)";

// What a site published of each instant of the recording: all that came is the same each round.
struct Published {
    std::map<std::int64_t, std::set<std::vector<std::uint8_t>>> meshes;
    std::map<std::pair<std::int64_t, std::uint32_t>, std::set<std::vector<std::uint8_t>>> textures;
    std::size_t num_complete = 0;       // meshes of all cameras whose textures all came
    std::size_t num_of_two_meshes = 0;  // part of num_complete
    std::size_t num_textures = 0;
};

std::int64_t instant_at(Timestamp time) {
    const auto number = std::llround(static_cast<double>(time.ns / 1000) * kRate_hz / 1e6);
    return number % kNumInstants;
}

class SiteHosts : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = fs::path(testing::TempDir()) / ("atrium_site_hosts_" + std::to_string(getpid()));
        write_recording(folder_ / "recording");
        std::ofstream(folder_ / "one.toml") << site_file(folder_ / "recording");
        std::ofstream(folder_ / "hall.toml") << site_file(folder_ / "recording") << kHosts;
        const std::string regions = site_file(folder_ / "recording") + kRegions;
        std::ofstream(folder_ / "one_with_regions.toml") << regions;
        std::ofstream(folder_ / "hall_with_regions.toml") << regions << kHosts << kHelper;
    }
    static void TearDownTestSuite() { fs::remove_all(folder_); }
    void TearDown() override {
        for (auto& [name, program] : programs_) {
            program->signal(SIGTERM);
            EXPECT_EQ(program->wait(kPatience), 0) << name << program->output();
            EXPECT_EQ(program->output().find(" error "), std::string::npos) << program->output();
        }
    }

    std::vector<std::string> command_of(const std::string& host) const {
        const std::string program = host == "left" || host == "right" ? "camera_node" : "site_node";
        const std::string file = (host == "one" ? "one" : "hall") + regions_ + ".toml";
        std::vector<std::string> command{
            std::string(ATRIUM_BIN_DIR) + "/" + program, "--config", (folder_ / file).string()};
        if (host != "one") command.insert(command.end(), {"--host", host});
        command.insert(command.end(), {"--bus.domain", std::to_string(kDomain)});
        return command;
    }
    void start(const std::string& host, std::vector<std::string> prefix = {}) {
        const auto command = command_of(host);
        prefix.insert(prefix.end(), command.begin(), command.end());
        programs_[host] = value(HostedProcess::start(prefix));
    }
    void start_all() {
        for (const std::string host : {"hull", "left", "right"}) start(host);
        for (const std::string host : {"left", "right"})
            ASSERT_TRUE(hull_says("host_in_use host=" + host, 0)) << hull().output();
    }
    HostedProcess& hull() { return *programs_.at("hull"); }
    std::size_t now_in_log() { return hull().output().size(); }
    bool hull_says(const std::string& text, std::size_t from) {
        return hull().wait_for_output(text, kPatience, from);
    }

    // Listens until `num` meshes of all cameras came with their textures.
    Published listen(std::size_t num) {
        bus::BusOptions options;
        options.domain = kDomain;
        const auto participant = value(bus::Participant::create(options));
        auto meshes = value(bus::Reader<bus::SiteMesh>::create(participant));
        auto textures = value(bus::Reader<bus::CameraTexture>::create(participant));
        auto waiter = value(bus::Waiter::create(participant));
        waiter.add(meshes);
        waiter.add(textures);
        Published published;
        std::set<std::tuple<std::uint32_t, std::uint64_t, std::int64_t>> there;
        std::vector<bus::SiteMesh> pending;
        const auto end = std::chrono::steady_clock::now() + kPatience;
        while (published.num_complete < num && std::chrono::steady_clock::now() < end) {
            waiter.wait(100ms);
            textures.take([&](bus::CameraTexture&& t) {
                there.emplace(t.camera, t.frame_id, t.capture_time.ns);
                ++published.num_textures;
                std::vector<std::uint8_t> bytes = t.colour;
                bytes.insert(bytes.end(), t.mask.begin(), t.mask.end());
                published.textures[{instant_at(t.capture_time), t.camera}].insert(bytes);
            });
            meshes.take([&](bus::SiteMesh&& mesh) {
                if (mesh.textured_cameras.size() == 8) pending.push_back(std::move(mesh));
            });
            std::erase_if(pending, [&](const bus::SiteMesh& mesh) {
                for (std::size_t i = 0; i < mesh.textured_cameras.size(); ++i) {
                    const bus::FrameKey key = mesh.texture_frames.empty()
                                                  ? bus::FrameKey{mesh.frame_id, mesh.capture_time}
                                                  : mesh.texture_frames[i];
                    if (!there.contains(
                            {mesh.textured_cameras[i], key.frame_id, key.capture_time.ns}))
                        return false;
                    // the instant of each picture is that of the mesh
                    EXPECT_EQ(instant_at(key.capture_time), instant_at(mesh.capture_time));
                }
                ++published.num_complete;
                if (mesh.mesh_sizes.size() == 2) ++published.num_of_two_meshes;
                published.meshes[instant_at(mesh.capture_time)].insert(mesh.draco);
                return true;
            });
        }
        return published;
    }

    static inline fs::path folder_;
    std::string regions_;  // of the names of the site's files
    std::map<std::string, std::unique_ptr<HostedProcess>> programs_;
};

TEST_F(SiteHosts, MeshesAndTexturesAreBitForBitThoseOfOneProcess) {
    start_all();
    const Published of_hosts = listen(3 * kNumInstants);
    for (const std::string host : {"left", "right", "hull"}) {
        programs_[host]->signal(SIGTERM);
        ASSERT_EQ(programs_[host]->wait(kPatience), 0);
        programs_.erase(host);
    }
    start("one");
    const Published of_one = listen(3 * kNumInstants);
    ASSERT_EQ(of_one.meshes.size(), static_cast<std::size_t>(kNumInstants));
    ASSERT_EQ(of_one.textures.size(), 8u * kNumInstants);
    EXPECT_GE(of_hosts.num_complete, 3u * kNumInstants);
    EXPECT_TRUE(of_hosts.meshes == of_one.meshes) << "some meshes differ";
    EXPECT_TRUE(of_hosts.textures == of_one.textures) << "some textures differ";
    std::set<std::vector<std::uint8_t>> different;
    for (const auto& [instant, meshes] : of_one.meshes) {
        EXPECT_EQ(meshes.size(), 1u) << instant;
        different.insert(meshes.begin(), meshes.end());
    }
    EXPECT_EQ(different.size(), static_cast<std::size_t>(kNumInstants));
}

// A site with two regions, of which a host without cameras computes one.
class SiteWithRegions : public SiteHosts {
protected:
    SiteWithRegions() { regions_ = "_with_regions"; }
    void start_all_with_regions() {
        start("help");
        start_all();
        ASSERT_TRUE(hull_says("host_in_use host=help regions=1", 0)) << hull().output();
    }
};

TEST_F(SiteWithRegions, MeshesAreBitForBitThoseOfOneProcess) {
    start_all_with_regions();
    const Published of_hosts = listen(3 * kNumInstants);
    for (const std::string host : {"left", "right", "help", "hull"}) {
        programs_[host]->signal(SIGTERM);
        ASSERT_EQ(programs_[host]->wait(kPatience), 0) << programs_[host]->output();
        programs_.erase(host);
    }
    start("one");
    const Published of_one = listen(3 * kNumInstants);
    ASSERT_EQ(of_one.meshes.size(), static_cast<std::size_t>(kNumInstants));
    EXPECT_TRUE(of_hosts.meshes == of_one.meshes) << "some meshes differ";
    EXPECT_TRUE(of_hosts.textures == of_one.textures) << "some textures differ";
    EXPECT_EQ(of_one.num_of_two_meshes, of_one.num_complete);
    EXPECT_EQ(of_hosts.num_of_two_meshes, of_hosts.num_complete);
}

TEST_F(SiteWithRegions, KilledHostOfARegionIsNamedAndComesBack) {
    start_all_with_regions();
    std::size_t from = now_in_log();
    programs_["help"]->signal(SIGKILL);
    EXPECT_EQ(programs_["help"]->wait(kPatience), 128 + SIGKILL);
    EXPECT_TRUE(hull_says("host_left_out host=help regions=1", from));
    EXPECT_TRUE(hull_says("metaframe lacks regions", from));
    // the other region is published meanwhile
    const Published without = listen(kNumInstants);
    EXPECT_GE(without.num_complete, static_cast<std::size_t>(kNumInstants));
    EXPECT_EQ(without.num_of_two_meshes, 0u);
    from = now_in_log();
    start("help");
    EXPECT_TRUE(hull_says("host_in_use host=help", from));
    listen(1);  // it may be of before
    EXPECT_GT(listen(kNumInstants).num_of_two_meshes, 0u);
}

TEST_F(SiteWithRegions, HostOfARegionThatStandsStillIsNamedAndComesBack) {
    start_all_with_regions();
    std::size_t from = now_in_log();
    programs_["help"]->signal(SIGSTOP);
    EXPECT_TRUE(hull_says("host_left_out host=help", from));
    from = now_in_log();
    programs_["help"]->signal(SIGCONT);
    EXPECT_TRUE(hull_says("host_in_use host=help", from));
}

// A rig of before a calibration on one host: its hulls and silhouettes would be wrong silently.
TEST_F(SiteWithRegions, HostsWithAnotherRigAreNamed) {
    std::ifstream file(folder_ / "recording" / "rig.toml");
    std::string rig(std::istreambuf_iterator<char>(file), {});
    const auto at = rig.find("fx = ");
    ASSERT_NE(at, std::string::npos);
    rig.insert(at + 5, "1");
    fs::copy(folder_ / "recording", folder_ / "other", fs::copy_options::recursive);
    std::ofstream(folder_ / "other" / "rig.toml") << rig;
    start("hull");
    start("left");
    for (const std::string host : {"right", "help"}) {
        auto command = command_of(host);
        command.insert(command.end(), {"--capture.recording", (folder_ / "other").string()});
        programs_[host] = value(HostedProcess::start(command));
    }
    EXPECT_TRUE(hull_says("host_left_out host=right", 0)) << hull().output();
    EXPECT_THAT(hull().output(), HasSubstr("its rig has other cameras, lenses or poses"));
    EXPECT_TRUE(
        hull_says("regions_failed host=help failed=1 reason=\"its rig or [hull] differs", 0))
        << hull().output();
}

TEST_F(SiteWithRegions, SecondProgramOfAHostIsRefused) {
    start_all_with_regions();
    auto second = value(HostedProcess::start(command_of("help")));
    EXPECT_EQ(second->wait(kPatience), 2) << second->output();
    EXPECT_THAT(second->output(), HasSubstr("region node 'hall.help'"));
}

TEST_F(SiteHosts, KilledHostIsNamedAndComesBack) {
    start_all();
    std::size_t from = now_in_log();
    programs_["left"]->signal(SIGKILL);
    EXPECT_TRUE(hull_says("host_left_out host=left", from));
    EXPECT_TRUE(hull_says("goes on without cameras", from));
    EXPECT_EQ(programs_["left"]->wait(kPatience), 128 + SIGKILL);
    from = now_in_log();
    start("left");
    EXPECT_TRUE(hull_says("host_in_use host=left", from));
    EXPECT_GT(listen(kNumInstants).num_complete, 0u);
}

TEST_F(SiteHosts, HostThatStandsStillIsNamedAndComesBack) {
    start_all();
    std::size_t from = now_in_log();
    programs_["right"]->signal(SIGSTOP);
    EXPECT_TRUE(hull_says("host_left_out host=right", from));
    from = now_in_log();
    programs_["right"]->signal(SIGCONT);
    EXPECT_TRUE(hull_says("host_in_use host=right", from));
    EXPECT_GT(listen(kNumInstants).num_complete, 0u);
}

TEST_F(SiteHosts, TheModelPartStartsAnew) {
    start_all();
    hull().signal(SIGKILL);
    EXPECT_EQ(hull().wait(kPatience), 128 + SIGKILL);
    start("hull");
    EXPECT_TRUE(hull_says("host_in_use host=left", 0));
    EXPECT_TRUE(hull_says("host_in_use host=right", 0));
    EXPECT_GT(listen(kNumInstants).num_complete, 0u);
}

// A narrow link costs metaframes: the camera nodes send no textures that no mesh will name.
TEST_F(SiteHosts, ALimitedRateHoldsForTheTexturesOfAllHosts) {
    auto command = command_of("hull");
    command.insert(command.end(), {"--stream.max_mbit_per_s", "0.15", "--stream.adapt", "on"});
    programs_["hull"] = value(HostedProcess::start(command));
    start("left");
    start("right");
    static const std::regex kReduced("stream level [^\n]*rate=1/([2-9]|[1-6][0-9])");
    ASSERT_TRUE(hull_says("host_in_use host=right", 0));
    EXPECT_TRUE(test_support::comes_true([&] {
        return std::regex_search(hull().output(), kReduced);
    })) << hull().output();
    listen(2);  // the rate has settled
    const Published published = listen(6);
    EXPECT_GE(published.num_complete, 6u);
    // all instants of the recording would be 8 * 6 textures for every 6 meshes
    EXPECT_LE(published.num_textures, 2 * 8 * published.num_complete);
}

TEST_F(SiteHosts, ACameraNodeShowsItsCameras) {
    const fs::path file = folder_ / "preview.png";
    auto command = command_of("right");
    command.insert(command.end(), {"--preview", file.string()});
    programs_["right"] = value(HostedProcess::start(command));
    cv::Mat shown;
    const cv::Size size(640, 480);  // two by two views of half that size
    EXPECT_TRUE(test_support::comes_true([&] {
        shown = fs::exists(file) ? cv::imread(file.string()) : cv::Mat();
        return !shown.empty();
    })) << programs_["right"]->output();
    EXPECT_GE(shown.cols, size.width);
    EXPECT_GE(shown.rows, size.height);
}

TEST_F(SiteHosts, SecondCameraNodeOfAHostIsRefused) {
    start_all();
    auto second = value(HostedProcess::start(command_of("left")));
    EXPECT_EQ(second->wait(kPatience), 2) << second->output();
    EXPECT_THAT(second->output(), HasSubstr("camera node 'hall.left'"));
    EXPECT_GT(listen(kNumInstants).num_complete, 0u);
}

// libfaketime (package faketime) gives a program another clock, which a file may change.
TEST_F(SiteHosts, WrongClockIsNamedAndItsPicturesAreLeftOut) {
    const fs::path offset = folder_ / "offset";
    const auto set = [&](const std::string& text) {
        std::ofstream(folder_ / "offset.new") << text << "\n";
        fs::rename(folder_ / "offset.new", offset);
    };
    set("+0.035s");
    start("hull");
    start("left");
    const std::string library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";
    ASSERT_TRUE(fs::exists(library)) << "install the package faketime";
    start("right",
          {"/usr/bin/env",
           "LD_PRELOAD=" + library,
           "FAKETIME_TIMESTAMP_FILE=" + offset.string(),
           "FAKETIME_NO_CACHE=1",
           "FAKETIME_DONT_FAKE_MONOTONIC=1"});
    EXPECT_TRUE(hull_says("host_in_use host=left", 0));
    // half of the way's time is the largest error: a quarter of the period is 25 ms
    static const std::regex kWrong("host=right[^\n]*clock is (2[5-9]|3[0-9])\\.[0-9] ms ahead");
    EXPECT_TRUE(test_support::comes_true([&] {
        return std::regex_search(hull().output(), kWrong);
    })) << hull().output();
    // set right while it runs
    std::size_t from = now_in_log();
    set("+0.000s");
    EXPECT_TRUE(hull_says("host_in_use host=right", from)) << programs_["right"]->output();
    EXPECT_THAT(programs_["right"]->output(), HasSubstr("clock_was_set"));
    // and off by a whole period: the times alone would not show it
    from = now_in_log();
    set("-0.100s");
    EXPECT_TRUE(hull_says("host_left_out host=right", from));
    from = now_in_log();
    set("+0.000s");
    EXPECT_TRUE(hull_says("host_in_use host=right", from));
    EXPECT_GT(listen(kNumInstants).num_complete, 0u);
}

// The same on hosts of their own, around a hub.
class SiteOnANetwork : public SiteHosts {
protected:
    void start_on(int host, const std::string& name) {
        auto command = command_of(name);
        std::string peers;
        for (int other = 0; other < 3; ++other) {
            if (other != host) peers += (peers.empty() ? "" : ",") + network_->address(other);
        }
        command.insert(command.end(), {"--network", "lan", "--peers", peers});
        programs_[name] = value(network_->start(host, command));
    }
    std::unique_ptr<ImpairedNetwork> network_;
};

// Cyclone DDS wakes receive threads by packets to this host, unless qos/lan.xml forbids it.
TEST_F(SiteOnANetwork, AProgramWhoseCardVanishedEnds) {
    auto network = ImpairedNetwork::create(2, 7);
    if (!network) GTEST_SKIP() << test::skip::kNoNetwork << network.error().message;
    network_ = std::move(*network);
    auto command = command_of("hull");
    command.insert(command.end(), {"--network", "lan"});
    programs_["hull"] = value(network_->start(0, command));
    ASSERT_TRUE(hull_says("source opened", 0)) << hull().output();
    auto flush =
        value(network_->start(0, {"/bin/sh", "-c", "ip addr flush dev " + std::string(kLinkName)}));
    ASSERT_EQ(flush->wait(kPatience), 0) << flush->output();
    // TearDown ends the program
}

TEST_F(SiteOnANetwork, HostThatIsCutOffOrSlowIsNamedAndComesBack) {
    auto network = ImpairedNetwork::create(3, 7);
    if (!network) GTEST_SKIP() << test::skip::kNoNetwork << network.error().message;
    network_ = std::move(*network);
    start_on(0, "hull");
    start_on(1, "left");
    start_on(2, "right");
    for (const std::string host : {"left", "right"})
        ASSERT_TRUE(hull_says("host_in_use host=" + host, 0)) << hull().output();
    std::size_t from = now_in_log();
    network_->cut(1);
    EXPECT_TRUE(hull_says("host_left_out host=left", from));
    from = now_in_log();
    network_->restore(1);
    EXPECT_TRUE(hull_says("host_in_use host=left", from)) << hull().output();
    // so slow that its silhouettes come after the deadline
    from = now_in_log();
    Impairment slow;
    slow.delay = 160ms;
    network_->set(2, Way::kUp, slow);
    EXPECT_TRUE(hull_says("host_left_out host=right", from)) << hull().output();
    from = now_in_log();
    network_->set(2, Way::kUp, {});
    EXPECT_TRUE(hull_says("host_in_use host=right", from)) << hull().output();
}

}  // namespace
}  // namespace atrium::test
