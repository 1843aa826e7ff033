#include "tests/support/run_program.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

// Starts the programs as a user does, with typical mistakes.
namespace atrium {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

using test_support::Outcome;

Outcome run(const std::string& command, const std::string& before = "") {
    return test_support::run_program(ATRIUM_BIN_DIR "/" + command, 60, before);
}

class CommandLine : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) / "atrium_command_line";
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string file(const std::string& name, const std::string& text) {
        fs::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name) << text;
        return (folder_ / name).string();
    }

    fs::path folder_;
};

TEST_F(CommandLine, NetworkFileErrorIsNamedBeforeTheRoomOpens) {
    const std::string network = file("net.xml",
                                     "<CycloneDDS>\n  <Domain Id='any'>\n    <Generl/>\n"
                                     "  </Domain>\n</CycloneDDS>\n");
    const Outcome got =
        run("site_node --capture.source simulated --capture.rig " + atrium::test::source_dir() +
            "/deploy/rigs/table.toml --simulation.cache '' --network " + network);
    EXPECT_EQ(got.exit_code, 2);
    EXPECT_THAT(got.output,
                AllOf(HasSubstr(network + ": "), HasSubstr("Generl"), HasSubstr("(line 3)")));
    EXPECT_THAT(got.output, Not(HasSubstr("source opened")));
    // listing options with their defaults would hide the error
    EXPECT_THAT(got.output, AllOf(HasSubstr("bus.network = "), Not(HasSubstr("hull.min_views"))));
}

TEST_F(CommandLine, EveryProgramPrintsHelpAndVersion) {
    for (const std::string program : {"site_node",
                                      "camera_node",
                                      "keys",
                                      "plan",
                                      "site_control",
                                      "world_server",
                                      "viewer",
                                      "visual_hull",
                                      "demo",
                                      "doctor",
                                      "monitor",
                                      "record",
                                      "play",
                                      "export",
                                      "simulated_cameras"}) {
        const Outcome help = run(program + " --help");
        EXPECT_EQ(help.exit_code, 0) << program;
        EXPECT_THAT(help.output, HasSubstr("--help")) << program;
        const Outcome version = run(program + " --version");
        EXPECT_EQ(version.exit_code, 0) << program;
        EXPECT_THAT(version.output, HasSubstr(program)) << program;
        const Outcome unknown = run(program + " --no-such-option");
        EXPECT_EQ(unknown.exit_code, 2) << program;
        EXPECT_THAT(unknown.output, HasSubstr("--no-such-option")) << program;
    }
}

TEST_F(CommandLine, FrontCommandRunsEveryTool) {
    for (const std::string command : {"demo",
                                      "monitor",
                                      "record",
                                      "play",
                                      "export",
                                      "keys",
                                      "plan",
                                      "cameras",
                                      "hull",
                                      "doctor"}) {
        const Outcome help = run("atrium help " + command);
        EXPECT_EQ(help.exit_code, 0) << command;
        EXPECT_THAT(help.output, HasSubstr("--version")) << command;
        EXPECT_EQ(run("atrium " + command + " --no-such-option").exit_code, 2) << command;
    }
}

TEST_F(CommandLine, UnknownKeysAreNamedWithFileAndLine) {
    const std::string config = file("site.toml", "[site]\nname = \"lab\"\n[capture]\nrate = 30\n");
    const Outcome outcome = run("site_node --config " + config);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.output,
                AllOf(HasSubstr("site.toml:4"), HasSubstr("capture.rate"), HasSubstr("rate_hz")));
    for (const std::string program : {"world_server", "viewer"}) {
        const Outcome other = run(program + " --config " + file("p.toml", "[bus]\nwrld = \"x\"\n"));
        EXPECT_EQ(other.exit_code, 2);
        EXPECT_THAT(other.output, AllOf(HasSubstr("p.toml:2"), HasSubstr("bus.wrld")));
    }
}

