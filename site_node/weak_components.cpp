#include "site_node/weak_components.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace atrium::site_node {
namespace {

// Larger components, relative to the largest, are people.
constexpr double kSmall = 0.2;
// What a component has to show alone: pixels at half resolution, and a share of all it shows.
constexpr std::size_t kMinAlone = 10;
constexpr double kMinAloneShare = 0.2;
// Marks in Cover::pixels.
constexpr std::uint8_t kCovered = 1;
constexpr std::uint8_t kOwn = 2;

}  // namespace

std::uint32_t WeakComponents::root_of(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) {
        parent_[vertex] = parent_[parent_[vertex]];
        vertex = parent_[vertex];
    }
    return vertex;
}

void WeakComponents::find_components(const geometry::TriangleMesh& mesh) {
    parent_.resize(mesh.vertices.size());
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
    for (const auto& t : mesh.triangles) {
        const std::uint32_t root = root_of(t[0]);
        parent_[root_of(t[1])] = root;
        parent_[root_of(t[2])] = root;
    }
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    component_of_root_.assign(mesh.vertices.size(), kNone);
    components_.clear();
    for (const auto& t : mesh.triangles) {
        std::uint32_t& index = component_of_root_[root_of(t[0])];
        if (index == kNone) {
            index = static_cast<std::uint32_t>(components_.size());
            components_.push_back({.root = root_of(t[0])});
        }
        Component& component = components_[index];
        ++component.num;
        const Eigen::Vector3d& from = mesh.vertices[component.root];
        component.volume_m3 +=
            (mesh.vertices[t[0]] - from)
                .dot((mesh.vertices[t[1]] - from).cross(mesh.vertices[t[2]] - from)) /
            6.0;
    }
    // by volume; equal ones in the order of the mesh
    std::sort(components_.begin(), components_.end(), [](const auto& a, const auto& b) {
        return a.volume_m3 != b.volume_m3 ? a.volume_m3 > b.volume_m3 : a.root < b.root;
    });
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < components_.size(); ++i) {
        component_of_root_[components_[i].root] = i;
        components_[i].first = first;
        first += components_[i].num;
        components_[i].num = 0;
    }
    triangles_.resize(mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        Component& component = components_[component_of_root_[root_of(mesh.triangles[t][0])]];
        triangles_[component.first + component.num++] = t;
    }
}

void WeakComponents::project(std::span<const hull::SilhouetteView* const> views,
                             const geometry::TriangleMesh& mesh) {
    covers_.resize(views.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
        Cover& cover = covers_[i];
        cover.view = views[i];
        if (cover.view == nullptr) continue;
        const geometry::PinholeCamera& lens = cover.view->intrinsics;
        cover.width = (lens.width + 1) / 2;
        cover.height = (lens.height + 1) / 2;
        cover.pixels.assign(
            static_cast<std::size_t>(cover.width) * static_cast<std::size_t>(cover.height), 0);
        cover.projected.resize(2 * mesh.vertices.size());
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            const Eigen::Vector3d p = cover.view->camera_from_site * mesh.vertices[v];
            const Eigen::Vector2d px =
                p.z() > 0.0 ? lens.project(p)
                            : Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
            cover.projected[2 * v] = static_cast<float>(0.5 * px.x());
            cover.projected[2 * v + 1] = static_cast<float>(0.5 * px.y());
        }
    }
}

