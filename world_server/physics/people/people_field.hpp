#pragma once

#include "world_server/physics/options/people_options.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/people/surfel_grid.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::physics {

/// A person's surface near a query point. World frame.
struct SurfacePoint {
    float distance_m = 0.0F;   // signed distance of the query point along the normal; < 0: inside
    Eigen::Vector3f normal;    // unit length, outwards
    Eigen::Vector3f velocity;  // [m/s] of the surface
};

/// The object surface at a query point.
struct SurfaceProbe {
    Eigen::Vector3f velocity = Eigen::Vector3f::Zero();  // [m/s] of the object at the point
    /// Outward normal of the object at the point, unit length. Zero: no direction.
    Eigen::Vector3f outwards = Eigen::Vector3f::Zero();

    /// True if a surface with this normal faces the object. Other surfaces are ignored: the back of
    /// a hand does not push down what lies on its palm, whatever the thickness and depth.
    /// `facing`: see `PeopleFieldOptions`.
    bool faces(const Eigen::Vector3f& normal, float facing) const {
        return outwards.isZero() || normal.dot(outwards) < facing;
    }
    /// Octants that contain normals which face the object.
    std::uint8_t facing_octants(float facing) const;
};

/// One person's surface at the start of a tick.
class PersonField {
public:
    explicit PersonField(const PeopleFieldOptions& options = {});

    const PeopleFieldOptions& options() const { return options_; }
    /// Replaces the shape. Copies no surfels.
    void set_shape(const PersonShape& shape);
    /// Places the surfels at the start of a tick of `tick_s`, with the velocities that carry them
    /// through it, and advances the time by one tick.
    void begin_tick(double tick_s);

    /// Finds the surface near a point. Empty if no facing surface is within reach, or if the object
    /// there moves out of the person.
    std::optional<SurfacePoint> query(const Eigen::Vector3f& point,
                                      const SurfaceProbe& probe) const;

    /// Finds the nearest surfel within `radius_m` for which `accept(surfel)` holds. Null if there
    /// is none. Slower than `query`, but works deep inside a person.
    template <typename Accept>
    const PlacedSurfel* nearest(const Eigen::Vector3f& point,
                                float radius_m,
                                const Accept& accept) const;

    /// False if `query` would find nothing. Fast.
    bool may_find(const Eigen::Vector3f& point, const SurfaceProbe& probe) const {
        return (grid_.octants_near(point) & probe.facing_octants(options_.facing)) != 0;
    }

    /// True in one tick per mesh, halfway between two meshes: the time to compare surfaces.
    bool is_half_way() const { return is_half_way_; }

    /// The newest shape.
    const std::shared_ptr<const std::vector<MovingSurfel>>& shape() const { return shape_; }
    /// Remaining share of the shape's motion: 1 at its start, 0 at the captured positions.
    float share_to_go() const {
        return static_cast<float>(period_s_ > 0.0 ? time_to_go_s_ / period_s_ : 0.0);
    }
    Timestamp capture_time() const { return capture_time_; }

    const SurfelGrid& surfels() const { return grid_; }
    float max_speed_mps() const { return max_speed_mps_; }  // fastest surfel in this tick
    std::size_t num_surfels() const { return shape_ ? shape_->size() : 0; }

private:
    PeopleFieldOptions options_;
    std::shared_ptr<const std::vector<MovingSurfel>> shape_;
    Timestamp capture_time_;
    double period_s_ = 0.0;
    double time_to_go_s_ = 0.0;  // until the surfels reach the captured positions
    double tick_s_ = 0.0;
    bool is_half_way_ = false;
    bool is_placed_ = false;  // at rest and already in the grid
    float shape_max_mps_ = 0.0F;
    float max_speed_mps_ = 0.0F;
    SurfelGrid grid_;
};

template <typename Accept>
const PlacedSurfel* PersonField::nearest(const Eigen::Vector3f& point,
                                         float radius_m,
                                         const Accept& accept) const {
    for (float within_m = std::min(0.08F, radius_m);;
         within_m = std::min(2.0F * within_m, radius_m)) {
        const PlacedSurfel* best = nullptr;
        float best_sq = within_m * within_m;
        const Eigen::Vector3f reach = Eigen::Vector3f::Constant(within_m);
        grid_.visit_box(point - reach, point + reach, [&](const PlacedSurfel& s) {
            const float distance_sq = (s.position - point).squaredNorm();
            if (distance_sq >= best_sq || !accept(s)) return;
            best_sq = distance_sq;
            best = &s;
        });
        if (best != nullptr || within_m >= radius_m) return best;
    }
}

/// Holds the moving surfaces of all people in a world. Deterministic. Not thread-safe.
class PeopleField {
public:
    explicit PeopleField(const PeopleFieldOptions& options = {}) : options_(options) {}

    void set_person(const std::string& name, const PersonShape& shape);
    bool remove_person(const std::string& name);  // false if the name is unknown
    void begin_tick(double tick_s);

    /// Finds the surface of any person that is nearest to the point, or that the point is deepest
    /// inside. Empty if there is none within `PeopleFieldOptions::reach_m`. Ignores surfaces that
    /// the object leaves quickly. A thin hand that has swept past the point within a tick therefore
    /// still pushes forwards.
    std::optional<SurfacePoint> query(const Eigen::Vector3f& p_world,
                                      const SurfaceProbe& probe) const;

    const std::map<std::string, PersonField>& people() const { return people_; }

private:
    PeopleFieldOptions options_;
    std::map<std::string, PersonField> people_;
};

}  // namespace atrium::physics
