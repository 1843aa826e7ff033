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
    kHinge,   // turns about an axis
    kBall,    // turns every way about a point
    kSlider,  // moves along an axis and turns no way
    kSpring   // pulls, and pushes unless told otherwise, along the line between two points
};

/// Two objects, or an object and the world, that are joined. Places and directions are those of the
/// world when both objects are where they start; angles and ways are counted from there, of `a`
/// against `b`, right-handed about the axis.
struct Joint {
    JointKind kind = JointKind::kBall;
    std::uint32_t a = 0;
    std::uint32_t b = 0;  // 0: the world
    Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // hinge, slider; ball: that of its twist
    std::optional<std::array<double, 2>> limits{};    // hinge [rad], slider [m]; none: free
    std::optional<double> swing_rad{};                // ball: either way about both other axes
    std::optional<double> twist_rad{};                // ball: either way about the axis
    double motor_speed = 0.0;                         // hinge [rad/s], slider [m/s]
    double motor_max = 0.0;                           // hinge [N m], slider [N]; 0: no motor
    double damping = 0.0;        // hinge, ball [N m s/rad], slider, spring [N s/m]
    double stiffness_npm = 0.0;  // spring
    double rest_length_m = 0.0;  // spring
    double force_max = 0.0;      // spring [N]: its length pulls no more, as if it gave; 0: no bound
    Eigen::Vector3d anchor_b_m = Eigen::Vector3d::Zero();  // spring: its other end, at `b`
    bool pulls_only = false;                               // spring: a string
    bool collides = false;                                 // `a` with `b`
};

/// What is wrong with a joint, and what would be right.
struct JointProblem {
    std::string_view field;
    std::string_view allowed;
};

/// A number is not finite or out of its range, an axis has no length, or `a` is `b` or the world.
std::optional<JointProblem> find_problem(const Joint& joint);

/// A joint with what Bullet knows of it.
class JointBody {
public:
    /// `joint` must have no problem; `b` is null for the world. Both outlive this.
    JointBody(const Joint& joint, ObjectBody& a, ObjectBody* b, double tick_s);
    ~JointBody();
    JointBody(const JointBody&) = delete;
    JointBody& operator=(const JointBody&) = delete;

    const Joint& joint() const { return joint_; }
    btTypedConstraint& constraint() { return *constraint_; }
    /// Before every tick: springs and damping, which act as impulses that no step length makes
    /// unstable.
    void begin_tick();
    /// How far the two objects have come apart where they are joined [m]; 0 for a spring.
    double gap_m() const;

private:
    void pull();
    void damp_turning();
    void damp_sliding();

    Joint joint_;
    ObjectBody& a_;
    ObjectBody* b_;
    double tick_s_;
    // in the frames that Bullet knows; of the world where `b` is
    Eigen::Vector3d anchor_in_a_, anchor_in_b_;
    Eigen::Vector3d axis_in_b_;
    std::unique_ptr<btTypedConstraint> constraint_;
};

}  // namespace atrium::physics
