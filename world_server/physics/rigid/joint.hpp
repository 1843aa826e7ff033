#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

class btTypedConstraint;

namespace atrium::physics {

class ObjectBody;

enum class JointKind : std::uint8_t {
    kHinge,   // rotates about an axis
    kBall,    // rotates freely about a point
    kSlider,  // moves along an axis without rotation
    kSpring   // pulls and pushes along the line between two points; see `pulls_only`
};

/// Connects two objects, or an object and the world.
///
/// Places and directions are in the world frame, with both objects at their start pose. Angles and
/// distances are measured from there, of `a` relative to `b`, right-handed about the axis.
struct Joint {
    JointKind kind = JointKind::kBall;
    std::uint32_t a = 0;
    std::uint32_t b = 0;  // 0: the world
    Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // hinge, slider; ball: twist axis
    std::optional<std::array<double, 2>> limits{};    // hinge [rad], slider [m]; empty: no limits
    std::optional<double> swing_rad{};  // ball: limit in both directions about the other two axes
    std::optional<double> twist_rad{};  // ball: limit in both directions about the axis
    double motor_speed = 0.0;           // hinge [rad/s], slider [m/s]
    double motor_max = 0.0;             // hinge [N m], slider [N]; 0: no motor
    double damping = 0.0;               // hinge, ball [N m s/rad], slider, spring [N s/m]
    double stiffness_npm = 0.0;         // spring
    double rest_length_m = 0.0;         // spring
    double force_max = 0.0;             // spring [N]: limit on the elastic force; 0: no limit
    Eigen::Vector3d anchor_b_m = Eigen::Vector3d::Zero();  // spring: the end at `b`
    bool pulls_only = false;                               // spring: acts like a string
    bool collides = false;                                 // `a` and `b` collide with each other
};

/// Names an invalid field of a joint and its allowed values.
struct JointProblem {
    std::string_view field;
    std::string_view allowed;
};

/// Returns the first problem: a number that is not finite or out of range, an axis without length,
/// or `a` equal to `b` or to the world. Empty if the joint is valid.
std::optional<JointProblem> find_problem(const Joint& joint);

/// A joint in the Bullet world.
class JointBody {
public:
    /// `find_problem(joint)` must be empty; `b` is null for the world. Both objects outlive this.
    JointBody(const Joint& joint, ObjectBody& a, ObjectBody* b, double tick_s);
    ~JointBody();
    JointBody(const JointBody&) = delete;
    JointBody& operator=(const JointBody&) = delete;

    const Joint& joint() const { return joint_; }
    btTypedConstraint& constraint() { return *constraint_; }
    /// Call before every tick. Applies springs and damping as implicit impulses, which are stable
    /// for any step length.
    void begin_tick();
    /// Distance between the two anchors [m]; for a slider across its axis. 0 for a spring.
    double gap_m() const;

private:
    void pull();
    void damp_turning();
    void damp_sliding();

    Joint joint_;
    ObjectBody& a_;
    ObjectBody* b_;
    double tick_s_;
    // in the body frames; in the world frame if `b` is the world
    Eigen::Vector3d anchor_in_a_, anchor_in_b_;
    Eigen::Vector3d axis_in_b_;
    std::unique_ptr<btTypedConstraint> constraint_;
};

}  // namespace atrium::physics
