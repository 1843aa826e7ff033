#include "tests/golden/golden_scenes.hpp"

#include "tests/unit/renderer/synthetic_person.hpp"
#include "viewer/overlay/debug_view.hpp"
#include "viewer/overlay/name_tags.hpp"
#include "viewer/overlay/shape_wires.hpp"
#include "viewer/overlay/text_picture.hpp"
#include "viewer/ui/display.hpp"

#include <Eigen/Geometry>

#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

namespace atrium::golden {
namespace {

using geometry::RigidTransform;
using renderer::ObjectLook;
using renderer::SceneRenderer;
using renderer::ShapeKind;
using renderer::ViewCamera;
namespace synthetic = renderer::synthetic;

constexpr std::uint32_t kFloor = 100;

RigidTransform placed(const Eigen::Vector3d& at_m,
                      double turn_rad = 0.0,
                      const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ()) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, axis.normalized())), at_m};
}

// Looks different from each side and mirrored: an L of one colour on squares of two others.
renderer::TexturePicture letter(const std::array<std::uint8_t, 3>& light,
                                const std::array<std::uint8_t, 3>& dark,
                                const std::array<std::uint8_t, 3>& stroke) {
    constexpr int kSide = 64;
    renderer::TexturePicture picture{.width = kSide, .height = kSide, .rgba = {}};
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const bool is_in_letter =
                (x >= 12 && x < 24 && y >= 8 && y < 56) || (x >= 12 && x < 48 && y >= 44 && y < 56);
            const auto& colour =
                is_in_letter ? stroke : ((x / 16 + y / 16) % 2 == 0 ? light : dark);
            picture.rgba.insert(picture.rgba.end(), {colour[0], colour[1], colour[2], 255});
        }
    }
    return picture;
}

void put_floor(SceneRenderer& scene) {
    scene.set_texture("floor", letter({196, 186, 170}, {168, 156, 140}, {120, 90, 70}));
    scene.set_object(100,
                     {.shape = ShapeKind::kPlane, .size_m = {6.0, 6.0, 0.0}, .texture = "floor"});
}

void put_shapes(SceneRenderer& scene) {
    put_floor(scene);
    scene.set_texture("letter", letter({240, 230, 90}, {60, 110, 190}, {200, 40, 40}));
    for (const auto& [number, look] : shapes()) scene.set_object(number, look);
    // a pyramid, which no built-in shape has
    auto pyramid = std::make_shared<renderer::ShapeMesh>();
    const Eigen::Vector3f top(0, 0, 0.5F);
    for (int i = 0; i < 4; ++i) {
        const auto corner = [](int k) {
            return Eigen::Vector3f(k % 4 < 2 ? 0.25F : -0.25F, (k + 1) % 4 < 2 ? 0.25F : -0.25F, 0);
        };
        const Eigen::Vector3f from = corner(i + 1), to = corner(i);
        const Eigen::Vector3f normal = (to - from).cross(top - from).normalized();
        for (const Eigen::Vector3f& p : {from, to, top}) {
            pyramid->indices.push_back(static_cast<std::uint32_t>(pyramid->corners.size()));
            pyramid->corners.push_back({p, normal});
        }
    }
    scene.set_scenery("pyramid",
                      std::vector{ObjectLook{.model = pyramid,
                                             .colour = {0.5, 0.25, 0.6},
                                             .world_from_object = placed({-1.0, -0.9, 0.0})}});
}

void put_shapes_on_ground(SceneRenderer& scene) {
    put_shapes(scene);
    scene.remove_object(kFloor);
}

