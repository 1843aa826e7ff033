#include "core/model/model_file.hpp"
#include "tests/integration/editing_viewer.hpp"
#include "tests/support/source_dir.hpp"
#include "world_server/world_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <thread>

// Viewers without a window edit one world over the real bus and the real world server: pointer and
// keys go in as from a window.
namespace atrium::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::uint32_t kEditFloor = 1;
constexpr std::uint32_t kEditBox = 2;
constexpr std::uint32_t kEditShelf = 3;

class WorldEditing : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("atrium-editing-" + std::to_string(getpid()));
        fs::remove_all(folder_);
        config_.bus = edit_bus();
        config_.saved_folder = folder_ / "saved";
        config_.models_folder = atrium::test::source_dir() + "/deploy/worlds";
        config_.rights.save = {.everyone = true, .names = {}};
        config_.rights.edit = {.everyone = false, .names = {"alice", "bob"}};
        config_.rights.grab = config_.rights.reset = config_.rights.edit;
        world_server::WorldObject floor;
        floor.rigid.id = kEditFloor;
        floor.name = "floor";
        floor.rigid.shape = physics::ObjectShape::kPlane;
        floor.rigid.size_m = {6, 6, 1};
        world_server::WorldObject box;
        box.rigid.id = kEditBox;
        box.name = "box";
        box.rigid.size_m.setConstant(0.3);
        box.rigid.mass_kg = 2.0;
        box.rigid.world_from_object.translation = {0.0, 0.0, 0.15};
        world_server::WorldObject shelf;
        shelf.rigid.id = kEditShelf;
        shelf.name = "shelf";
        shelf.rigid.size_m = {0.6, 0.3, 0.05};
        shelf.rigid.world_from_object.translation = {-0.9, 0.4, 0.6};
        shelf.look.colour = {0.4, 0.25, 0.12};
        config_.objects = {floor, box, shelf};
        start_server();
    }
    void TearDown() override {
        stop_server();
        fs::remove_all(folder_);
    }
    void start_server() {
        auto server = world_server::WorldServer::create(config_);
        ASSERT_TRUE(server) << server.error().message;
        server_ = std::move(*server);
        server_thread_ =
            std::jthread([this](const std::stop_token& stop) { EXPECT_TRUE(server_->run(stop)); });
    }
    void stop_server() {
        server_thread_ = {};
        server_.reset();
    }
    static bool is_ready(Editor& editor) {
        return editor.until([&] {
            return editor.edit().is_supported && editor.objects().size() == 3 &&
                   editor.place_of(kEditBox).norm() < 10.0;
        });
    }

    fs::path folder_;
    world_server::WorldServerConfig config_;
    std::unique_ptr<world_server::WorldServer> server_;
    std::jthread server_thread_;
};

TEST_F(WorldEditing, ArrowMovesTheSelectedObjectForAllAndUndoPutsItBack) {
    Editor alice("alice");
    Editor bob("bob");
    ASSERT_TRUE(is_ready(alice) && is_ready(bob));
    alice.draw("1_nothing_selected");
    alice.click({0.0, 0.0, 0.15});
    ASSERT_TRUE(alice.edit().selected);
    EXPECT_EQ(alice.edit().selected->object, kEditBox);
    alice.draw("2_selected");
    const Eigen::Vector3d before = alice.place_of(kEditBox);
    const Eigen::Vector3d grip = alice.arrow(0);
    alice.drag(grip, grip + Eigen::Vector3d(0.5, 0, 0), /*snaps=*/true);
    EXPECT_EQ(alice.edit().readout, "x +0.500 m");
    // held over there, before the button is let go, and seen by another viewer
    EXPECT_TRUE(alice.until([&] { return (alice.place_of(kEditBox).x() - 0.5) > -0.01; }));
    EXPECT_TRUE(bob.until([&] { return bob.place_of(kEditBox).x() > 0.49; }));
    alice.draw("3_moving");
    alice.hold_button(false);
    EXPECT_TRUE(alice.has_said("box was placed"));
    EXPECT_TRUE(bob.until([&] {
        return bob.objects().at(kEditBox).world_from_object.translation.x() > 0.49;
    })) << "the start must move too";
    alice.ask([](auto& edit) { edit.undo = true; });
    EXPECT_TRUE(alice.has_said("undone: placed box"));
    EXPECT_TRUE(bob.until([&] { return (bob.place_of(kEditBox) - before).norm() < 0.005; }));
    alice.ask([](auto& edit) { edit.redo = true; });
    EXPECT_TRUE(bob.until([&] { return bob.place_of(kEditBox).x() > 0.49; }));
}

