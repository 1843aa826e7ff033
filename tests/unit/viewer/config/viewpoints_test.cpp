#include "viewer/config/viewpoints.hpp"

#include "viewer/config/user_files.hpp"
#include "viewer/control/viewpoint_control.hpp"
#include "viewer/start/recent_worlds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;
using renderer::ViewCamera;
using testing::HasSubstr;

class UserFiles : public testing::Test {
protected:
    void TearDown() override { fs::remove_all(folder_); }
    void write(const std::string& text) const {
        fs::create_directories(file_.parent_path());
        std::ofstream(file_) << text;
    }
    static std::string read(const fs::path& file) {
        std::ostringstream text;
        text << std::ifstream(file).rdbuf();
        return text.str();
    }
    ViewpointBook book(const std::string& world = "lab") const { return {given_, file_, world}; }

    const fs::path folder_ =
        fs::temp_directory_path() / ("atrium_user_files_" + std::to_string(getpid()));
    const fs::path file_ = folder_ / "state" / "file.toml";
    const ViewCamera view_{.position_m = {1.25, -2.5, 1.5}, .target_m = {0, 0.5, 1}, .fov_deg = 40};
    std::vector<Viewpoint> given_;
};

void expect_near(const ViewCamera& a, const ViewCamera& b) {
    EXPECT_LT((a.position_m - b.position_m).norm(), 1e-3);
    EXPECT_LT((a.target_m - b.target_m).norm(), 1e-3);
    EXPECT_NEAR(a.fov_deg, b.fov_deg, 0.01);
}

TEST_F(UserFiles, KeepViewpointsOfEachWorld) {
    {
        ViewpointBook lab = book();
        EXPECT_FALSE(lab.at(3));
        EXPECT_TRUE(lab.keep(3, {"the \"door\" \\ \x01", view_}));
        EXPECT_TRUE(book("garden").keep(1, {"", view_}));
    }
    const ViewpointBook lab = book();
    ASSERT_TRUE(lab.at(3));
    EXPECT_EQ(lab.at(3)->name, "the \"door\" \\ ?");
    expect_near(lab.at(3)->camera, view_);
    EXPECT_FALSE(lab.at(1));
    EXPECT_EQ(book("garden").at(1)->name, "view 1");
}

TEST_F(UserFiles, KeepNamesInAnyLanguage) {
    const std::string name = "Tür für Jörg, 5 €";
    std::string longer(62, 'x');
    longer += "ü";  // its second byte is the 64th
    {
        ViewpointBook lab = book();
        EXPECT_TRUE(lab.keep(1, {name, view_}));
        EXPECT_TRUE(lab.keep(2, {longer, view_}));
    }
    const ViewpointBook lab = book();
    EXPECT_EQ(lab.at(1)->name, name);
    EXPECT_EQ(lab.at(2)->name, std::string(62, 'x')) << "never half a character";
}

TEST_F(UserFiles, OwnViewpointsReplaceThoseOfTheViewerFile) {
    given_ = {{"front", view_}, {"side", view_}};
    ViewpointBook lab = book();
    EXPECT_EQ(lab.at(2)->name, "side");
    EXPECT_FALSE(lab.is_own(2));
    ViewCamera other = view_;
    other.fov_deg = 70.0;
    EXPECT_TRUE(lab.keep(2, {"", other}));
    EXPECT_EQ(lab.at(2)->name, "side") << "without a new name it keeps the old one";
    EXPECT_EQ(book().at(2)->camera.fov_deg, 70.0);
    EXPECT_TRUE(lab.forget(2));
    EXPECT_EQ(book().at(2)->camera.fov_deg, 40.0) << "that of the file shows again";
}

TEST_F(UserFiles, StepThroughTheViewpointsRoundTheEnd) {
    ViewpointBook lab = book();
    EXPECT_EQ(lab.next(0, 1), 0);
    for (const int number : {2, 5, 9}) EXPECT_TRUE(lab.keep(number, {"", view_}));
    EXPECT_EQ(lab.next(0, 1), 2);
    EXPECT_EQ(lab.next(2, 1), 5);
    EXPECT_EQ(lab.next(9, 1), 2);
    EXPECT_EQ(lab.next(0, -1), 9);
    EXPECT_EQ(lab.next(2, -1), 9);
}