TEST_F(CommandLine, IllTypedValuesNameAllowedOnes) {
    const Outcome in_file =
        run("site_node --config " + file("site.toml", "[site]\nthreads = \"two\"\n"));
    EXPECT_EQ(in_file.exit_code, 2);
    EXPECT_THAT(in_file.output, AllOf(HasSubstr("site.toml:2"), HasSubstr("integer in [0, 64]")));
    const Outcome on_line = run("site_node --site.threads 65");
    EXPECT_EQ(on_line.exit_code, 2);
    EXPECT_THAT(on_line.output,
                AllOf(HasSubstr("--site.threads"), HasSubstr("integer in [0, 64]")));
    const Outcome object =
        run("world_server --config " +
            file("w.toml", "[[object]]\nname = \"b\"\nshape = \"cone\"\nsize_m = [1, 1, 1]\n"));
    EXPECT_EQ(object.exit_code, 2);
    EXPECT_THAT(object.output, AllOf(HasSubstr("w.toml:3"), HasSubstr("shape")));
}

TEST_F(CommandLine, MissingFilesAndRecordingsAreNamed) {
    const Outcome config = run("viewer --config /nonexistent/v.toml");
    EXPECT_EQ(config.exit_code, 3);
    EXPECT_THAT(config.output, HasSubstr("/nonexistent/v.toml"));
    const Outcome recording =
        run("site_node --capture.source recording --capture.recording /nonexistent/rec");
    EXPECT_EQ(recording.exit_code, 3);
    EXPECT_THAT(recording.output, HasSubstr("/nonexistent/rec"));
    const Outcome views = run("visual_hull /nonexistent/views.json");
    EXPECT_EQ(views.exit_code, 3);
    EXPECT_THAT(views.output, HasSubstr("/nonexistent/views.json"));
    const Outcome network = run("world_server --network /nonexistent/net.xml");
    EXPECT_NE(network.exit_code, 0);
    EXPECT_THAT(network.output, HasSubstr("/nonexistent/net.xml"));
}

const std::string kLens = "width = 64\nheight = 48\nfx = 60\nfy = 60\ncx = 31.5\ncy = 23.5\n";
const std::string kCamera = kLens + "translation = [0, 0, 3]\n";
const std::string kCameraBeside = kLens + "translation = [1, 0, 3]\n";

TEST_F(CommandLine, CameraWithASingularMatrixIsNamed) {
    file("rec/rig.toml",
         "[[camera]]\nname = \"good\"\nrotation = [1,0,0,0,1,0,0,0,1]\n" + kCamera +
             "[[camera]]\nname = \"flat\"\nrotation = [1,0,0,0,1,0,0,0,0]\n" + kCamera);
    const Outcome outcome = run("site_node --capture.source recording --capture.recording " +
                                (folder_ / "rec").string());
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.output,
                AllOf(HasSubstr("rig.toml:"), HasSubstr("'flat'"), HasSubstr("rotation matrix")));
}

TEST_F(CommandLine, RecordingWithoutBackgroundNamesTheCamera) {
    file("rec/rig.toml",
         "[[camera]]\nname = \"a\"\nrotation = [1,0,0,0,1,0,0,0,1]\n" + kCamera +
             "[[camera]]\nname = \"b\"\nrotation = [1,0,0,0,1,0,0,0,1]\n" + kCameraBeside);
    // without a readable picture, the room cannot be learned from pictures with people either
    file("rec/a/frames/000000.png", "x");
    file("rec/b/frames/000000.png", "x");
    const Outcome outcome = run("site_node --capture.source recording --capture.recording " +
                                (folder_ / "rec").string());
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(
        outcome.output,
        AllOf(HasSubstr("camera 'a'"), HasSubstr("no background"), HasSubstr("background.*")));
}

TEST_F(CommandLine, WindowWithoutDisplayFallsBackAndReportsIt) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    const Outcome outcome =
        run("viewer --frames 1 --bus.domain 179 --output " + (folder_ / "v.png").string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("surface_headless reason=\"window: DISPLAY is not set"));
    EXPECT_THAT(outcome.output, AnyOf(HasSubstr("on=\"OSMesa, "), HasSubstr("on=\"EGL, ")));
    EXPECT_GT(fs::file_size(folder_ / "v.png"), 1000u);
}

