#include "core/gl/offscreen_context.hpp"
#include "tests/support/comes_true.hpp"
#include "viewer/control/user_control.hpp"
#include "viewer/overlay/annotations.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/record/picture_file.hpp"
#include "viewer/scene/scene_view.hpp"
#include "world_server/world_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

// Viewers without a window edit one world over the real bus and the real world server: pointer and
// keys go in as from a window.
namespace atrium {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using test_support::comes_true;
using testing::Contains;
using testing::HasSubstr;

constexpr int kEditWidth = 640;
constexpr int kEditHeight = 360;
constexpr std::uint32_t kEditFloor = 1;
constexpr std::uint32_t kEditBox = 2;
constexpr std::uint32_t kEditShelf = 3;

bus::BusOptions edit_bus() {
    bus::BusOptions options;
    options.world = "world-editing-test-" + std::to_string(getpid());
    options.domain = 185;  // used by this test only
    return options;
}

renderer::ViewCamera edit_camera() {
    return {.position_m = {1.6, -2.2, 1.5}, .target_m = {0.0, 0.0, 0.35}, .fov_deg = 45.0};
}

/// A viewer without a window, stepped by the test.
class Editor {
public:
    explicit Editor(const std::string& name, const bus::BusOptions& bus = edit_bus())
        : session_(viewer::Session::create(bus, name).value()),
          thread_([this](const std::stop_token& stop) { session_->receive(stop); }),
          context_(gl::OffscreenContext::create(16, 16).value()),
          control_(edit_camera(), name, false) {
        renderer_.emplace(
            renderer::SceneRenderer::create({.width = kEditWidth, .height = kEditHeight}).value());
        annotations_.emplace(viewer::ViewConfig{}, false);
        pointer_.width_px = kEditWidth;
        pointer_.height_px = kEditHeight;
    }

    /// One picture, as Viewer draws it.
    void step(viewer::SurfaceEvents events = {}) {
        const auto now = Clock::now();
        scene_.update(session_->take_scene(), now, std::nullopt, *renderer_);
        for (const std::string& text : control_.take(session_->edits().take(), now))
            texts_.push_back(text);
        const viewer::UserControl::Shown shown = this->shown();
        for (const auto& command : control_.move(events, shown, now))
            EXPECT_TRUE(session_->send(command));
        for (const auto& command : control_.edit(events, shown, shown.eye, now))
            EXPECT_TRUE(session_->send(command));
        for (const bus::SceneEdit& edit : control_.take_edits())
            EXPECT_TRUE(session_->edits().send(edit));
    }
    bool until(const std::function<bool()>& condition) {
        return comes_true([&] {
            step();
            return condition();
        });
    }
    bool has_said(const std::string& text) {
        return until([&] {
            return std::any_of(texts_.begin(), texts_.end(), [&](const std::string& said) {
                return said.find(text) != std::string::npos;
            });
        });
    }

    viewer::UserControl::Shown shown() {
        renderer::EyeView eye = renderer::eye_of(control_.camera(), kEditWidth, kEditHeight);
        using Pickable = viewer::SceneView::Pickable;
        return {
            pointer_,
            [this](const viewer::Ray& ray) { return scene_.pick(ray); },
            {},
            scene_.objects(),
            [this](const viewer::Ray& ray) { return scene_.pick(ray, Pickable::kAllButPlanes); },
            scene_.states(),
            eye};
    }
    viewer::EditView edit() { return control_.edit_view(shown()); }
    void point_at(const Eigen::Vector3d& p_world) {
        pointer_.at_px = *viewer::pixel_of(p_world, shown().eye);
    }
    void hold_button(bool is_down) { pointer_.is_down = is_down; }
    void click(const Eigen::Vector3d& p_world) {
        point_at(p_world);
        for (const bool is_down : {false, true, false}) {
            hold_button(is_down);
            step();
        }
    }
    /// Drags from one place in the world to another in the picture, in steps.
    void drag(const Eigen::Vector3d& from, const Eigen::Vector3d& to, bool snaps = false) {
        point_at(from);
        step();
        hold_button(true);
        step();
        for (int i = 1; i <= 10; ++i) {
            point_at(from + 0.1 * i * (to - from));
            viewer::SurfaceEvents events;
            events.edit.snaps = snaps;
            step(events);
            std::this_thread::sleep_for(std::chrono::milliseconds(16));  // the period of a mouse
        }
    }
    /// Place of the tip of an arrow of the selected object.
    Eigen::Vector3d arrow(viewer::Handle handle) {
        const viewer::EditHandles handles = edit().handles;
        return handles.world_from_object.translation +
               0.8 * handles.metres(viewer::EditHandles::kLength, shown().eye) *
                   handles.axis(handle);
    }
    Eigen::Vector3d place_of(std::uint32_t object) const {
        for (const bus::ObjectState& state : scene_.states())
            if (state.object == object) return state.world_from_object.translation;
        return Eigen::Vector3d::Constant(1e9);
    }
    const std::map<std::uint32_t, bus::SceneObject>& objects() const { return scene_.objects(); }
    void ask(const std::function<void(viewer::EditEvents&)>& set) {
        viewer::SurfaceEvents events;
        set(events.edit);
        step(events);
    }
    /// Draws; writes the picture if ATRIUM_EDITING_SHOTS names a folder.
    renderer::RenderedPicture draw(const std::string& name) {
        annotations_->set_edit(edit());
        const std::vector<renderer::EyeView> eyes{
            renderer::eye_of(control_.camera(), kEditWidth, kEditHeight)};
        annotations_->update(scene_, people_, {}, eyes, Clock::now(), *renderer_);
        renderer_->draw(eyes);
        renderer::RenderedPicture picture;
        renderer_->read_pixels(picture);
        if (const char* folder = std::getenv("ATRIUM_EDITING_SHOTS")) {
            EXPECT_TRUE(viewer::write_png(fs::path(folder) / (name + ".png"), picture));
        }
        return picture;
    }
    std::vector<std::string>& texts() { return texts_; }

private:
    std::unique_ptr<viewer::Session> session_;
    std::jthread thread_;
    gl::OffscreenContext context_;
    std::optional<renderer::SceneRenderer> renderer_;
    std::optional<viewer::Annotations> annotations_;
    viewer::PeopleView people_;
    viewer::SceneView scene_{ATRIUM_SOURCE_DIR "/deploy/worlds"};
    viewer::UserControl control_;
    viewer::Pointer pointer_;
    std::vector<std::string> texts_;
};

class WorldEditing : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("atrium-editing-" + std::to_string(getpid()));
        fs::remove_all(folder_);
        config_.bus = edit_bus();
        config_.saved_folder = folder_ / "saved";
        config_.models_folder = ATRIUM_SOURCE_DIR "/deploy/worlds";
        config_.rights.save = {.everyone = true, .names = {}};
        config_.rights.edit = {.everyone = false, .names = {"alice", "bob"}};
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
}  // namespace atrium
