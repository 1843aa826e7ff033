#include "site_node/hosts/site_hosts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::hosts {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

config::Rig rig_of(std::size_t num_cameras) {
    config::Rig rig;
    for (std::size_t i = 0; i < num_cameras; ++i)
        rig.cameras.emplace_back().name = "cam" + std::to_string(i);
    return rig;
}

Expected<std::vector<HostEntry>> read(const std::string& text) {
    auto reader = config::TableReader::parse(text, "site.toml");
    if (!reader) return tl::unexpected(reader.error());
    std::vector<HostEntry> hosts;
    read_hosts(*reader, hosts);
    if (auto done = reader->finish(); !done) return tl::unexpected(done.error());
    return hosts;
}

std::string problem(const std::string& text, const std::string& site = "hall") {
    const auto hosts = read(text);
    if (!hosts) return hosts.error().message;
    const std::vector<std::string> regions{"door", "window"};
    const auto checked = check_hosts(*hosts, rig_of(4), regions, site);
    return checked ? "" : checked.error().message;
}

constexpr const char* kGood = R"(
[[host]]
name = "left"
cameras = ["cam0", "cam1"]
[[host]]
name = "right"
cameras = ["cam2", "cam3"]
[[host]]
name = "hull"
model = true
)";

TEST(SiteHosts, ReadsWhichCamerasHangWhere) {
    const auto hosts = read(kGood);
    ASSERT_TRUE(hosts) << hosts.error().message;
    EXPECT_EQ(problem(kGood), "");
    EXPECT_THAT(find_host(*hosts, "left")->cameras, ElementsAre("cam0", "cam1"));
    EXPECT_FALSE(find_host(*hosts, "left")->is_model);
    EXPECT_TRUE(find_host(*hosts, "hull")->is_model);
    EXPECT_THAT(find_host(*hosts, "attic").error().message,
                HasSubstr("no [[host]] of the site is named 'attic'; there are left, right, hull; "
                          "--host NAME"));
    EXPECT_THAT(find_host(*hosts, "lefft").error().message,
                HasSubstr("hull (did you mean left?); --host NAME"));
}

TEST(SiteHosts, AutoTakesTheCamerasThatNoOtherHostNames) {
    const auto hosts = read(R"(
[[host]]
name = "left"
cameras = ["cam2"]
[[host]]
name = "right"
cameras = "auto"
model = true
)");
    ASSERT_TRUE(hosts) << hosts.error().message;
    EXPECT_TRUE(check_hosts(*hosts, rig_of(4), {}, "hall"));
    EXPECT_THAT(cameras_of((*hosts)[0], *hosts, rig_of(4)), ElementsAre("cam2"));
    EXPECT_THAT(cameras_of((*hosts)[1], *hosts, rig_of(4)), ElementsAre("cam0", "cam1", "cam3"));
}

TEST(SiteHosts, NamesWhatIsWrongAndWhere) {
    const std::string left = "[[host]]\nname = \"left\"\ncameras = ";
    const std::string model = "\n[[host]]\nname = \"hull\"\nmodel = true\n";
    EXPECT_THAT(problem("[[host]]\ncameras = \"auto\"\n"), HasSubstr("name"));
    EXPECT_THAT(problem("[[host]]\nname = \"a b\"\ncameras = \"auto\"\n"),
                HasSubstr("must be 1 to 63 characters"));
    EXPECT_THAT(problem("[[host]]\nname = \"a\"\n"), HasSubstr("has nothing to do"));
    EXPECT_THAT(problem(left + "\"any\"" + model), HasSubstr("auto"));
    EXPECT_THAT(problem(left + "[\"cam0\"]" + model),
                HasSubstr("site.toml:2: host: camera 'cam1' hangs on none: add it"));
    EXPECT_THAT(problem(left + "[\"cam0\", \"cam9\"]" + model),
                HasSubstr("'left' has camera 'cam9', which the rig lacks; it has cam0, cam1"));
    EXPECT_THAT(problem(left + "[\"cam0\", \"cam0\"]" + model),
                HasSubstr("camera 'cam0' is twice on 'left'"));
    EXPECT_THAT(problem(left + "\"auto\"\n"), HasSubstr("none has model = true"));
    EXPECT_THAT(problem(left + "\"auto\"" + model + model), HasSubstr("two are named 'hull'"));
    EXPECT_THAT(problem(left + "\"auto\"\nmodel = true" + model), HasSubstr("both have model"));
    EXPECT_EQ(problem(left + "\"auto\"\n[[host]]\nname = \"b\"\ncameras = \"auto\"" + model), "");
    EXPECT_THAT(problem(left + "\"auto\"" + model, std::string(60, 's')),
                HasSubstr("must have at most 62 characters"));
    EXPECT_THAT(problem(left + "\"auto\"\nmodle = true"), HasSubstr("model"));
    const std::string helper = "\n[[host]]\nname = \"help\"\nregions = ";
    EXPECT_EQ(problem(left + "\"auto\"" + helper + "[\"door\"]" + model), "");
    EXPECT_THAT(problem(left + "\"auto\"" + helper + "[\"attic\"]" + model),
                HasSubstr("'help' computes region 'attic', which the file lacks; its "
                          "[[hull.region]] are door, window"));
    EXPECT_THAT(problem(left + "\"auto\"" + helper + "[\"door\", \"door\"]" + model),
                HasSubstr("region 'door' is twice on 'help'"));
    EXPECT_THAT(problem("[[host]]\nname = \"a\"\ncamera = [\"cam0\"]\n"),
                HasSubstr("did you mean host[0].cameras?"));
}

TEST(SiteHosts, TheFingerprintOfAPartCoversRigRateAndOwnCameras) {
    const auto hosts = read(kGood);
    ASSERT_TRUE(hosts);
    config::Rig rig = rig_of(4);
    rig.rate_hz = 30.0;
    HostEntry left = (*hosts)[0];
    const std::uint64_t before = part_fingerprint(rig, left);
    left.cores = 8;
    std::ranges::reverse(left.cameras);
    EXPECT_EQ(part_fingerprint(rig, left), before);
    left.cameras.pop_back();
    EXPECT_NE(part_fingerprint(rig, left), before);
    config::Rig other = rig;
    other.rate_hz = 25.0;
    EXPECT_NE(part_fingerprint(other, (*hosts)[0]), before);
    other = rig;
    other.cameras[1].intrinsics.fx += 1.0;
    EXPECT_NE(part_fingerprint(other, (*hosts)[0]), before);
}

TEST(SiteHosts, RegionsOfTheModelPartAreOnNoOtherHost) {
    const auto hosts = read(R"(
[[host]]
name = "help"
regions = ["door"]
[[host]]
name = "hull"
model = true
cameras = "auto"
regions = ["window"]
)");
    ASSERT_TRUE(hosts) << hosts.error().message;
    ASSERT_NE(host_of_region(*hosts, "door"), nullptr);
    EXPECT_EQ(host_of_region(*hosts, "door")->name, "help");
    EXPECT_EQ(host_of_region(*hosts, "window"), nullptr);
    EXPECT_EQ(host_of_region(*hosts, "desk"), nullptr);
}

}  // namespace
}  // namespace atrium::hosts