TEST_F(CommandLine, VisualHullRefusesBadViews) {
    for (const char* text : {"", "{", "[]", "{\"views\": 3}", "{\"views\": [{\"name\": \"a\"}]}"}) {
        const Outcome outcome = run("visual_hull " + file("views.json", text));
        EXPECT_EQ(outcome.exit_code, 2) << text;
        EXPECT_THAT(outcome.output, HasSubstr("views.json")) << text;
    }
}

TEST_F(CommandLine, VisualHullNamesABadNumber) {
    const Outcome outcome =
        run("visual_hull " +
            file("views.json",
                 R"({"views": [{"name": "a", "width": 64, "height": 48, "fx": 1e300, "fy": 60,
                                         "cx": 31, "cy": 23, "rotation": [1,0,0,0,1,0,0,0,1], "translation": [0,0,3],
                                         "contours": []}]})"));
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.output, AllOf(HasSubstr("views.json"), HasSubstr("fx")));
}

// Three cameras on the axes that see a square, in pictures of that width and height.
std::string cube(int size_px) {
    std::string views;
    int number = 0;
    for (const char* rotation :
         {"0,1,0,0,0,-1,-1,0,0", "-1,0,0,0,0,-1,0,-1,0", "1,0,0,0,-1,0,0,0,-1"}) {
        const std::string size = std::to_string(size_px);
        views += std::string(views.empty() ? "" : ",") + R"({"name": "cam)" +
                 std::to_string(number++) + R"(", "width": )" + size + R"(, "height": )" + size +
                 R"(, "fx": 1600, "fy": 1600, "cx": 320, "cy": 240, "rotation": [)" + rotation +
                 R"(], "translation": [0, 0, 8], "contours": [[[220.3, 140.3], [419.7, 140.4],
                     [419.8, 339.7], [220.2, 339.6]]]})";
    }
    return "{\"views\": [" + views + "]}";
}

TEST_F(CommandLine, VisualHullReportsLackOfMemoryOrThreads) {
    if (atrium::test::kSanitized) GTEST_SKIP() << atrium::test::skip::kSanitizer;
    const std::string limit = "ulimit -v 500000; ";  // [KiB]; the libraries take 300,000
    const Outcome large = run("visual_hull " + file("large.json", cube(8192)), limit);
    EXPECT_EQ(large.exit_code, 1);
    EXPECT_THAT(large.output, AllOf(HasSubstr("large.json"), HasSubstr("not enough memory")));
    const std::string views = file("views.json", cube(640));
    EXPECT_EQ(run("visual_hull " + views, limit).exit_code, 0);
    const Outcome threads = run("visual_hull " + views + " --threads 256", limit);
    EXPECT_EQ(threads.exit_code, 1);
    EXPECT_THAT(threads.output, HasSubstr("--threads: 256 cannot be started"));
}

TEST_F(CommandLine, VisualHullHasAnExitCodeForEachOutcome) {
    const std::string help = run("visual_hull --help").output;
    for (const char* code : {"0 done", "1 no hull", "2 wrong", "3 something is missing"})
        EXPECT_THAT(help, HasSubstr(code));
    const std::string views = file("views.json", cube(640));
    const Outcome done = run("visual_hull " + views + " --min-litres 9000");
    EXPECT_EQ(done.exit_code, 0);
    EXPECT_THAT(done.output,
                AllOf(HasSubstr("empty intersection"), HasSubstr("\"closed\": false")));
    const Outcome bounded =
        run("visual_hull " + views + " --without cam0 --without cam1 " + "--bounds -1,-1,-1,1,1,1");
    EXPECT_EQ(bounded.exit_code, 0);  // one camera and bounds
    const Outcome few = run("visual_hull " + views + " --without cam0 --without cam1");
    EXPECT_EQ(few.exit_code, 2);
    EXPECT_THAT(few.output, HasSubstr("too few views"));
    const Outcome output = run("visual_hull " + views + " -o /nonexistent/hull.ply");
    EXPECT_EQ(output.exit_code, 3);
    EXPECT_THAT(output.output, HasSubstr("/nonexistent/hull.ply"));
}

