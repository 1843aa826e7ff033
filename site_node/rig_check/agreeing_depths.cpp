#include "site_node/rig_check/agreeing_depths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::rig_check {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kSameCentre = 1e-9;  // relative length below which a projected ray is one point

bool even_odd(const std::vector<std::vector<Eigen::Vector2d>>& outlines, const Eigen::Vector2d& p) {
    bool inside = false;
    for (const auto& outline : outlines) {
        for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
            const Eigen::Vector2d& a = outline[j];
            const Eigen::Vector2d& b = outline[i];
            if ((a.y() > p.y()) == (b.y() > p.y())) continue;
            if (a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()) > p.x())
                inside = !inside;
        }
    }
    return inside;
}

// Adds the depths of `inside`'s complement to `seen`: agree = seen or not inside.
void unite_with_complement(const std::vector<DepthInterval>& seen,
                           const std::vector<DepthInterval>& inside,
                           std::vector<DepthInterval>& out) {
    out = seen;
    double from = 0.0;
    for (const DepthInterval& part : inside) {
        if (part.begin > from) out.push_back({from, part.begin});
        from = part.end;
    }
    if (from < kEndless) out.push_back({from, kEndless});
    std::sort(
        out.begin(), out.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
    std::size_t kept = 0;
    for (std::size_t i = 1; i < out.size(); ++i) {
        if (out[i].begin <= out[kept].end) {
            out[kept].end = std::max(out[kept].end, out[i].end);
        } else {
            out[++kept] = out[i];
        }
    }
    if (!out.empty()) out.resize(kept + 1);
}

}  // namespace

Projector::Projector(const hull::SilhouetteView& view, bool knows_outside) : view_(view) {
    const geometry::PinholeCamera& k = view.intrinsics;
    Eigen::Matrix3d pixel_from_camera;
    pixel_from_camera << k.fx, k.skew, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0;
    pixel_from_site_ =
        pixel_from_camera * view.camera_from_site.rotation.normalized().toRotationMatrix();
    centre_site_ = view.camera_from_site.inverse().translation;
    if (!view.field.empty()) {
        border_ = {view.field};
    } else if (!knows_outside) {
        const double right = k.width - 0.5;
        const double bottom = k.height - 0.5;
        border_ = {{{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}}};
    }
}

Eigen::Vector3d Projector::direction_site(const Eigen::Vector2d& pixel) const {
    return view_.camera_from_site.rotation.conjugate() * view_.intrinsics.ray_camera(pixel);
}

bool Projector::is_in_picture(const Eigen::Vector3d& p_site) const {
    const Eigen::Vector3d p = pixel_from_site_ * (p_site - centre_site_);
    if (!(p.z() > 0.0)) return false;
    const Eigen::Vector2d pixel = p.head<2>() / p.z();
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= view_.intrinsics.width - 0.5 &&
           pixel.y() <= view_.intrinsics.height - 0.5;
}

// The projection of depth d is at_start + d * along, homogeneous, on one line of the picture. Where
// outlines cross that line, the inside begins or ends.
void Projector::cross(const std::vector<std::vector<Eigen::Vector2d>>& outlines,
                      const Eigen::Vector3d& at_start,
                      const Eigen::Vector3d& along,
                      std::vector<DepthInterval>& inside) {
    inside.clear();
    const bool starts_in_front = at_start.z() > 0.0;
    if (!starts_in_front && !(along.z() > 0.0)) return;  // behind the camera everywhere
    const double first = starts_in_front ? 0.0 : -at_start.z() / along.z();
    const double last = along.z() < 0.0 ? -at_start.z() / along.z() : kEndless;
    if (at_start.norm() <= kSameCentre * along.norm()) {
        if (even_odd(outlines, along.head<2>() / along.z())) inside.push_back({first, last});
        return;
    }
    const Eigen::Vector3d line = at_start.cross(along);
    Eigen::Vector2d epipole = Eigen::Vector2d::Zero();
    Eigen::Vector2d ahead = Eigen::Vector2d::Zero();
    if (starts_in_front) {
        epipole = at_start.head<2>() / at_start.z();
        ahead = along.head<2>() - epipole * along.z();
    }
    toggles_.clear();
    bool is_inside = false;
    const auto take = [&](const Eigen::Vector2d& x) {
        const Eigen::Vector2d slope = x * along.z() - along.head<2>();
        const int c = std::abs(slope.x()) > std::abs(slope.y()) ? 0 : 1;
        const double depth = (at_start[c] - x[c] * at_start.z()) / slope[c];
        if (starts_in_front && (x - epipole).dot(ahead) < 0.0) {
            is_inside = !is_inside;  // on the other side of the start: decides only its parity
        } else if (depth > first && depth < last) {
            toggles_.push_back(depth);
        }
    };
    for (const auto& outline : outlines) {
        if (outline.empty()) continue;
        double former = line.dot(outline.back().homogeneous());
        const Eigen::Vector2d* from = &outline.back();
        for (const Eigen::Vector2d& p : outline) {
            const double side = line.dot(p.homogeneous());
            if ((former > 0.0) != (side > 0.0))
                take(*from + former / (former - side) * (p - *from));
            former = side;
            from = &p;
        }
    }
    std::sort(toggles_.begin(), toggles_.end());
    double begin = first;
    for (const double depth : toggles_) {
        if (is_inside) inside.push_back({begin, depth});
        is_inside = !is_inside;
        begin = depth;
    }
    if (is_inside) inside.push_back({begin, last});
}

void Projector::find(const Eigen::Vector3d& centre_site,
                     const Eigen::Vector3d& direction_site,
                     std::vector<DepthInterval>& seen,
                     std::vector<DepthInterval>& agreeing) {
    const Eigen::Vector3d at_start = pixel_from_site_ * (centre_site - centre_site_);
    const Eigen::Vector3d along = pixel_from_site_ * direction_site;
    cross(view_.contours, at_start, along, seen);
    if (border_.empty()) {
        agreeing = seen;
        return;
    }
    cross(border_, at_start, along, in_picture_);
    unite_with_complement(seen, in_picture_, agreeing);
}

}  // namespace atrium::rig_check
