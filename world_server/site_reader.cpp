#include "world_server/site_reader.hpp"

#include <fmt/format.h>

#include <chrono>

namespace atrium::world_server {
namespace {

// Ten times the size of a usual person mesh. A room reaches less than 15 m from its origin.
constexpr codec::MeshLimits kLimits{
    .max_triangles = 100'000, .max_vertices = 60'000, .max_coordinate_m = 15.0};
// A capture time that is further back than this means that the site was restarted with another
// clock, such as a recording that is played again. A smaller step back is an out-of-order sample.
constexpr std::chrono::seconds kRestart{1};

}  // namespace

bool is_out_of_order(Timestamp capture, Timestamp last_capture) {
    return capture <= last_capture && last_capture - capture < kRestart;
}

Expected<std::optional<physics::PersonShape>> SiteReader::read(const bus::SiteMesh& message) {
    if (is_out_of_order(message.capture_time, last_capture_)) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("site {}: mesh {} was captured before the last one",
                                      message.site,
                                      message.frame_id));
    }
    if (message.draco.empty()) {
        last_capture_ = message.capture_time;
        shaper_.forget();
        return std::nullopt;
    }
    if (auto ok = decoder_.decode(message.draco, message.mesh_sizes, kLimits, mesh_); !ok) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("site {}: {}", message.site, ok.error().message));
    }
    last_capture_ = message.capture_time;
    const Eigen::Matrix3d rotation = world_from_site_.rotation.toRotationMatrix();
    for (Eigen::Vector3d& vertex : mesh_.vertices)
        vertex = rotation * vertex + world_from_site_.translation;
    return shaper_.shape(mesh_, message.capture_time);
}

}  // namespace atrium::world_server
