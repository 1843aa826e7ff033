#include "bench/hull/hull_scenes.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/gl/offscreen_context.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tools/visual_hull/recording_views.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Geometry>
#include <glad/gl.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

// Draws hulls from more and more cameras side by side, with the edges of their faces. `hull_picture
// OUT.png` uses a person of the simulation (docs/figures/hull_meshes.png). `hull_picture OUT.png
// RECORDING` uses a real person, for viewing only: documents must not show recordings of
// ../shared/data.
namespace atrium::bench {
namespace {

constexpr int kPanelWidth = 300;
constexpr int kPanelHeight = 540;
constexpr int kSamples = 3;  // in x and y, per pixel

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_world;
out vec3 world_normal;
void main() {
    world_normal = normal;
    gl_Position = clip_from_world * vec4(position, 1.0);
})";
constexpr const char* kFragmentShader = R"(#version 330 core
in vec3 world_normal;
uniform vec3 towards_light;
uniform vec3 colour;
uniform float is_line;
out vec4 result;
void main() {
    float light = 0.5 + 0.5 * dot(normalize(world_normal), towards_light);
    result = vec4(colour * mix(0.35 + 0.65 * light, 1.0, is_line), 1.0);
})";

[[noreturn]] void fail(const std::string& message) {
    std::fprintf(stderr, "hull_picture: %s\n", message.c_str());
    std::exit(1);
}

struct Panel {
    std::string title;
    geometry::TriangleMesh mesh;
    bool has_edges = true;
};

struct Corner {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;
};

Eigen::Vector3d normal_of(const geometry::TriangleMesh& mesh, std::size_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    return (mesh.vertices[b] - mesh.vertices[a])
        .cross(mesh.vertices[c] - mesh.vertices[a])
        .normalized();
}

// Edges where the surface bends: those of the polyhedron's faces, without the diagonals.
std::vector<Corner> face_edges(const geometry::TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> sides;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        for (const auto& side : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
            sides[side] = t;
    }
    std::vector<Corner> lines;
    for (const auto& [side, t] : sides) {
        if (side.first > side.second) continue;
        const auto twin = sides.find({side.second, side.first});
        if (twin == sides.end()) continue;
        if (normal_of(mesh, t).cross(normal_of(mesh, twin->second)).norm() < 1e-5) continue;
        for (const std::uint32_t v : {side.first, side.second})
            lines.push_back({mesh.vertices[v].cast<float>(), Eigen::Vector3f::UnitZ()});
    }
    return lines;
}

std::vector<Corner> flat_corners(const geometry::TriangleMesh& mesh) {
    std::vector<Corner> corners;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const std::uint32_t v : mesh.triangles[t])
            corners.push_back({mesh.vertices[v].cast<float>(), normal_of(mesh, t).cast<float>()});
    }
    return corners;
}

void draw(const std::vector<Corner>& corners, unsigned kind) {
    const gl::VertexArray array = gl::make_vertex_array();
    glBindVertexArray(array.id());
    const gl::Buffer buffer = gl::make_buffer();
    gl::upload(buffer, GL_ARRAY_BUFFER, std::span(corners), GL_STATIC_DRAW);
    gl::float_attribute(0, 3, sizeof(Corner), 0);
    gl::float_attribute(1, 3, sizeof(Corner), sizeof(Eigen::Vector3f));
    glDrawArrays(kind, 0, static_cast<GLsizei>(corners.size()));
}

void draw_panel(const Panel& panel,
                const renderer::ViewCamera& camera,
                const gl::ShaderProgram& program) {
    const Eigen::Matrix4d clip =
        renderer::clip_from_view(camera, static_cast<double>(kPanelWidth) / kPanelHeight) *
        renderer::view_from_world(camera);
    glClearColor(1.0F, 1.0F, 1.0F, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    program.use();
    program.set("clip_from_world", Eigen::Matrix4f(clip.cast<float>()));
    const Eigen::Vector3d to_camera = (camera.position_m - camera.target_m).normalized();
    const Eigen::Vector3d light = (to_camera + Eigen::Vector3d(-0.6, 0.2, 0.9)).normalized();
    program.set("towards_light", Eigen::Vector3f(light.cast<float>()));
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5F, 4.0F);
    program.set("is_line", 0.0F);
    program.set("colour", Eigen::Vector3f(0.80F, 0.86F, 0.94F));
    draw(flat_corners(panel.mesh), GL_TRIANGLES);
    glDisable(GL_POLYGON_OFFSET_FILL);
    if (!panel.has_edges) return;
    program.set("is_line", 1.0F);
    program.set("colour", Eigen::Vector3f(0.10F, 0.20F, 0.38F));
    glLineWidth(1.0F);
    draw(face_edges(panel.mesh), GL_LINES);
}