// A person of spheres in a striped shirt, 1.75 m high, seen by six cameras.
void put_person(SceneRenderer& scene, const std::string& site, const RigidTransform& at) {
    std::vector<synthetic::Sphere> body{{{0, 0, 1.6}, 0.15}, {{0, 0, 1.25}, 0.24}};
    body.push_back({{0, 0, 0.92}, 0.2});
    for (const double side : {-1.0, 1.0}) {
        for (const double height_m : {0.74, 0.55, 0.37, 0.22, 0.1})
            body.push_back({{0, 0.12 * side, height_m}, 0.1 + 0.06 * height_m});
        body.push_back({{0.05, 0.33 * side, 1.2}, 0.12});
        body.push_back({{0.16, 0.42 * side, 1.02}, 0.09});
    }
    const auto colour = [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
        if (p.z() > 1.68) return {0.25, 0.15, 0.1};
        if (p.z() > 1.47) return {0.87, 0.66, 0.55};
        if (p.z() < 0.8) return {0.2, 0.25, 0.4};
        return std::sin(50.0 * p.z()) > 0.0 ? Eigen::Vector3d(0.75, 0.2, 0.2)
                                            : Eigen::Vector3d(0.9, 0.88, 0.8);
    };
    std::vector<renderer::CameraPicture> pictures;
    for (const auto& camera : synthetic::ring(6, {0, 0, 1.0}))
        pictures.push_back(synthetic::picture_of(body, camera, colour));
    renderer::PersonModelScratch scratch;
    renderer::PersonModel model;
    build_person_model(synthetic::mesh_of(body, 14), pictures, {}, scratch, model);
    scene.set_person(site, std::move(model));
    scene.set_site_pose(site, at);
}

void put_person_and_box(SceneRenderer& scene) {
    put_floor(scene);
    put_person(scene, "alice", placed({0, 0, 0}, -0.7));
    scene.set_object(1,
                     {.size_m = {0.4, 0.4, 0.4},
                      .colour = {0.1, 0.45, 0.25},
                      .world_from_object = placed({0.9, 0.3, 0.2}, 0.5)});
}

// A cloth that hangs in folds and shows a picture, and a rope that sags between two places.
void put_soft_things(SceneRenderer& scene) {
    constexpr int kColumns = 17, kRows = 11, kLinks = 16;
    put_floor(scene);
    scene.set_texture("letter", letter({240, 230, 90}, {60, 110, 190}, {200, 40, 40}));
    renderer::SoftLook cloth{.num_nodes = kColumns * kRows, .texture = "letter"};
    std::vector<Eigen::Vector3f> nodes;
    for (int r = 0; r < kRows; ++r) {
        for (int c = 0; c < kColumns; ++c) {
            const double u = static_cast<double>(c) / (kColumns - 1);
            const double v = static_cast<double>(r) / (kRows - 1);
            const double fold = 0.12 * (0.3 + v) * std::sin(12.0 * u);
            nodes.push_back(
                Eigen::Vector3d(-1.1 + 1.2 * u, 0.2 + fold, 1.5 - 1.1 * v).cast<float>());
            if (r + 1 == kRows || c + 1 == kColumns) continue;
            const auto at = [&](int row, int column) {
                return static_cast<std::uint16_t>(row * kColumns + column);
            };
            cloth.triangles.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1)});
            cloth.triangles.push_back({at(r, c), at(r + 1, c + 1), at(r, c + 1)});
        }
    }
    cloth.texture_places = make_texture_places(cloth, nodes);
    scene.set_soft_object(1, cloth);
    scene.move_soft_object(1, nodes);
    renderer::SoftLook rope{
        .num_nodes = kLinks + 1, .thickness_m = 0.05, .colour = {0.55, 0.35, 0.1}};
    nodes.clear();
    for (int i = 0; i <= kLinks; ++i) {
        const double u = 2.0 * i / kLinks - 1.0;
        nodes.push_back(Eigen::Vector3d(0.9 + 0.5 * u, -0.3 * u, 0.5 + 0.8 * u * u).cast<float>());
        const auto node = static_cast<std::uint16_t>(i);
        if (i > 0) rope.segments.push_back({static_cast<std::uint16_t>(node - 1), node});
    }
    scene.set_soft_object(2, rope);
    scene.move_soft_object(2, nodes);
}

const ViewCamera kPeopleCamera{
    .position_m = {2.6, -3.6, 1.9}, .target_m = {0.1, 0.1, 0.95}, .fov_deg = 38.0};

// One person who is present, and one who has become silent.
void put_names(SceneRenderer& scene) {
    put_floor(scene);
    put_person(scene, "alice", placed({-0.4, -0.3, 0}, -0.7));
    put_person(scene, "bob", placed({0.8, 1.0, 0}, 2.0));
    scene.set_person_opacity("bob", 0.35);
    viewer::NameTags tags;
    auto labels = tags.update({{"alice", {{-0.4, -0.3, 1.75}}}, {"bob", {{0.8, 1.0, 1.75}, 0.35}}},
                              "",
                              kPeopleCamera.position_m,
                              viewer::NameTags::Clock::time_point(std::chrono::hours(1)));
    // a fraction of the picture's height; text of this size is illegible in 180 px
    for (renderer::Label& label : labels) label.height *= 2.5;
    scene.overlay().set_labels(std::move(labels));
}

