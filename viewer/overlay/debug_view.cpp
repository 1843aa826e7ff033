#include "viewer/overlay/debug_view.hpp"

#include "viewer/overlay/shape_wires.hpp"
#include "viewer/overlay/text_picture.hpp"

#include <Eigen/Geometry>

#include <array>
#include <utility>

namespace atrium::viewer {
namespace {

using renderer::Line;

const Eigen::Vector3f kCameraColour(0.15f, 0.55f, 1.0f);
const Eigen::Vector3f kSpaceColour(0.55f, 0.55f, 0.6f);
const Eigen::Vector3f kPersonColour(1.0f, 0.75f, 0.1f);
const Eigen::Vector3f kObjectColour(0.2f, 0.85f, 0.3f);
const Eigen::Vector3f kVelocityColour(1.0f, 0.15f, 0.1f);
// a velocity line ends where the object will be after this time
constexpr double kVelocityS = 0.25;
constexpr double kSlowestObjectMps = 0.02;  // slower objects get no velocity line
constexpr std::size_t kMaxLines = 200'000;
constexpr double kNameHeight = 0.035;  // share of the picture's height
// bounds the memory: 64 sites with 64 cameras each may appear
constexpr std::size_t kMaxNames = 128;
constexpr int kMaxNewNames = 4;  // per picture

void append_bounds(const std::vector<Eigen::Vector3f>& points,
                   const Eigen::Vector3f& colour,
                   std::vector<Line>& lines) {
    if (points.empty()) return;
    Eigen::Vector3f low = points.front();
    Eigen::Vector3f high = points.front();
    for (const Eigen::Vector3f& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    Eigen::Matrix4d world_from_box = Eigen::Matrix4d::Identity();
    world_from_box.topRightCorner<3, 1>() = (0.5f * (low + high)).cast<double>();
    append_box(world_from_box, (high - low).cast<double>(), colour, lines);
}

void append_objects(const SceneView& scene, const ProxyView& proxies, std::vector<Line>& lines) {
    for (const bus::ObjectState& state : scene.states()) {
        const auto found = scene.objects().find(state.object);
        if (found == scene.objects().end()) continue;
        const bus::SceneObject& object = found->second;
        const Eigen::Matrix4d world_from_object = state.world_from_object.matrix();
        const bool has_room = lines.size() < kMaxLines;  // the network may send any number of edges
        if (!has_room ||
            !proxies.append_edges(state.object, world_from_object, kObjectColour, lines))
            append_shape(object, world_from_object, kObjectColour, lines);
        const Eigen::Vector3d& at = state.world_from_object.translation;
        if (state.linear_velocity.norm() > kSlowestObjectMps)
            append_line(at, at + kVelocityS * state.linear_velocity, kVelocityColour, lines);
    }
    for (const auto& [id, nodes] : scene.nodes()) append_bounds(nodes, kObjectColour, lines);
}

}  // namespace

void append_frustum(const geometry::CalibratedCamera& camera,
                    const Eigen::Matrix4d& world_from_site,
                    double length_m,
                    const Eigen::Vector3f& colour,
                    std::vector<Line>& lines) {
    const geometry::PinholeCamera& lens = camera.intrinsics;
    const Eigen::Matrix4d world_from_camera =
        world_from_site * camera.camera_from_site.inverse().matrix();
    const auto in_world = [&](double x_px, double y_px) -> Eigen::Vector3d {
        const Eigen::Vector3d p_camera = length_m * lens.ray_camera({x_px, y_px});
        return (world_from_camera * p_camera.homogeneous()).head<3>();
    };
    // the picture reaches half a pixel beyond the centres of its outer pixels
    const double right = lens.width - 0.5;
    const double bottom = lens.height - 0.5;
    const std::array<Eigen::Vector3d, 4> corners{in_world(-0.5, -0.5),
                                                 in_world(right, -0.5),
                                                 in_world(right, bottom),
                                                 in_world(-0.5, bottom)};
    const Eigen::Vector3d centre = world_from_camera.topRightCorner<3, 1>();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        append_line(centre, corners[i], colour, lines);
        append_line(corners[i], corners[(i + 1) % corners.size()], colour, lines);
    }
}

void DebugView::set_names(double scale, int picture_px) {
    name_height_ = scale * kNameHeight;
    const int text_px = text_height_px(name_height_, picture_px);
    if (std::exchange(name_px_, text_px) != text_px) names_.clear();
}

void DebugView::append_site(const bus::SiteDescription& site,
                            const Eigen::Matrix4d& world_from_site,
                            std::vector<Line>& lines,
                            std::vector<renderer::Label>& labels) {
    Eigen::Matrix4d site_from_box = Eigen::Matrix4d::Identity();
    site_from_box.topRightCorner<3, 1>() = site.bounds_site.centre();
    append_box(world_from_site * site_from_box, site.bounds_site.size(), kSpaceColour, lines);
    for (const geometry::CalibratedCamera& camera : site.cameras) {
        append_frustum(camera, world_from_site, kFrustumM, kCameraColour, lines);
        const std::string name = site.site + "/" + camera.name;
        auto found = names_.find(name);
        if (found == names_.end()) {
            if (names_.size() >= kMaxNames || ++num_new_names_ > kMaxNewNames) continue;
            found = names_.emplace(name, draw_text(name, name_px_)).first;
        }
        if (labels.size() >= kMaxNames) continue;
        labels.push_back(
            {.picture = found->second,
             .at_world = (world_from_site * camera.centre_site().homogeneous()).head<3>(),
             .height = name_height_,
             .opacity = 0.9});
    }
}

void DebugView::append(const SceneView& scene,
                       const PeopleView& people,
                       const ProxyView& proxies,
                       const renderer::SceneRenderer& renderer,
                       std::vector<Line>& lines,
                       std::vector<renderer::Label>& labels) {
    num_new_names_ = 0;
    for (const auto& [name, site] : scene.sites())
        append_site(*site, renderer.world_from_site(name), lines, labels);
    for (const auto& [name, place] : people.places(renderer)) {
        if (!people.is_drawn(name)) continue;
        Eigen::Matrix4d world_from_box = renderer.world_from_site(name);
        world_from_box.topRightCorner<3, 1>() = place.middle;
        append_box(world_from_box, place.size, kPersonColour, lines);
    }
    append_objects(scene, proxies, lines);
    proxies.append_people(lines);
}

}  // namespace atrium::viewer
