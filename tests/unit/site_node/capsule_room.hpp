#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "site_node/capture/frame_source.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace atrium::site_node::test {

/// All points nearer than `radius_m` to the segment from `a` to `b`, in the site frame.
struct Capsule {
    Eigen::Vector3d a;
    Eigen::Vector3d b;
    double radius_m = 0.1;
};

/// A person of 1.75 m who stands at `floor_site` with both arms held out.
std::vector<Capsule> make_body(const Eigen::Vector3d& floor_site);

/// Per pixel: 1 + the index of the capsule in front, 0 where there is none. With lens distortion.
image::Plane limbs_in_front(std::span<const Capsule> body,
                            const geometry::CalibratedCamera& camera);

/// Pixels whose rays hit a capsule, with lens distortion.
image::Mask draw(std::span<const Capsule> body, const geometry::CalibratedCamera& camera);

/// All cameras at one instant, with silhouettes.
capture::Metaframe take_pictures(std::span<const Capsule> body, const config::Rig& rig);

/// Cameras that deliver silhouettes. `run` delivers nothing.
class StillSource : public capture::FrameSource {
public:
    explicit StillSource(config::Rig rig) : rig_(std::move(rig)) {}
    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return true; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink&,
                                                std::stop_token) override {
        return std::vector<Expected<void>>(cameras.size());
    }
    Expected<void> run(std::stop_token, const Sink&) override { return {}; }

private:
    config::Rig rig_;
};

/// Random points of the body that are at least `margin_m` below its surface.
std::vector<Eigen::Vector3d> points_inside(std::span<const Capsule> body,
                                           double margin_m,
                                           std::size_t count);

}  // namespace atrium::site_node::test