// Wires, a box around one object, and a camera with its name.
void put_debug_view(SceneRenderer& scene) {
    put_shapes(scene);
    std::vector<renderer::Line> lines;
    const ObjectLook box = shapes().at(1);
    Eigen::Isometry3d world_from_box = Eigen::Isometry3d::Identity();
    world_from_box.rotate(box.world_from_object.rotation);
    world_from_box.pretranslate(box.world_from_object.translation);
    viewer::append_box(world_from_box.matrix(), 1.2 * box.size_m, {1.0F, 0.8F, 0.1F}, lines);
    const auto camera = synthetic::camera_at({-1.0, 1.0, 1.2}, {0, 0, 0.5});
    viewer::append_frustum(camera, Eigen::Matrix4d::Identity(), 0.35, {0.2F, 0.9F, 0.9F}, lines);
    scene.overlay().set_lines(lines);
    scene.overlay().set_wireframe(true);
    scene.overlay().set_labels(
        {{.picture = viewer::draw_text("cam0"), .at_world = {-1.0, 1.0, 1.25}, .height = 0.09}});
}

}  // namespace

std::map<std::uint32_t, ObjectLook> shapes() {
    std::map<std::uint32_t, ObjectLook> looks;
    looks[1] = {.size_m = {0.5, 0.5, 0.5},
                .texture = "letter",
                .world_from_object = placed({-0.7, 0.4, 0.25}, 0.4)};
    looks[2] = {.shape = ShapeKind::kSphere,
                .size_m = {0.6, 0.6, 0.6},
                .colour = {0.8, 0.15, 0.1},
                .world_from_object = placed({0.0, -0.6, 0.3}, 1.1, {1, 1, 0})};
    looks[3] = {.shape = ShapeKind::kCylinder,
                .size_m = {0.4, 0.4, 0.8},
                .colour = {0.1, 0.5, 0.25},
                .world_from_object = placed({0.3, 0.4, 0.7}, 0.3, {1, 1, 0})};
    looks[4] = {.shape = ShapeKind::kCapsule,
                .size_m = {0.3, 0.3, 0.9},
                .colour = {0.15, 0.3, 0.75},
                .world_from_object = placed({1.2, 0.2, 0.3}, 1.0, {0, 1, 0})};
    looks[5] = {.size_m = {0.3, 0.3, 0.3},
                .colour = {0.8, 0.6, 0.1},
                .world_from_object = placed({1.25, -0.9, 0.4}, 0.9, {1, 2, 3})};
    return looks;
}

ViewCamera shapes_camera() {
    return {.position_m = {2.4, -3.4, 1.9}, .target_m = {0.1, 0.0, 0.35}, .fov_deg = 34.0};
}

std::vector<Scene> all_scenes() {
    const auto seen = [](const ViewCamera& camera, const char* stereo) {
        // without a wall nothing could be missing
        const auto display =
            viewer::Display::create({.stereo = stereo, .eye_distance_m = 0.1, .convergence_m = 0});
        return display->eyes(camera, kWidth, kHeight);
    };
    return {{"shapes", seen(shapes_camera(), "none"), put_shapes},
            {"person", seen(kPeopleCamera, "none"), put_person_and_box},
            {"soft_things", seen(kPeopleCamera, "none"), put_soft_things},
            {"stereo", seen(shapes_camera(), "side_by_side"), put_shapes_on_ground},
            {"names", seen(kPeopleCamera, "none"), put_names},
            {"debug_view", seen(shapes_camera(), "none"), put_debug_view}};
}

Expected<renderer::RenderedPicture> draw(const Scene& scene) {
    auto created = SceneRenderer::create({.width = kWidth, .height = kHeight});
    if (!created) return tl::unexpected(created.error());
    scene.fill(*created);
    created->draw(scene.eyes);
    renderer::RenderedPicture picture;
    created->read_pixels(picture);
    return picture;
}

}  // namespace atrium::golden