TEST_F(WorldEditing, NumbersOfThePanelHoldThenPlaceAndUndoPutsItBack) {
    Editor alice("alice");
    Editor bob("bob");
    ASSERT_TRUE(is_ready(alice) && is_ready(bob));
    const auto ask = [&](double x_m, bool is_held) {
        viewer::PlaceWanted wanted{kEditBox, {}, is_held};
        wanted.world_from_object.translation = {x_m, 0.0, 1.0};
        alice.ask([&](auto& edit) { edit.place = wanted; });
    };
    ASSERT_TRUE(bob.until([&] {
        ask(0.5, true);
        return (bob.place_of(kEditBox) - Eigen::Vector3d(0.5, 0.0, 1.0)).norm() < 1e-3;
    })) << "held in the air, before the field is let go";
    ask(0.7, false);
    EXPECT_TRUE(alice.has_said("box was placed"));
    EXPECT_TRUE(bob.until([&] {
        return bob.objects().at(kEditBox).world_from_object.translation ==
               Eigen::Vector3d(0.7, 0.0, 1.0);
    })) << "the start must move too";
    EXPECT_TRUE(bob.until([&] { return bob.place_of(kEditBox).z() < 0.2; })) << "it falls again";
    alice.ask([](auto& edit) { edit.undo = true; });
    EXPECT_TRUE(alice.has_said("undone: placed box"));
    EXPECT_TRUE(bob.until([&] { return std::abs(bob.place_of(kEditBox).x()) < 0.005; }));
}

TEST_F(WorldEditing, AFieldThatIsLostLetsTheObjectGo) {
    Editor alice("alice");
    ASSERT_TRUE(is_ready(alice));
    ASSERT_TRUE(alice.until([&] {
        alice.ask([](auto& edit) {
            edit.place = viewer::PlaceWanted{kEditBox, {}, true};
            edit.place->world_from_object.translation = {0.0, 0.0, 1.0};
        });
        return alice.place_of(kEditBox).z() > 0.99;
    }));
    EXPECT_TRUE(alice.until([&] { return alice.place_of(kEditBox).z() < 0.2; }));
}

TEST_F(WorldEditing, RingsRotateAFixedObjectAndALostViewerLetsGo) {
    std::optional<Editor> alice(std::in_place, "alice");
    Editor bob("bob");
    ASSERT_TRUE(is_ready(*alice) && is_ready(bob));
    alice->click({-0.9, 0.4, 0.6});
    ASSERT_TRUE(alice->edit().selected);
    EXPECT_EQ(alice->edit().selected->object, kEditShelf);
    alice->ask([](auto& edit) { edit.next_handles = true; });
    alice->draw("4_rings");
    const viewer::EditHandles rings = alice->edit().handles;
    const double radius_m = rings.metres(viewer::EditHandles::kRadius, alice->shown().eye);
    alice->drag(rings.ring_point(2, -0.7, radius_m), rings.ring_point(2, 0.3, radius_m));
    EXPECT_TRUE(alice->edit().is_dragging);
    alice->draw("5_turning");
    EXPECT_THAT(alice->edit().readout, HasSubstr("z +"));
    // bob cannot take what alice holds
    bob.click({-0.9, 0.4, 0.6});
    const Eigen::Vector3d grip = bob.arrow(1);
    bob.drag(grip, grip + Eigen::Vector3d(0, 0.2, 0));
    EXPECT_TRUE(bob.has_said("shelf is held by alice"));
    bob.hold_button(false);
    bob.texts().clear();
    alice.reset();
    // once alice is gone, the shelf is free
    EXPECT_TRUE(bob.until([&] {
        bob.hold_button(false);
        bob.step();
        bob.ask([&](auto& edit) {
            edit.change = bob.objects().at(kEditShelf);
            edit.change->friction = 0.9;
        });
        return bob.objects().at(kEditShelf).friction == 0.9;
    }));
}

