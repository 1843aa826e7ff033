#include "tests/integration/site_hosts_fixture.hpp"
#include "tests/support/network/impaired_network.hpp"
#include "tests/support/network/network_host.hpp"
#include "tests/support/skips.hpp"

#include <opencv2/imgcodecs.hpp>

#include <regex>

// A site of which two hosts have the cameras and a third one computes the hull, as programs that
// users would start. Faults: hosts that are killed, stand still, are cut off, have a wrong clock,
// come back, and come twice.
namespace atrium::test {
namespace {

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
    // from this rate on, the textures of all instants would be more than the bound below
    static const std::regex kReduced("stream level [^\n]*rate=1/([4-9]|[1-6][0-9])");
    ASSERT_TRUE(hull_says("host_in_use host=right", 0));
    EXPECT_TRUE(test_support::comes_true([&] {
        return std::regex_search(hull().output(), kReduced);
    })) << hull().output();
    // the rate settles, and a machine that stood still may have given a partial metaframe
    EXPECT_TRUE(test_support::comes_true([&] {
        const Published published = listen(6);
        return published.num_complete >= 6 &&
               published.num_textures <= 2 * 8 * published.num_complete;
    }));
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
