#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "simulation/body_shape.hpp"
#include "simulation/choreography.hpp"
#include "simulation/look.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::simulation {

/// A room that does not exist and who is in it.
struct RoomOptions {
    std::string look = "ada";     // one of `look_names()`
    std::string motion = "wave";  // one of `motion_names()`; "table_hands" brings a table
    std::filesystem::path model;  // if not empty: who stands there instead, and its motion
    double model_height_m = 0.0;  // scales the model to it; 0: as in its file
    double model_turn_rad = 0.0;  // about the vertical, positive turns left
    double loop_s = 3.0;          // the motion repeats after this time
    double rate_hz = 30.0;        // pictures per second of every camera
    double noise_lsb = 2.0;       // standard deviation of the noise of each colour channel
    std::uint64_t seed = 1;       // of the noise
    Eigen::Vector3d position_m{
        0.0, 0.0, 0.0};         // site: where the person stands, or the table's centre
    double heading_rad = 0.0;   // 0 faces +Y, positive turns left
    int num_empty_frames = 16;  // pictures of the empty room per camera

    /// Number of instants in a loop; the loop lasts exactly that many picture intervals.
    int num_frames() const;
    double frame_time_s(int frame) const { return frame / rate_hz; }
};

/// Error kConfiguration that names the option and what is allowed.
Expected<void> check(const RoomOptions& options);

/// Skin of one instant: positions and unit normals of the same vertices, in the site frame.
struct PosedSkin {
    std::vector<Eigen::Vector3f> positions;
    std::vector<Eigen::Vector3f> normals;
};

/// A built-in person: a skin of one closed mesh that follows a motion. Const use is thread-safe.
class Person {
public:
    static Expected<Person> create(const RoomOptions& options);

    /// Ground truth in the site frame at `time_s` [s], of any loop: closed, 2-manifold,
    /// counter-clockwise from outside.
    geometry::TriangleMesh mesh(double time_s) const;

    /// The same vertices as `mesh(time_s)`, as they are drawn.
    void pose(double time_s, PosedSkin& out) const;

    const Look& look() const { return look_; }
    const Skin& skin() const { return skin_; }
    Motion motion() const { return motion_; }

private:
    Person() = default;
    template <typename Visit>
    void visit_vertices(double time_s, Visit&& visit) const;

    RoomOptions options_;
    Look look_;
    Motion motion_ = Motion::kWave;
    Skin skin_;
};

/// `Person::mesh` for one instant; builds the whole person, so make a `Person` for more than one.
/// `options` are valid.
geometry::TriangleMesh person_mesh(const RoomOptions& options, double time_s);

}  // namespace atrium::simulation