TEST_F(WorldEditing, ChangesReachLateJoinersAndUndoRespectsOthers) {
    Editor alice("alice");
    Editor bob("bob");
    ASSERT_TRUE(is_ready(alice) && is_ready(bob));
    const auto change = [](Editor& editor, auto&& set) {
        editor.ask([&](auto& edit) {
            edit.change = editor.objects().at(kEditBox);
            set(*edit.change);
        });
    };
    change(alice, [](bus::SceneObject& box) {
        box.name = "crate";
        box.mass_kg = 5.0;
        box.colour = {0.1, 0.6, 0.9};
        box.size_m = {0.4, 0.2, 0.3};
    });
    ASSERT_TRUE(alice.has_said("crate was changed"));
    Editor carol("carol");
    EXPECT_TRUE(carol.until([&] {
        const auto box = carol.objects().find(kEditBox);
        return box != carol.objects().end() && box->second.name == "crate";
    }));
    const bus::SceneObject& seen = carol.objects().at(kEditBox);
    EXPECT_EQ(seen.mass_kg, 5.0);
    EXPECT_EQ(seen.size_m, Eigen::Vector3d(0.4, 0.2, 0.3));
    // carol has no right
    change(carol, [](bus::SceneObject& box) { box.mass_kg = 1.0; });
    EXPECT_TRUE(carol.has_said("not allowed to carol by [rights] edit"));
    // bob makes it fixed; alice's undo must not overwrite that
    ASSERT_TRUE(bob.until([&] { return bob.objects().at(kEditBox).name == "crate"; }));
    change(bob, [](bus::SceneObject& box) { box.mass_kg = 0.0; });
    ASSERT_TRUE(bob.has_said("crate was changed"));
    alice.ask([](auto& edit) { edit.undo = true; });
    EXPECT_TRUE(alice.has_said("not undone: changed box: crate was changed by bob meanwhile"));
    bob.ask([](auto& edit) { edit.undo = true; });
    EXPECT_TRUE(bob.until([&] { return bob.objects().at(kEditBox).mass_kg == 5.0; }));
    change(alice, [](bus::SceneObject& box) { box.mass_kg = 1e5; });
    EXPECT_TRUE(alice.has_said("mass_kg"));
}

TEST_F(WorldEditing, AnswersAPullAndAResetThatAreNotAllowed) {
    Editor alice("alice");
    Editor carol("carol");
    ASSERT_TRUE(is_ready(alice) && is_ready(carol));
    carol.drag({0.0, 0.0, 0.15}, {0.3, 0.0, 0.4});
    EXPECT_TRUE(
        carol.has_said("not pulled: not allowed to carol by [rights] grab of the world file"));
    carol.hold_button(false);
    viewer::SurfaceEvents reset;
    reset.reset_scene = true;
    carol.step(reset);
    EXPECT_TRUE(
        carol.has_said("not reset: not allowed to carol by [rights] reset of the world file"));
    EXPECT_EQ(carol.texts().size(), 2U) << "one answer for all the moves of a pull";
    alice.step(reset);
    EXPECT_TRUE(alice.has_said("all objects were reset"));
    EXPECT_EQ(carol.texts().size(), 2U) << "answers go to their sender only";
}

