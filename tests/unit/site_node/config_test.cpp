#include "site_node/config.hpp"

#include "site_node/site_node.hpp"
#include "site_node/start_check.hpp"
#include "tests/support/source_dir.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>

namespace atrium::site_node {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kRoom = "[capture]\nrig = \"rig.toml\"\n";

Expected<SiteNodeConfig> parse(const std::string& text) {
    SiteNodeConfig config;
    config::OptionSet set;
    declare(config, set);
    auto reader = config::TableReader::parse(text, "site.toml");
    if (!reader) return tl::unexpected(reader.error());
    set.read_file(*reader);
    read_hull(*reader, config);
    read_segmentation(*reader, config.pipeline);
    read_cameras(*reader, config.capture.cameras);
    if (const auto read = reader->finish(); !read) return tl::unexpected(read.error());
    if (const auto valid = check(config); !valid) return tl::unexpected(valid.error());
    return config;
}

TEST(SiteConfig, TreatsSpaceOutsideThePicturesAsEmptyByDefault) {
    const auto config = parse(kRoom);
    ASSERT_TRUE(config) << config.error().message;
    const HullStageOptions& hull = config->pipeline.hull;
    EXPECT_FALSE(hull.bounds);
    EXPECT_FALSE(hull.partial_views);
    EXPECT_EQ(hull.min_views, 0u);
    EXPECT_EQ(hull.min_component_l, 0.005);
    EXPECT_EQ(hull.refine, "off");
    EXPECT_TRUE(hull.pause_refinement);
    EXPECT_TRUE(hull.regions.empty());
    EXPECT_EQ(config->capture.min_cameras, 0);
}

TEST(SiteConfig, ReadsBoundsAndPartialViews) {
    const auto config = parse(kRoom +
                              "min_cameras = 6\n[hull]\nmin_views = 3\nmin_component_l = 0.5\n"
                              "refine = \"round\"\n"
                              "partial_views = true\nwhole_cameras = [\"top\"]\n"
                              "[hull.bounds]\nmin = [-1, -2, 0]\nmax = [1, 2, 2.5]\n");
    ASSERT_TRUE(config) << config.error().message;
    const HullStageOptions& hull = config->pipeline.hull;
    ASSERT_TRUE(hull.bounds);
    EXPECT_EQ(hull.bounds->min, Eigen::Vector3d(-1, -2, 0));
    EXPECT_EQ(hull.bounds->max, Eigen::Vector3d(1, 2, 2.5));
    EXPECT_EQ(hull.min_views, 3u);
    EXPECT_EQ(hull.min_component_l, 0.5);
    EXPECT_EQ(hull.refine, "round");
    EXPECT_TRUE(hull.partial_views);
    EXPECT_THAT(hull.whole_cameras, ElementsAre("top"));
    EXPECT_EQ(config->capture.min_cameras, 6);
}

TEST(SiteConfig, ChoosesPositionBitsUnlessGiven) {
    EXPECT_EQ(parse(kRoom)->pipeline.mesh.position_bits, 0);
    EXPECT_EQ(parse(kRoom + "[codec]\nposition_bits = 12\n")->pipeline.mesh.position_bits, 12);
    const auto few = parse(kRoom + "[codec]\nposition_bits = 7\n");
    ASSERT_FALSE(few);
    EXPECT_THAT(few.error().message, HasSubstr("codec.position_bits"));
}

TEST(SiteConfig, ReadsAreasOfCameras) {
    const auto config = parse(kRoom +
                              "[segmentation]\nmax_hole_px = 30\n"
                              "[[segmentation.camera]]\nname = \"left\"\n"
                              "include = [[0, 0], [640, 0.5], [640, 300]]\n"
                              "[[segmentation.camera]]\nname = \"left\"\n"
                              "exclude = [[-1, 2], [3, 4], [5, 6], [7, 8]]\n");
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_EQ(config->pipeline.segmentation.max_hole_px, 30);
    const auto areas = areas_of(config->pipeline.areas, "left");
    ASSERT_EQ(areas.include.size(), 1u);
    EXPECT_EQ(areas.include[0][1], (std::array<double, 2>{640, 0.5}));
    ASSERT_EQ(areas.exclude.size(), 1u);
    EXPECT_EQ(areas.exclude[0].size(), 4u);
    EXPECT_TRUE(areas_of(config->pipeline.areas, "right").everywhere());
}

TEST(SiteConfig, RefusesAreasWithoutCornersOrName) {
    const std::string camera = kRoom + "[[segmentation.camera]]\n";
    EXPECT_THAT(parse(camera + "include = [[0, 0], [1, 0], [1, 1]]\n").error().message,
                HasSubstr("name"));
    EXPECT_THAT(parse(camera + "name = \"a\"\ninclude = [[0, 0], [1, 0]]\n").error().message,
                HasSubstr("3 corners"));
    for (const std::string bad :
         {"3", "[1, 2, 3]", "[[0, 0], [1, 0], [1]]", "[[0, 0], [1, \"x\"]]"}) {
        EXPECT_THAT(parse(camera + "name = \"a\"\nexclude = " + bad + "\n").error().message,
                    HasSubstr("[x, y]"));
    }
}

TEST(SiteConfig, AcceptsTheShortFormOfARecording) {
    auto config = parse("recording = \"here\"\n" + kRoom);
    ASSERT_TRUE(config) << config.error().message;
    resolve(*config);
    EXPECT_EQ(config->capture.source, "recording");
    EXPECT_EQ(config->capture.recording, "here");
}

TEST(SiteConfig, AdaptsTheStreamToNetworksNotToABusyHost) {
    const auto adapts = [](const std::string& text) {
        auto config = parse(kRoom + text);
        EXPECT_TRUE(config) << config.error().message;
        resolve(*config);
        return config->stream.adapt;
    };
    EXPECT_FALSE(adapts(""));
    EXPECT_TRUE(adapts("[bus]\nnetwork = \"wan\"\n"));
    EXPECT_TRUE(adapts("[stream]\nadapt = \"on\"\n"));
    EXPECT_FALSE(adapts("[bus]\nnetwork = \"lan\"\n[stream]\nadapt = \"off\"\n"));
    EXPECT_THAT(parse(kRoom + "[stream]\nadapt = \"maybe\"\n").error().message, HasSubstr("auto"));
}

TEST(SiteConfig, ReadsRegions) {
    const auto config = parse(
        kRoom +
        "[[hull.region]]\nname = \"stage\"\nbounds = { min = [0, 0, 0], max = [2, 2, 2] }\n"
        "cameras = [\"a\", \"b\"]\n"
        "[[hull.region]]\nname = \"stairs\"\nbounds = { min = [2, 0, 0], max = [4, 2, 2] }\n");
    ASSERT_TRUE(config) << config.error().message;
    const auto& regions = config->pipeline.hull.regions;
    ASSERT_EQ(regions.size(), 2u);
    EXPECT_EQ(regions[0].name, "stage");
    EXPECT_THAT(regions[0].cameras, ElementsAre("a", "b"));
    EXPECT_EQ(regions[1].bounds.max, Eigen::Vector3d(4, 2, 2));
    EXPECT_TRUE(regions[1].cameras.empty());
    EXPECT_TRUE(overlapping_regions(regions).empty());  // they touch
}

TEST(SiteConfig, TakesBoundsFromTheCommandLine) {
    SiteNodeConfig config;
    config::OptionSet set;
    declare(config, set);
    ASSERT_TRUE(set.set("hull.bounds", "-1,-2,0, 1,2,2.5", "--hull.bounds"));
    ASSERT_TRUE(config.pipeline.hull.bounds);
    EXPECT_EQ(config.pipeline.hull.bounds->min, Eigen::Vector3d(-1, -2, 0));
    EXPECT_EQ(config.pipeline.hull.bounds->max, Eigen::Vector3d(1, 2, 2.5));
    for (const char* wrong : {"", "1,2,3", "0,0,0,1,1,0", "0,0,0,1,1,x", "0,0,0,1,1,1e5", "1;2"}) {
        const auto result = set.set("hull.bounds", wrong, "--hull.bounds");
        ASSERT_FALSE(result) << wrong;
        EXPECT_THAT(result.error().message, HasSubstr("--hull.bounds: must be X0,Y0,Z0,X1,Y1,Z1"));
    }
    EXPECT_EQ(config.pipeline.hull.bounds->max.x(), 1.0) << "a wrong value must change nothing";
}

TEST(SiteConfig, TakesBoundsFromTheRigOnlyWithoutItsOwn) {
    config::Rig rig;
    rig.bounds_site = geometry::Aabb{{-1, -1, 0}, {1, 1, 2}};
    HullStageOptions hull;
    take_bounds(rig, hull);
    EXPECT_FALSE(hull.bounds) << "made up for the debug view only";
    rig.has_bounds = true;
    take_bounds(rig, hull);
    ASSERT_TRUE(hull.bounds);
    EXPECT_EQ(hull.bounds->max.z(), 2.0);
    hull.bounds->max.z() = 1.0;
    take_bounds(rig, hull);
    EXPECT_EQ(hull.bounds->max.z(), 1.0);
    HullStageOptions with_regions;
    with_regions.regions.resize(1);
    take_bounds(rig, with_regions);
    EXPECT_FALSE(with_regions.bounds);
    rig.cameras.resize(63);
    HullStageOptions many;
    take_bounds(rig, many);
    EXPECT_FALSE(many.bounds) << "bounds take two of 64 views";
}

TEST(SiteConfig, ErrorsNameFileLineKeyAndWhatIsAllowed) {
    const std::string box = "bounds = { min = [0, 0, 0], max = [1, 1, 1] }\n";
    const std::string region = "[[hull.region]]\nname = \"a\"\n";
    const struct {
        std::string text;
        std::vector<std::string> named;
    } cases[] = {
        {"min_cameras = 65\n", {"site.toml:3", "capture.min_cameras", "[0, 64]", "65"}},
        {"min_cameras = 1\n", {"capture.min_cameras", "at least 2"}},
        {"[hull]\nmin_views = -1\n", {"site.toml:4", "hull.min_views"}},
        {"[hull]\nmin_component_l = \"x\"\n", {"site.toml:4", "hull.min_component_l"}},
        {"[hull]\nmin_component_m3 = 1\n", {"hull.min_component_m3", "unknown", "component_l"}},
        {"[hull]\nbounds = [0, 1]\n", {"site.toml:4", "hull.bounds", "table"}},
        {"[hull.bounds]\nmin = [0, 0, 0]\n", {"hull.bounds.max", "missing"}},
        {"[hull.bounds]\nmin = [0, 0]\nmax = [1, 1, 1]\n",
         {"site.toml:4", "hull.bounds.min", "3 numbers"}},
        {"[hull.bounds]\nmin = [0, 0, 0]\nmax = [1, 1, 0]\n",
         {"site.toml:5", "hull.bounds.max", "larger than min"}},
        {"[hull]\nwhole_cameras = [\"a\"]\n",
         {"site.toml:4: hull.whole_cameras", "hull.partial_views"}},
        {"[hull]\nwhole_cameras = \"a\"\n", {"site.toml:4", "hull.whole_cameras", "strings"}},
        {"[[hull.region]]\n" + box, {"site.toml:3", "hull.region[0].name", "missing"}},
        {"[[hull.region]]\nname = \"a b\"\n" + box, {"site.toml:4", "hull.region[0].name"}},
        {region, {"hull.region[0].bounds", "missing"}},
        {region + box + "cameras = [1]\n", {"site.toml:6", "hull.region[0].cameras", "strings"}},
        {region + box + "colour = 1\n", {"site.toml:6", "hull.region[0].colour", "unknown"}},
        {region + box + region + box, {"site.toml:7", "hull.region[1].name", "different"}},
        {"[hull]\n" + box + region + box, {"site.toml:4: hull.bounds", "[[hull.region]]"}},
    };
    for (const auto& c : cases) {
        const auto config = parse(kRoom + c.text);
        const std::string message = config ? "no error" : config.error().message;
        for (const std::string& part : c.named) EXPECT_THAT(message, HasSubstr(part)) << c.text;
        if (config) continue;
        EXPECT_EQ(config.error().kind, ErrorKind::kConfiguration);
    }
}

TEST(SiteConfig, ListsFileOnlySettingsToo) {
    SiteNodeConfig config;
    config::OptionSet set;
    declare(config, set);
    EXPECT_THAT(
        set.effective(),
        testing::AllOf(HasSubstr("hull.bounds = none\n"), HasSubstr("hull.whole_cameras = []\n")));
    HullStageOptions& hull = config.pipeline.hull;
    hull.bounds = geometry::Aabb{{-1, -2, 0}, {1, 2, 2.5}};
    hull.whole_cameras = {"top", "side"};
    hull.regions = {{"stage", *hull.bounds, {"a", "b"}}, {"stairs", *hull.bounds, {}}};
    EXPECT_THAT(set.effective(), HasSubstr("hull.bounds = [-1, -2, 0] to [1, 2, 2.5]\n"));
    EXPECT_THAT(set.effective(),
                HasSubstr("hull.whole_cameras = [top, side]\n"
                          "hull.region = stage [-1, -2, 0] to [1, 2, 2.5] cameras [a, b], "
                          "stairs [-1, -2, 0] to [1, 2, 2.5] cameras []\n"));
}

TEST(SiteConfig, NamesMismatchesWithTheRigByFileAndLine) {
    const auto rig = config::load_rig(atrium::test::source_dir() + "/deploy/rigs/table.toml");
    ASSERT_TRUE(rig) << rig.error().message;
    const std::string box = "bounds = { min = [0, 0, 0], max = [1, 1, 1] }\n";
    const struct {
        std::string text;
        std::string named;
    } cases[] = {
        {"[hull]\nmin_views = 60\n", "site.toml:4: hull.min_views: must not exceed"},
        {"[hull]\npartial_views = true\nwhole_cameras = [\"x\"]\n" + box,
         "site.toml:5: hull.whole_cameras: no camera is named 'x'"},
        {"[[hull.region]]\nname = \"a\"\n" + box + "[[hull.region]]\nname = \"b\"\n" + box +
             "cameras = [\"x\"]\n",
         "site.toml:9: hull.region[1].cameras: no camera is named 'x'"},
    };
    for (const auto& c : cases) {
        auto config = parse(kRoom + c.text);
        ASSERT_TRUE(config) << config.error().message;
        HullStageOptions& hull = config->pipeline.hull;
        const auto stage = HullStage::create(rig->cameras, hull, 0.75);
        ASSERT_FALSE(stage);
        EXPECT_THAT(stage.error().message, testing::StartsWith(c.named));
        if (hull.min_views == 0) continue;
        hull.min_views = 50;  // as if from the command line: the file does not contain it
        EXPECT_THAT(HullStage::create(rig->cameras, hull, 0.75).error().message,
                    testing::StartsWith("hull.min_views: must not exceed"));
    }
}

TEST(SiteConfig, NamesRegionsThatOverlap) {
    const geometry::Aabb left{{0, 0, 0}, {2, 2, 2}};
    const geometry::Aabb right{{1.9, 0, 0}, {4, 2, 2}};
    const geometry::Aabb above{{0, 0, 2}, {4, 2, 4}};
    EXPECT_THAT(overlapping_regions(std::vector<RegionOptions>{
                    {"left", left, {}}, {"above", above, {}}, {"right", right, {}}}),
                ElementsAre("left and right"));
}

TEST(SiteConfig, OfEveryDeliveredSiteIsValid) {
    int num_sites = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(atrium::test::source_dir() + "/deploy/sites")) {
        if (entry.path().extension() != ".toml") continue;
        ++num_sites;
        auto reader = config::TableReader::load(entry.path());
        ASSERT_TRUE(reader) << reader.error().message;
        SiteNodeConfig config;
        config::OptionSet set;
        declare(config, set);
        set.read_file(*reader);
        read_tables(*reader, config);
        const auto read = reader->finish();
        ASSERT_TRUE(read) << read.error().message;
        if (config.capture.source == "recording") continue;  // the user chooses the recording
        const auto valid = check(config);
        ASSERT_TRUE(valid) << valid.error().message;
        const auto rig = config::load_rig(config.capture.rig);
        ASSERT_TRUE(rig) << rig.error().message;
        const auto stage = HullStage::create(
            rig->cameras, config.pipeline.hull, config.pipeline.silhouette.tolerance_px);
        EXPECT_TRUE(stage) << entry.path() << ": " << stage.error().message;
    }
    EXPECT_GT(num_sites, 3);
}