cv::Mat render(const std::vector<Panel>& panels, const renderer::ViewCamera& camera) {
    const int width = kSamples * kPanelWidth;
    const int height = kSamples * kPanelHeight;
    auto context = gl::OffscreenContext::create(width, height);
    if (!context) fail(context.error().message);
    const auto program = gl::ShaderProgram::create("hull picture", kVertexShader, kFragmentShader);
    if (!program) fail(program.error().message);
    cv::Mat picture(kPanelHeight, kPanelWidth * static_cast<int>(panels.size()), CV_8UC3);
    cv::Mat large(height, width, CV_8UC4);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        glViewport(0, 0, width, height);
        draw_panel(panels[i], camera, *program);
        gl::read_rgba(
            width, height, std::span(large.data, static_cast<std::size_t>(4 * width * height)));
        cv::Mat small;
        cv::resize(large, small, {kPanelWidth, kPanelHeight}, 0.0, 0.0, cv::INTER_AREA);
        cv::flip(small, small, 0);
        cv::Mat bgr;
        cv::cvtColor(small, bgr, cv::COLOR_RGBA2BGR);
        cv::putText(bgr,
                    panels[i].title,
                    {12, 24},
                    cv::FONT_HERSHEY_SIMPLEX,
                    0.55,
                    {60, 60, 60},
                    1,
                    cv::LINE_AA);
        bgr.copyTo(
            picture(cv::Rect(kPanelWidth * static_cast<int>(i), 0, kPanelWidth, kPanelHeight)));
    }
    return picture;
}

Panel hull_panel(const std::vector<hull::SilhouetteView>& views) {
    hull::HullScratch scratch;
    hull::VisualHull hull = hull::compute_visual_hull(views, {}, scratch);
    if (hull.status != hull::HullStatus::kOk) fail(hull::to_string(hull.status));
    return {std::to_string(views.size()) +
                " cameras: " + std::to_string(hull.mesh.triangles.size()) + " triangles",
            std::move(hull.mesh)};
}

std::vector<Panel> panels_of(const std::vector<hull::SilhouetteView>& all,
                             const std::vector<std::size_t>& counts) {
    std::vector<Panel> panels;
    for (const std::size_t count : counts) {
        if (count > all.size()) continue;
        std::vector<hull::SilhouetteView> views;
        for (std::size_t i = 0; i < count; ++i) views.push_back(all[i * all.size() / count]);
        panels.push_back(hull_panel(views));
    }
    return panels;
}

// The same steps as in a site: pictures, masks, polygons.
std::vector<Panel> simulated_panels() {
    const auto rig = test::make_ring_rig({.num_cameras = 20});
    constexpr double kTime_s = 0.6;
    auto room = simulation::RoomRenderer::create(rig, {});
    if (!room) fail(room.error().message);
    std::vector<hull::SilhouetteView> views;
    silhouette::SilhouetteScratch scratch;
    std::vector<silhouette::SilhouettePolygon> polygons;
    image::YuvImage picture;
    image::Mask mask;
    for (std::size_t i = 0; i < rig.size(); ++i) {
        room->render(kTime_s, i, simulation::Scene::kPerson, 0, picture, &mask);
        silhouette::extract_silhouette(mask, rig[i].intrinsics, {}, scratch, polygons);
        hull::SilhouetteView view{rig[i].intrinsics, rig[i].camera_from_site, {}, {}};
        for (const auto& polygon : polygons) view.contours.push_back(polygon.vertices_px);
        views.push_back(std::move(view));
    }
    std::vector<Panel> panels = panels_of(views, {4, 8, 12, 20});
    panels.push_back({"the person", room->person().mesh(kTime_s), false});
    return panels;
}

std::vector<Panel> recorded_panels(const std::string& folder) {
    const auto named = hull_tool::load_recording_views(folder, 0, {});
    if (!named) fail(named.error().message);
    std::vector<hull::SilhouetteView> views;
    for (const auto& view : *named) views.push_back(view.view);
    return panels_of(views, {4, 8, 12, 20});
}

renderer::ViewCamera look_at(const geometry::TriangleMesh& mesh) {
    const geometry::Aabb box = geometry::bounds(mesh);
    renderer::ViewCamera camera;
    camera.target_m = box.centre();
    camera.fov_deg = 22.0;
    const double distance_m =
        0.58 * box.size().z() / std::tan(0.5 * camera.fov_deg * 3.14159265358979 / 180.0);
    camera.position_m =
        camera.target_m + distance_m * Eigen::Vector3d(0.45, 0.85, 0.18).normalized();
    return camera;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) {
    using namespace atrium::bench;
    if (argc < 2) {
        std::fprintf(stderr, "usage: hull_picture OUT.png [RECORDING]\n");
        return 2;
    }
    const std::vector<Panel> panels = argc > 2 ? recorded_panels(argv[2]) : simulated_panels();
    const cv::Mat picture = render(panels, look_at(panels.back().mesh));
    if (!cv::imwrite(argv[1], picture, {cv::IMWRITE_PNG_COMPRESSION, 9})) fail("cannot write");
    return 0;
}