TEST_F(CommandLine, VisualHullComputesTheBundledPerson) {
    const std::string mesh = (folder_ / "hull.ply").string();
    const Outcome outcome =
        run("visual_hull " + atrium::test::source_dir() + "/deploy/views/person.json -o " + mesh);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output,
                AllOf(HasSubstr("\"status\": \"ok\""),
                      HasSubstr("\"components\": 1,"),
                      HasSubstr("\"manifold\": true")));
    EXPECT_GT(fs::file_size(mesh), 10'000u);
}

TEST_F(CommandLine, VisualHullReportsItsBounds) {
    for (const char* bounds : {"0,0,0,0.005,1,1", "-1,-1,-1,1,1,20000"}) {
        const Outcome outcome = run(std::string("visual_hull views.json --bounds ") + bounds);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(
            outcome.output,
            AllOf(HasSubstr("[-10000, 10000] m"), HasSubstr("at least 0.01 m"), HasSubstr(bounds)));
    }
}

TEST_F(CommandLine, SimulatedCamerasNameBadOptions) {
    const std::string rig = " --rig " + atrium::test::source_dir() + "/deploy/rigs/full_body.toml";
    const Outcome nothing = run("simulated_cameras");
    EXPECT_EQ(nothing.exit_code, 2);
    EXPECT_THAT(nothing.output, AllOf(HasSubstr("rig"), HasSubstr("recording")));
    const Outcome both = run("simulated_cameras --recording /nonexistent" + rig);
    EXPECT_EQ(both.exit_code, 2);
    EXPECT_THAT(both.output, HasSubstr("only one may be set"));
    const Outcome no_camera = run("simulated_cameras --lose cam9=1" + rig);
    EXPECT_EQ(no_camera.exit_code, 2);
    EXPECT_THAT(no_camera.output, AllOf(HasSubstr("lose"), HasSubstr("'cam9'")));
    const Outcome no_model =
        run("simulated_cameras --simulation.model /nonexistent/m.gltf" + rig + " -- true");
    EXPECT_EQ(no_model.exit_code, 3);
    const Outcome list = run("simulated_cameras --list --log-level error" + rig);
    EXPECT_EQ(list.exit_code, 0);
    EXPECT_THAT(list.output, AllOf(HasSubstr("cam7"), HasSubstr("127.0.0.9")));
}

TEST_F(CommandLine, SimulatedCamerasReturnTheExitCodeOfTheirCommand) {
    const std::string head = "[[camera]]\nrotation = [1,0,0,0,1,0,0,0,1]\n" + kCamera;
    const std::string small = file("rig.toml", head + "name = \"a\"\n" + head + "name = \"b\"\n");
    const std::string cameras =
        "simulated_cameras --simulation.loop_s 0.1 --simulation.cache '' --rig " + small + " -- ";
    const Outcome seven = run(cameras + "sh -c 'cat /proc/net/dev; exit 7'");
    if (seven.output.find("a network namespace cannot be made") != std::string::npos)
        GTEST_SKIP() << atrium::test::skip::kNoNetwork << seven.output;
    EXPECT_EQ(seven.exit_code, 7) << seven.output;
    EXPECT_THAT(seven.output, AllOf(HasSubstr(" lo:"), Not(HasSubstr("eth"))));
    EXPECT_THAT(seven.output, HasSubstr("start world_server and viewer inside, too"));
    const Outcome none = run(cameras + "/nonexistent/program");
    EXPECT_EQ(none.exit_code, 3);
    EXPECT_THAT(none.output, HasSubstr("/nonexistent/program"));
}

TEST_F(CommandLine, DemoRefusesZeroPeopleAndABadFolder) {
    const Outcome no_sites = run("demo --sites ''");
    EXPECT_EQ(no_sites.exit_code, 2);
    EXPECT_THAT(no_sites.output, HasSubstr("sites"));
    const Outcome no_folder =
        run("demo --output /proc/x --deploy " + atrium::test::source_dir() + "/deploy --world " +
            atrium::test::source_dir() + "/deploy/worlds/demo.toml --viewer " +
            atrium::test::source_dir() + "/deploy/viewer.toml");
    EXPECT_EQ(no_folder.exit_code, 3);
    EXPECT_THAT(no_folder.output, HasSubstr("/proc/x"));
}

}  // namespace
}  // namespace atrium
