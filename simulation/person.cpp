#include "simulation/person.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace atrium::simulation {
namespace {

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

tl::unexpected<Error> bad_option(const std::string& name, const std::string& rule) {
    return make_error(ErrorKind::kConfiguration, "simulation." + name + ": " + rule);
}

}  // namespace

int RoomOptions::num_frames() const {
    return std::max(1, static_cast<int>(std::lround(loop_s * rate_hz)));
}

double circle_of_people_m(int num_people) {
    constexpr double kApartM = 1.2;
    return num_people < 2 ? 0.0 : 0.5 * kApartM / std::sin(std::numbers::pi / num_people);
}

RoomOptions options_of_person(const RoomOptions& options, int index) {
    RoomOptions own = options;
    own.num_people = 1;
    if (options.num_people < 2) return own;
    const std::vector<std::string> looks = look_names();
    const auto first = std::find(looks.begin(), looks.end(), options.look) - looks.begin();
    own.look = looks[static_cast<std::size_t>(first + index) % looks.size()];
    const double angle = 2.0 * std::numbers::pi * index / options.num_people;
    own.position_m += circle_of_people_m(options.num_people) *
                      Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    return own;
}

double time_of_person_s(const RoomOptions& options, int index, double time_s) {
    constexpr double kLead = 0.12;  // of a loop
    return time_s + kLead * index * options.num_frames() / options.rate_hz;
}

Expected<void> check(const RoomOptions& options) {
    if (!find_look(options.look)) {
        return bad_option(
            "look", "must be one of " + joined(look_names()) + ", got '" + options.look + "'");
    }
    if (!find_motion(options.motion)) {
        return bad_option(
            "motion",
            "must be one of " + joined(motion_names()) + ", got '" + options.motion + "'");
    }
    if (options.num_people < 1 || options.num_people > kMaxPeople)
        return bad_option("people", "must be 1 to " + std::to_string(kMaxPeople));
    if (options.num_people > 1 && options.model.empty() && options.motion == "table_hands")
        return bad_option("people", "the table of table_hands is for one person");
    if (!(options.rate_hz >= 1.0 && options.rate_hz <= 240.0))
        return bad_option("rate_hz", "must be 1 to 240 Hz");
    if (!(options.loop_s > 0.0 && options.loop_s <= 60.0))
        return bad_option("loop_s", "must be above 0 and at most 60 s");
    if (!(options.noise_lsb >= 0.0 && options.noise_lsb <= 30.0))
        return bad_option("noise_lsb", "must be 0 to 30");
    if (options.num_empty_frames < 1 || options.num_empty_frames > 256) {
        return bad_option("num_empty_frames", "must be 1 to 256");
    }
    if (!options.position_m.allFinite() || options.position_m.norm() > 100.0) {
        return bad_option("position_m", "must be within 100 m of the origin");
    }
    if (!(options.model_height_m >= 0.0 && options.model_height_m <= 10.0))
        return bad_option("model_height_m", "must be 0 to 10 m");
    if (!options.motion_file.empty() && options.model.empty())
        return bad_option("motion_file", "needs simulation.model, the model that it moves");
    if (!std::isfinite(options.model_turn_rad))
        return bad_option("model_turn_rad", "must be a finite angle");
    if (!std::isfinite(options.heading_rad))
        return bad_option("heading_rad", "must be a finite angle");
    return {};
}

Expected<Person> Person::create(const RoomOptions& options) {
    if (auto valid = check(options); !valid) return tl::unexpected(valid.error());
    Person person;
    person.options_ = options;
    person.look_ = *find_look(options.look);
    person.motion_ = *find_motion(options.motion);
    person.skin_ = make_skin(person.look_);
    return person;
}

// Calls visit(index, position, normal), both in the site frame.
template <typename Visit>
void Person::visit_vertices(double time_s, Visit&& visit) const {
    const double loop_s = options_.num_frames() / options_.rate_hz;
    const double frame = std::fmod(time_s, loop_s);
    const SkinnedBody carried(skin_, pose_bones(posture(motion_, frame / loop_s)));
    // the person's height must not change the table or lift the hands off it
    const double scale = motion_ == Motion::kTableHands ? 1.0 : look_.height_m / kNominalHeight;
    const Eigen::Matrix3d site_from_body =
        Eigen::AngleAxisd(options_.heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    for (std::size_t i = 0; i < skin_.mesh.vertices.size(); ++i) {
        const SkinnedVertex vertex = carried.vertex(i);
        visit(i,
              Eigen::Vector3d(options_.position_m + scale * (site_from_body * vertex.position)),
              Eigen::Vector3d(site_from_body * vertex.normal));
    }
}

geometry::TriangleMesh Person::mesh(double time_s) const {
    geometry::TriangleMesh mesh;
    mesh.vertices.resize(skin_.mesh.vertices.size());
    mesh.triangles = skin_.mesh.triangles;
    visit_vertices(time_s,
                   [&](std::size_t i, const Eigen::Vector3d& position, const Eigen::Vector3d&) {
                       mesh.vertices[i] = position;
                   });
    return mesh;
}

void Person::pose(double time_s, PosedSkin& out) const {
    out.positions.resize(skin_.mesh.vertices.size());
    out.normals.resize(skin_.mesh.vertices.size());
    visit_vertices(
        time_s, [&](std::size_t i, const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
            out.positions[i] = position.cast<float>();
            const double length = normal.norm();
            out.normals[i] =
                (length > 0.0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::UnitZ())
                    .cast<float>();
        });
}

}  // namespace atrium::simulation
