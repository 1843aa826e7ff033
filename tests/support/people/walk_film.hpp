#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "site_node/coherence/tangency.hpp"
#include "tests/support/random.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace atrium::test {

/// What a camera sees: changes the points of one picture. `look`: number of the instant.
using Spoil = std::function<void(std::size_t camera,
                                 std::size_t look,
                                 Random& random,
                                 std::vector<std::vector<Eigen::Vector2d>>& contours)>;

/// How the pictures of a walk differ from those of the rig.
struct Filming {
    std::vector<geometry::CalibratedCamera> truth;  // where the cameras really are
    std::size_t late_camera = 0;
    int late_instants = 0;  // 1 or -1: of `late_camera`
    double noise_px = 0.3;  // of each point of an outline, up to
    Spoil spoil{};
};

/// People who walk for 24 s, seen twice a second.
class WalkFilm {
public:
    /// `first_look`: a film that ends at the look before goes on here.
    explicit WalkFilm(std::uint64_t seed, int num_people = 1, std::size_t first_look = 0);

    std::size_t num_looks() const { return looks_.size(); }
    coherence::Sight sight(std::size_t look, const Filming& filming) const;

private:
    // points of the skins at the look, one and two instants before, one after
    std::vector<std::array<std::vector<Eigen::Vector3d>, 4>> looks_;
    std::uint64_t seed_;
    std::size_t first_look_;
};

}  // namespace atrium::test