TEST_F(UserFiles, SurviveDamageAndKeepTheDamagedFile) {
    const std::string good =
        "[[viewpoint]]\nworld = \"lab\"\nnumber = 1\nname = \"a\"\nposition_m = [1, 2, 3]\n"
        "target_m = [0, 0, 1]\n";
    for (const std::string& text :
         {std::string("[[viewpoint"),
          std::string("\0\xff\x80[[", 5),
          good + "number = 1\n",
          good + "[[viewpoint]]\nworld = \"lab\"\nnumber = 10\nname = \"b\"\n",
          std::string("[[viewpoint]]\nworld = \"lab\"\nnumber = 1\nname = \"a\"\n"
                      "position_m = [0, 0, 1]\ntarget_m = [0, 0, 1]\n"),
          std::string("viewpoint = 3\n")}) {
        write(text);
        testing::internal::CaptureStderr();
        ViewpointBook lab = book();
        const std::string log = testing::internal::GetCapturedStderr();
        EXPECT_FALSE(lab.at(1)) << text;
        EXPECT_THAT(log, HasSubstr("viewpoints_unreadable")) << text;
        EXPECT_TRUE(lab.keep(2, {"new", view_})) << text;
        EXPECT_EQ(book().at(2)->name, "new") << text;
        EXPECT_EQ(read(file_.string() + ".damaged"), text) << "the user's file must not be lost";
    }
    write(good);
    EXPECT_EQ(book().at(1)->name, "a");
}

// every cut of a file is either read or reported; none ends the viewer
TEST_F(UserFiles, AcceptEveryTruncation) {
    ViewpointBook lab = book();
    ASSERT_TRUE(lab.keep(1, {"one", view_}));
    ASSERT_TRUE(lab.keep(9, {"nine", view_}));
    const std::string whole = read(file_);
    for (std::size_t length = 0; length < whole.size(); length += 3) {
        write(whole.substr(0, length));
        const ViewpointBook cut = book();
        EXPECT_FALSE(cut.at(9) && !cut.at(1)) << length;
    }
}

TEST_F(UserFiles, SayWhyTheyCannotBeWritten) {
    fs::create_directories(folder_);
    std::ofstream(file_.parent_path()) << "a file in the place of the folder";
    ViewpointBook lab = book();
    const auto kept = lab.keep(1, {"", view_});
    ASSERT_FALSE(kept);
    EXPECT_THAT(kept.error().message, HasSubstr(file_.string()));
    EXPECT_TRUE(lab.at(1)) << "it lasts until the end";
}

TEST_F(UserFiles, ViewpointsComeFromTheViewerFileToo) {
    const auto read_file = [](const std::string& text) {
        auto reader = config::TableReader::parse(text, "viewer.toml");
        std::vector<Viewpoint> viewpoints;
        read_viewpoints(*reader, viewpoints);
        const auto finished = reader->finish();
        return std::pair(viewpoints, finished ? "" : finished.error().message);
    };
    const auto [viewpoints, no_error] = read_file(
        "[[viewpoint]]\nname = \"door\"\nposition_m = [1, 2, 3]\ntarget_m = [0, 0, 1]\nfov_deg = "
        "50\n");
    EXPECT_EQ(no_error, "");
    ASSERT_EQ(viewpoints.size(), 1U);
    EXPECT_EQ(viewpoints[0].name, "door");
    EXPECT_EQ(viewpoints[0].camera.fov_deg, 50.0);
    const std::string error =
        read_file("[[viewpoint]]\nname = \"door\"\nposition_m = [1, 2]\ntarget_m = [0, 0, 1]\n")
            .second;
    EXPECT_THAT(error, HasSubstr("viewer.toml:3"));
    EXPECT_THAT(error, HasSubstr("position_m"));
}

