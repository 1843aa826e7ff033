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

/// Options of a simulated room and its person.
struct RoomOptions {
    int num_people = 1;                   // 1 to `kMaxPeople`, on a circle around `position_m`
    std::string look = "ada";             // one of `look_names()`; others have the next ones
    std::string motion = "wave";          // one of `motion_names()`; "table_hands" brings a table
    std::filesystem::path model;          // if not empty: replaces the person and its motion
    std::filesystem::path motion_file{};  // if not empty: moves the model
    double model_height_m = 0.0;          // scales the model to this height; 0: as in its file
    double model_turn_rad = 0.0;          // about the vertical, positive turns left
    double loop_s = 3.0;                  // the motion repeats after this time
    double rate_hz = 30.0;                // pictures per second of every camera
    double noise_lsb = 2.0;               // standard deviation of the noise of each colour channel
    std::uint64_t seed = 1;               // of the noise
    Eigen::Vector3d position_m{0.0, 0.0, 0.0};  // of the person or the table's centre, site frame
    double heading_rad = 0.0;                   // 0 faces +Y, positive turns left
    int num_empty_frames = 16;                  // pictures of the empty room per camera

    /// Number of instants in a loop; the loop lasts exactly this many picture intervals.
    int num_frames() const;
    double frame_time_s(int frame) const { return frame / rate_hz; }
};

constexpr int kMaxPeople = 4;

/// Radius of the circle on which people stand, so that neighbours are 1.2 m apart [m]; 0 for one.
double circle_of_people_m(int num_people);

/// Returns the options of one of several people, whose look and place are its own.
RoomOptions options_of_person(const RoomOptions& options, int index);

/// Returns where one of several people is in its motion while the room is at `time_s`: each is
/// ahead of the one before.
double time_of_person_s(const RoomOptions& options, int index, double time_s);

/// Checks the options. Error kConfiguration names the option and the allowed values.
Expected<void> check(const RoomOptions& options);

/// A skin at one instant: positions and unit normals in the site frame.
struct PosedSkin {
    std::vector<Eigen::Vector3f> positions;
    std::vector<Eigen::Vector3f> normals;
};

/// A built-in person: a closed skin that follows a motion. Const methods are thread-safe.
class Person {
public:
    static Expected<Person> create(const RoomOptions& options);

    /// Returns the ground truth at `time_s` [s], in any loop, in the site frame: closed,
    /// 2-manifold, counter-clockwise from outside.
    geometry::TriangleMesh mesh(double time_s) const;

    /// Computes the same vertices as `mesh(time_s)`, for drawing.
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

}  // namespace atrium::simulation