const std::string kCameras = R"(
[capture]
source = "cameras"
rig = "rig.toml"
trigger = "external"
deadline_ms = 80
min_cameras = 2
[segmentation]
background_frames = 30
[capture.cameras]
pixel_format = "BayerRG8"
gain_db = 3.0
)";

TEST(CameraConfig, ReadsCamerasWithTheirOwnSettings) {
    const auto config = parse(kCameras + R"(
[[capture.camera]]
name = "north"
serial = "4711"
[[capture.camera]]
name = "south"
address = "192.168.1.12"
exposure_us = 2500.0
region_px = [16, 8, 640, 480]
)");
    ASSERT_TRUE(config) << config.error().message;
    const capture::CamerasOptions options =
        cameras_options(config->capture.cameras, 2, std::chrono::milliseconds(80));
    ASSERT_EQ(options.cameras.size(), 2u);
    EXPECT_EQ(options.cameras[0].serial, "4711");
    EXPECT_EQ(options.cameras[1].address, "192.168.1.12");
    EXPECT_EQ(options.trigger, capture::TriggerMode::kExternal);
    EXPECT_EQ(config->pipeline.background.num_frames, 30);
    EXPECT_EQ(options.min_cameras, 2u);
    const auto south = merged(options.common, options.cameras[1].settings);
    EXPECT_EQ(south.pixel_format, "BayerRG8");
    EXPECT_EQ(south.exposure_us, 2500.0);
    EXPECT_EQ(south.gain_db, 3.0);
    ASSERT_TRUE(south.region_px);
    EXPECT_THAT(*south.region_px, ElementsAre(16, 8, 640, 480));
}

