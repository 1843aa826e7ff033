#pragma once

#include "site_node/hull/cones.hpp"
#include "site_node/hull/pencils.hpp"
#include "site_node/hull/strip_sweep.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <map>
#include <vector>

// Parts of hull_charts: the contents of single strips, as JSON.
namespace atrium::bench {

inline nlohmann::json list(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
inline nlohmann::json list(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }

/// One hull's faces, strip by strip.
struct Faces {
    hull::Cones cones;
    hull::Pencils pencils;
    std::map<std::uint32_t, hull::RunFaces> of_strip;
    std::map<hull::VertexKey, Eigen::Vector3d> position;

    const Eigen::Vector3d& at(const hull::RunFaces& faces, std::uint32_t v) const {
        return position.at(faces.vertices[v].key);
    }
};

Faces find_faces(const std::vector<hull::SilhouetteView>& views);

/// The strip with the most events and faces that is still readable.
std::uint32_t choose_strip(Faces& all);

/// Everything that cuts a strip, its faces, and the cameras' verdicts at one place of the sweep.
nlohmann::json chart_of(const std::vector<hull::SilhouetteView>& views,
                        Faces& all,
                        std::uint32_t strip);

/// The faces around the first vertex of three cameras without a very short edge.
nlohmann::json corner_of(const std::vector<hull::SilhouetteView>& views, Faces& all);

/// The rays of views `i` and `k` by their angle around the line through both.
nlohmann::json pencil_of(const Faces& all, std::size_t i, std::size_t k);

}  // namespace atrium::bench