TEST_F(UserFiles, KeysKeepAndRecallViewpoints) {
    using Kind = ViewpointEvent::Kind;
    UserControl control(view_, "viewer", false);
    ViewpointControl viewpoints(book());
    const std::chrono::steady_clock::time_point begin{std::chrono::hours(1)};
    const auto handle = [&](Kind kind, int number) {
        return viewpoints.handle({kind, number, ""}, control, begin);
    };
    EXPECT_THAT(handle(Kind::kGoNext, 1), HasSubstr("no viewpoint yet"));
    EXPECT_THAT(handle(Kind::kGo, 4), HasSubstr("no viewpoint 4"));
    EXPECT_EQ(handle(Kind::kKeep, 4), "viewpoint 4 kept: view 4");
    ViewCamera away = view_;
    away.position_m.x() += 2.0;
    control.fly_to(away, begin);
    const std::map<std::uint32_t, bus::SceneObject> nothing;
    const std::vector<bus::ObjectState> no_states;
    const auto later = begin + ViewFlight::kDuration;
    const auto nobody = [](const Ray&) { return std::nullopt; };
    const UserControl::Shown shown{{}, nobody, {}, nothing, nobody, no_states, {}};
    control.move({}, shown, later);
    EXPECT_EQ(control.camera(), away);
    EXPECT_EQ(viewpoints.handle({Kind::kGoNext, 0, ""}, control, later), "viewpoint 4: view 4");
    control.move({}, shown, later + ViewFlight::kDuration / 2);
    EXPECT_NE(control.camera(), away) << "it flies";
    EXPECT_NE(control.camera(), view_);
    control.move({}, shown, later + ViewFlight::kDuration);
    EXPECT_EQ(control.camera(), view_);
    EXPECT_EQ(viewpoints.handle({Kind::kRename, 4, "door"}, control, later),
              "viewpoint 4 kept: door");
    EXPECT_EQ(book().at(4)->name, "door");
    EXPECT_EQ(handle(Kind::kForget, 4), "viewpoint 4 deleted");
    EXPECT_FALSE(book().at(4));
}

TEST_F(UserFiles, RememberTheLastWorlds) {
    RecentWorlds recent(file_);
    EXPECT_TRUE(recent.list().empty());
    for (int i = 0; i < 12; ++i) {
        bus::BusOptions world;
        world.world = "world-" + std::to_string(i);
        world.domain = static_cast<std::uint32_t>(i);
        world.network = "lan";
        EXPECT_TRUE(recent.add(world));
    }
    bus::BusOptions again;
    again.world = "world-9";
    again.domain = 9;
    again.network = "lan";
    EXPECT_TRUE(recent.add(again));
    const RecentWorlds read_back(file_);
    ASSERT_EQ(read_back.list().size(), RecentWorlds::kMax);
    EXPECT_EQ(read_back.list()[0].world, "world-9");
    EXPECT_EQ(read_back.list()[1].world, "world-11");
    EXPECT_EQ(read_back.list()[1].domain, 11U);
    EXPECT_EQ(read_back.list()[1].network, "lan");
    EXPECT_TRUE(recent.forget(again));
    EXPECT_EQ(RecentWorlds(file_).list()[0].world, "world-11");
    EXPECT_EQ(RecentWorlds(file_).list().size(), RecentWorlds::kMax - 1);
    write("[[world]]\nname = \"no spaces allowed\"\n");
    EXPECT_TRUE(RecentWorlds(file_).list().empty());
    EXPECT_TRUE(fs::exists(file_.string() + ".damaged"));
}

TEST_F(UserFiles, AreInTheStateFolder) {
    const char* state = std::getenv("XDG_STATE_HOME");
    const std::string before = state == nullptr ? "" : state;
    setenv("XDG_STATE_HOME", "/somewhere/state", 1);
    EXPECT_EQ(user_folder(), fs::path("/somewhere/state/atrium"));
    setenv("XDG_STATE_HOME", "relative", 1);
    const char* home = std::getenv("HOME");
    if (home != nullptr) {
        EXPECT_EQ(user_folder(), fs::path(home) / ".local/state/atrium");
    }
    if (state == nullptr)
        unsetenv("XDG_STATE_HOME");
    else
        setenv("XDG_STATE_HOME", before.c_str(), 1);
}

}  // namespace
}  // namespace atrium::viewer
