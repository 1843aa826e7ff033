#include "viewer/overlay/annotations.hpp"

#include "viewer/overlay/label_layout.hpp"
#include "viewer/overlay/label_scale.hpp"
#include "viewer/overlay/text_picture.hpp"

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace atrium::viewer {

void Annotations::take(ProxyInbox& proxies, Clock::time_point now) {
    proxies.want(is_debug_);
    proxies_.update(proxies.take(), now);
    if (!is_debug_) proxies_.clear();
}

// The first eye decides on widths and directions; another is only centimetres away.
void Annotations::append_edit(const SceneView& scene,
                              std::span<const renderer::EyeView> eyes,
                              std::vector<renderer::Label>& labels) {
    if (eyes.empty()) return;
    const std::vector<Eigen::Vector3f>* soft = nullptr;
    std::shared_ptr<const renderer::ShapeMesh> mesh;
    if (edit_.selected) {
        const auto nodes = scene.nodes().find(edit_.selected->object);
        if (nodes != scene.nodes().end()) soft = &nodes->second;
        mesh = scene.mesh_of(*edit_.selected);
    }
    edit_shapes_.append(edit_, mesh, soft, eyes.front(), triangles_, labels);
}

void Annotations::update(const SceneView& scene,
                         const PeopleView& people,
                         const std::string& inside,
                         std::span<const renderer::EyeView> eyes,
                         Clock::time_point now,
                         renderer::SceneRenderer& renderer) {
    std::vector<renderer::Label> labels;
    const int picture_px = eyes.empty() ? 0 : eyes.front().part_px.height;
    const double scale = label_scale_of(ui_scale_, picture_px);
    const double name_height = scale * NameTags::kHeight;
    names_.set_size(name_height, text_height_px(name_height, picture_px));
    debug_.set_names(scale, picture_px);
    if (has_names_ && !eyes.empty()) {
        std::map<std::string, NameTags::Person> heads;
        for (const auto& [name, place] : people.places(renderer))
            heads[name] = {place.top, people.opacity(name, now)};
        labels = names_.update(heads, inside, eyes.front().eye_world(), now);
    }
    const std::size_t num_names = labels.size();
    lines_.clear();
    if (is_debug_)
        debug_.append(scene, people, proxies_, renderer, lines_, labels);
    else
        debug_.clear();
    if (!eyes.empty()) separate_labels(labels, num_names, eyes.front());
    triangles_.clear();
    append_edit(scene, eyes, labels);
    renderer.overlay().set_triangles(triangles_);
    renderer.overlay().set_wireframe(is_debug_);
    renderer.overlay().set_silhouettes(is_debug_ ? DebugView::kFrustumM : 0.0);
    renderer.overlay().set_lines(lines_);
    // of two eyes, panels lie over one only
    label_boxes_.clear();
    if (eyes.size() == 1) label_boxes_ = label_boxes(labels, eyes.front());
    renderer.overlay().set_labels(std::move(labels));
}

}  // namespace atrium::viewer
