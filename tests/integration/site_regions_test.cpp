#include "tests/integration/site_hosts_fixture.hpp"

// A site of which one host only computes the hull of a region.
namespace atrium::test {
namespace {

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
    EXPECT_THAT(hull().output(), HasSubstr("its rig, its rate or its cameras"));
    EXPECT_TRUE(hull_says(
        "host_left_out host=help regions=1 reason=\"its rig, [hull] or regions differ", 0))
        << hull().output();
}

TEST_F(SiteWithRegions, SecondProgramOfAHostIsRefused) {
    start_all_with_regions();
    auto second = value(HostedProcess::start(command_of("help")));
    EXPECT_EQ(second->wait(kPatience), 2) << second->output();
    EXPECT_THAT(second->output(), HasSubstr("region node 'hall.help'"));
}

}  // namespace
}  // namespace atrium::test