TEST_F(WorldEditing, EscapeEndsADragWithoutATraceAndEarlierEditsCanStillBeUndone) {
    Editor alice("alice");
    ASSERT_TRUE(is_ready(alice));
    alice.ask([&](auto& edit) {
        edit.change = alice.objects().at(kEditBox);
        edit.change->mass_kg = 4.0;
    });
    ASSERT_TRUE(alice.has_said("box was changed"));
    alice.click({0.0, 0.0, 0.15});
    const Eigen::Vector3d before = alice.place_of(kEditBox);
    const Eigen::Vector3d grip = alice.arrow(2);
    alice.drag(grip, grip + Eigen::Vector3d(0, 0, 0.4));
    ASSERT_TRUE(alice.until([&] { return alice.place_of(kEditBox).z() > 0.4; }));
    alice.ask([](auto& edit) { edit.cancel = true; });
    EXPECT_FALSE(alice.edit().is_dragging);
    ASSERT_TRUE(alice.until([&] { return (alice.place_of(kEditBox) - before).norm() < 0.005; }));
    alice.hold_button(false);
    alice.step();
    EXPECT_TRUE(alice.edit().selected) << "Escape ended only the drag";
    alice.ask([](auto& edit) { edit.undo = true; });
    EXPECT_TRUE(alice.until([&] { return alice.objects().at(kEditBox).mass_kg == 2.0; }));
    // out of the world: refused, and the drag is over
    const Eigen::Vector3d far = alice.arrow(0);
    alice.drag(far, far - Eigen::Vector3d(30, 0, 0));
    EXPECT_TRUE(alice.has_said("the place is outside the world"));
    EXPECT_FALSE(alice.edit().is_dragging);
    alice.hold_button(false);
}

TEST_F(WorldEditing, DuplicatesStandBesideTheirOriginalAndUndoRemovesThem) {
    Editor alice("alice");
    ASSERT_TRUE(is_ready(alice));
    for (const auto& [original, name] :
         {std::pair(kEditBox, "box_2"), std::pair(kEditShelf, "shelf_2")}) {
        alice.ask([&, id = original](auto& edit) { edit.select = id; });
        alice.ask([](auto& edit) { edit.duplicate = true; });
        ASSERT_TRUE(alice.has_said(std::string(name) + " was added"));
        ASSERT_TRUE(alice.until([&, id = original] {
            const auto edit = alice.edit();
            return edit.selected && edit.selected->object != id;
        }));
        const bus::SceneObject copy = *alice.edit().selected;
        EXPECT_EQ(copy.name, name);
        EXPECT_EQ(copy.mass_kg, alice.objects().at(original).mass_kg);
        EXPECT_EQ(copy.size_m, alice.objects().at(original).size_m);
        EXPECT_EQ(copy.colour, alice.objects().at(original).colour);
        EXPECT_NEAR(alice.place_of(original).z(), copy.world_from_object.translation.z(), 0.01);
        alice.draw(name);
    }
    EXPECT_LT(alice.place_of(kEditBox).norm(), 0.2) << "nothing pushed it";
    for (int i = 0; i < 2; ++i) alice.ask([](auto& edit) { edit.undo = true; });
    EXPECT_TRUE(alice.until([&] { return alice.objects().size() == 3; }));
}

TEST_F(WorldEditing, RemovedObjectsComeBackUnderTheirNumber) {
    Editor alice("alice");
    ASSERT_TRUE(is_ready(alice));
    viewer::SurfaceEvents remove;
    remove.remove = kEditBox;
    alice.step(remove);
    EXPECT_TRUE(alice.until([&] { return !alice.objects().contains(kEditBox); }));
    alice.ask([](auto& edit) { edit.undo = true; });
    EXPECT_TRUE(alice.until([&] { return alice.objects().contains(kEditBox); }));
    EXPECT_EQ(alice.objects().at(kEditBox).mass_kg, 2.0);
    alice.ask([](auto& edit) { edit.redo = true; });
    EXPECT_TRUE(alice.until([&] { return !alice.objects().contains(kEditBox); }));
}