TEST(CameraConfig, NamesTheKeyOfAWrongCamera) {
    const auto message = [](const std::string& text) {
        const auto config = parse(text);
        return config ? std::string("no error") : config.error().message;
    };
    const std::string north = "[[capture.camera]]\nname = \"north\"\n";
    EXPECT_THAT(message(kCameras), HasSubstr("needs a [[capture.camera]]"));
    EXPECT_THAT(message("[capture]\nsource = \"cameras\"\n"), HasSubstr("capture.rig"));
    EXPECT_THAT(message(kCameras + north), HasSubstr("the serial or the address"));
    EXPECT_THAT(message(kCameras + north + "serial = \"1\"\ngian_db = 2.0\n"),
                HasSubstr("gian_db"));
    EXPECT_THAT(message(kCameras + north + "serial = \"1\"\npixel_format = \"Mono12\"\n"),
                HasSubstr("BayerRG8"));
    EXPECT_THAT(message(kCameras + north + "serial = \"1\"\nregion_px = [0, 0, 10.5, 8]\n"),
                HasSubstr("region_px"));
    EXPECT_THAT(message(kCameras + north + "serial = \"1\"\n" + north + "serial = \"2\"\n"),
                HasSubstr("different for every camera"));
    EXPECT_THAT(message(kCameras + "buffers = 2\n" + north + "serial = \"1\"\n"),
                HasSubstr("capture.cameras.buffers"));
    EXPECT_THAT(message(kCameras + "packet_size = 70000\n" + north + "serial = \"1\"\n"),
                HasSubstr("packet_size"));
}

TEST(SourceRate, IsTheOneAtWhichTheSourceRuns) {
    config::Rig rig;
    rig.rate_hz = 30.0;
    SiteNodeConfig config;
    config.capture.source = "recording";
    EXPECT_EQ(source_rate_text(config, rig), "30");
    config.capture.every = 4;
    EXPECT_EQ(source_rate_text(config, rig), "7.5");
    config.capture.rate_hz = 15.0;
    EXPECT_EQ(source_rate_text(config, rig), "15") << "of the pictures that are taken";
    config.capture.as_fast_as_possible = true;
    EXPECT_EQ(source_rate_text(config, rig), "unpaced");
}

}  // namespace
}  // namespace atrium::site_node
