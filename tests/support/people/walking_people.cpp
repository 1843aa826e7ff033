#include "tests/support/people/walking_people.hpp"

#include "tests/support/random.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace atrium::test {
namespace {

constexpr double kStride_s = 1.1;

}  // namespace

WalkingPeople::WalkingPeople(const WalkOptions& options) : options_(options) {
    Random random(options.seed);
    const std::vector<std::string> looks = simulation::look_names();
    for (int i = 0; i < options.num_people; ++i) {
        simulation::RoomOptions room;
        room.look = looks[static_cast<std::size_t>(i) % looks.size()];
        room.motion = "walk";
        room.loop_s = kStride_s;
        room.rate_hz = 30.0;
        auto person = simulation::Person::create(room);
        if (!person) throw std::runtime_error(person.error().message);
        Walker walker{std::move(*person), {}, {}, 0.0};
        const double pace = options.speed_m_s / options.reach_m;
        for (int axis = 0; axis < 2; ++axis) {
            walker.phase[axis] = between(random, 0.0, 2.0 * std::numbers::pi);
            walker.rate[axis] = pace * between(random, 0.5, 1.0);
        }
        walker.stride_phase = between(random, 0.0, kStride_s);
        people_.push_back(std::move(walker));
    }
}

std::vector<Eigen::Vector3d> WalkingPeople::skin(std::size_t index, double time_s) const {
    const Walker& walker = people_[index];
    simulation::PosedSkin posed;
    walker.person.pose(time_s + walker.stride_phase, posed);
    const Eigen::Array2d angle = walker.phase + walker.rate * time_s;
    const Eigen::Array2d place = options_.reach_m * angle.sin();
    const Eigen::Array2d velocity = walker.rate * angle.cos();
    // 0 faces +Y
    const double heading = std::atan2(-velocity.x(), velocity.y());
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    std::vector<Eigen::Vector3d> points;
    points.reserve(posed.positions.size());
    for (const Eigen::Vector3f& p : posed.positions)
        points.push_back(turn * p.cast<double>() + Eigen::Vector3d(place.x(), place.y(), 0.0));
    return points;
}

std::vector<Eigen::Vector3d> WalkingPeople::points(double time_s, std::size_t every) const {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < people_.size(); ++i) {
        const auto all = skin(i, time_s);
        for (std::size_t v = 0; v < all.size(); v += every) points.push_back(all[v]);
    }
    return points;
}

geometry::CalibratedCamera bumped(const geometry::CalibratedCamera& camera,
                                  const Eigen::Vector3d& turn,
                                  const Eigen::Vector3d& move_m) {
    geometry::RigidTransform site_from_camera = camera.camera_from_site.inverse();
    if (turn.norm() > 0.0)
        site_from_camera.rotation =
            (Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) *
             site_from_camera.rotation)
                .normalized();
    site_from_camera.translation += move_m;
    geometry::CalibratedCamera result = camera;
    result.camera_from_site = site_from_camera.inverse();
    return result;
}

}  // namespace atrium::test