TEST_F(WorldEditing, AddsModelsOfTheServersFolderOnly) {
    Editor alice("alice");
    ASSERT_TRUE(is_ready(alice));
    viewer::NewModel chair;
    chair.file = "models/chair.obj";
    chair.is_compound = true;
    chair.mass_kg = 4.0;
    chair.size_m = {0.5, 0.5, 0.9};
    alice.ask([&](auto& edit) { edit.add_model = chair; });
    EXPECT_TRUE(alice.has_said("chair was added"));
    ASSERT_TRUE(alice.until([&] { return alice.edit().selected.has_value(); }))
        << "an added object is selected";
    EXPECT_EQ(alice.edit().selected->name, "chair");
    FilesRead files;
    ASSERT_TRUE(model::load_model(config_.models_folder / chair.file, 1.0, {}, &files));
    EXPECT_EQ(alice.objects().at(alice.edit().selected->object).model_fingerprint,
              files.fingerprint);
    alice.until([&] { return alice.place_of(alice.edit().selected->object).z() < 0.5; });
    alice.draw("6_model");
    chair.file = "models/nowhere.obj";
    alice.ask([&](auto& edit) { edit.add_model = chair; });
    EXPECT_TRUE(alice.has_said("the world server has no model models/nowhere.obj"));
    alice.ask([](auto& edit) { edit.undo = true; });
    EXPECT_TRUE(alice.until([&] { return alice.objects().size() == 3; }));
}

TEST_F(WorldEditing, SavesAndLoadsWorldsAndKeepsThemOverARestart) {
    config_.state_file = folder_ / "state.bin";
    stop_server();
    start_server();
    Editor alice("alice");
    ASSERT_TRUE(is_ready(alice));
    alice.ask([&](auto& edit) {
        edit.change = alice.objects().at(kEditBox);
        edit.change->mass_kg = 7.5;
    });
    ASSERT_TRUE(alice.has_said("box was changed"));
    alice.ask([](auto& edit) { edit.save_world = "my-room"; });
    EXPECT_TRUE(alice.has_said("world my-room was saved"));
    ASSERT_TRUE(alice.until([&] {
        const auto& worlds = alice.edit().worlds;
        return worlds && worlds->worlds.size() == 1 && worlds->worlds[0].name == "my-room";
    }));
    EXPECT_EQ(alice.edit().worlds->worlds[0].num_objects, 3U);
    viewer::SurfaceEvents remove;
    remove.remove = kEditBox;
    alice.step(remove);
    ASSERT_TRUE(alice.until([&] { return !alice.objects().contains(kEditBox); }));
    alice.ask([](auto& edit) { edit.load_world = "my-room"; });
    EXPECT_TRUE(alice.until([&] { return alice.objects().contains(kEditBox); }));
    EXPECT_EQ(alice.objects().at(kEditBox).mass_kg, 7.5);
    alice.ask([](auto& edit) { edit.load_world = "not-there"; });
    EXPECT_TRUE(alice.has_said("there is no saved world 'not-there'"));
    // an edit after loading, then a restart from the state file
    alice.ask([&](auto& edit) {
        edit.change = alice.objects().at(kEditBox);
        edit.change->name = "kept";
    });
    ASSERT_TRUE(alice.has_said("kept was changed"));
    stop_server();
    ASSERT_TRUE(alice.until([&] { return alice.objects().empty(); }));
    start_server();
    EXPECT_TRUE(alice.until([&] {
        const auto box = alice.objects().find(kEditBox);
        return box != alice.objects().end() && box->second.name == "kept";
    }));
    EXPECT_EQ(alice.objects().at(kEditBox).mass_kg, 7.5);
}

}  // namespace
}  // namespace atrium::test