// Visits each pixel whose centre a triangle covers, a few of them twice. Triangles on the far side
// cover the same pixels as those on the near side, and are left out.
template <typename Visit>
void WeakComponents::rasterise(const Component& component,
                               const geometry::TriangleMesh& mesh,
                               const Cover& cover,
                               Visit&& visit) const {
    for (std::uint32_t i = 0; i < component.num; ++i) {
        const auto& t = mesh.triangles[triangles_[component.first + i]];
        const float* const a = &cover.projected[2 * t[0]];
        const float* const b = &cover.projected[2 * t[1]];
        const float* const c = &cover.projected[2 * t[2]];
        const float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if (!(area < 0.0F)) continue;  // counter-clockwise seen with +Y down is negative
        const auto top = std::max(std::ceil(std::min({a[1], b[1], c[1]})), 0.0F);
        const auto bottom = std::min(std::floor(std::max({a[1], b[1], c[1]})),
                                     static_cast<float>(cover.height - 1));
        for (float y = top; y <= bottom; y += 1.0F) {
            float left = std::numeric_limits<float>::max();
            float right = std::numeric_limits<float>::lowest();
            for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}}) {
                if ((p[1] < y && q[1] < y) || (p[1] > y && q[1] > y)) continue;
                const float x =
                    p[1] == q[1] ? p[0] : p[0] + (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]);
                left = std::min(left, p[1] == q[1] ? std::min(p[0], q[0]) : x);
                right = std::max(right, p[1] == q[1] ? std::max(p[0], q[0]) : x);
            }
            const int end =
                static_cast<int>(std::min(std::floor(right), static_cast<float>(cover.width - 1)));
            for (int x = static_cast<int>(std::max(std::ceil(left), 0.0F)); x <= end; ++x)
                visit(static_cast<std::uint32_t>(static_cast<int>(y) * cover.width + x));
        }
    }
}

bool WeakComponents::is_needed(const Component& component, const geometry::TriangleMesh& mesh) {
    bool is_needed = false;
    for (Cover& cover : covers_) {
        if (cover.view == nullptr || is_needed) continue;
        own_.clear();
        std::size_t num_alone = 0;
        rasterise(component, mesh, cover, [&](std::uint32_t pixel) {
            if ((cover.pixels[pixel] & kOwn) != 0) return;
            num_alone += cover.pixels[pixel] == 0 ? 1 : 0;
            cover.pixels[pixel] |= kOwn;
            own_.push_back(pixel);
        });
        for (const std::uint32_t pixel : own_) cover.pixels[pixel] &= kCovered;
        is_needed = num_alone >= kMinAlone && static_cast<double>(num_alone) >=
                                                  kMinAloneShare * static_cast<double>(own_.size());
    }
    return is_needed;
}

void WeakComponents::remove_dropped(hull::VisualHull& hull) {
    geometry::TriangleMesh& mesh = hull.mesh;
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    for (std::uint32_t v = 0; v < parent_.size(); ++v) parent_[v] = root_of(v);
    std::uint32_t num_vertices = 0;
    for (std::uint32_t v = 0; v < parent_.size(); ++v) {
        const bool is_kept = components_[component_of_root_[parent_[v]]].is_kept;
        if (is_kept) mesh.vertices[num_vertices] = mesh.vertices[v];
        parent_[v] = is_kept ? num_vertices++ : kNone;  // its new index
    }
    mesh.vertices.resize(num_vertices);
    std::erase_if(mesh.triangles, [&](auto& t) {
        if (parent_[t[0]] == kNone) return true;
        for (std::uint32_t& v : t) v = parent_[v];
        return false;
    });
}

void WeakComponents::drop(std::span<const hull::SilhouetteView* const> views,
                          hull::VisualHull& hull) {
    if (hull.status != hull::HullStatus::kOk || hull.num_components < 2) return;
    find_components(hull.mesh);
    const double small_m3 = kSmall * components_.front().volume_m3;
    if (components_.back().volume_m3 >= small_m3) return;
    project(views, hull.mesh);
    std::uint32_t num_dropped = 0;
    for (Component& component : components_) {
        component.is_kept = component.volume_m3 >= small_m3 || is_needed(component, hull.mesh);
        if (!component.is_kept) {
            ++num_dropped;
            hull.volume_dropped_m3 += component.volume_m3;
            continue;
        }
        for (Cover& cover : covers_) {
            if (cover.view == nullptr) continue;
            rasterise(component, hull.mesh, cover, [&](std::uint32_t pixel) {
                cover.pixels[pixel] = kCovered;
            });
        }
    }
    if (num_dropped == 0) return;
    hull.num_components -= num_dropped;
    hull.num_phantoms_dropped += num_dropped;
    remove_dropped(hull);
}

}  // namespace atrium::site_node
