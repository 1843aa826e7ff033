#pragma once

#include "world_server/physics/person_shape.hpp"
#include "world_server/physics/surfel_grid.hpp"

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

/// What a person's surface is near a point; world frame.
struct SurfacePoint {
    float distance_m = 0.0F;   // along the normal, of the point that was asked for; < 0: inside
    Eigen::Vector3f normal;    // unit length, outwards
    Eigen::Vector3f velocity;  // [m/s] of the surface
};

/// Who asks for the surface at a point.
struct Asker {
    Eigen::Vector3f velocity = Eigen::Vector3f::Zero();  // [m/s] of what is at the point
    /// Unit length: out of the asker's surface there; zero: it faces nowhere.
    Eigen::Vector3f outwards = Eigen::Vector3f::Zero();

    /// Only surfaces that face the asker's count: what lies on a hand is not pushed down by the
    /// back of it, however thin it is and however deep the thing is inside.
    bool faces(const Eigen::Vector3f& normal) const {
        return outwards.isZero() || normal.dot(outwards) < kFacing;
    }
    /// In which octants normals can lie that face it.
    std::uint8_t facing_octants() const;

    static constexpr float kFacing = -0.25F;  // cosine
};

/// How far from a surface a point may be to be told of it.
inline constexpr float kFieldReachM = 0.04F;

/// One person as she is at the beginning of a tick.
class PersonField {
public:
    /// The newest shape takes the place of the one before. Copies nothing.
    void set_shape(const PersonShape& shape);
    /// Where the surfels are at the beginning of a tick of `tick_s`, and the velocities that carry
    /// them through it; time goes on by one tick.
    void begin_tick(double tick_s);

    /// Nothing within reach that the asker faces, or moving out of the person there: nullopt.
    std::optional<SurfacePoint> query(const Eigen::Vector3f& point, const Asker& asker) const;

    /// The nearest surfel within `radius_m` for which `accept(surfel)` holds; null: none. Slower
    /// than `query`, for what is deep inside.
    template <typename Accept>
    const PlacedSurfel* nearest(const Eigen::Vector3f& point,
                                float radius_m,
                                const Accept& accept) const;

    /// False: `query` would find nothing. Quick.
    bool may_find(const Eigen::Vector3f& point, const Asker& asker) const {
        return (grid_.octants_near(point) & asker.facing_octants()) != 0;
    }

    /// True in one tick of each mesh's way: the moment to compare it with others.
    bool is_half_way() const { return is_half_way_; }

    /// The newest shape, and how much of its way is still to go: 1 at its start, 0 where it was
    /// captured.
    const std::shared_ptr<const std::vector<MovingSurfel>>& shape() const { return shape_; }
    float share_to_go() const {
        return static_cast<float>(period_s_ > 0.0 ? time_to_go_s_ / period_s_ : 0.0);
    }
    Timestamp capture_time() const { return capture_time_; }

    const SurfelGrid& surfels() const { return grid_; }
    float max_speed_mps() const { return max_speed_mps_; }  // of the surfels, in this tick
    std::size_t num_surfels() const { return shape_ ? shape_->size() : 0; }

private:
    std::shared_ptr<const std::vector<MovingSurfel>> shape_;
    Timestamp capture_time_;
    double period_s_ = 0.0;
    double time_to_go_s_ = 0.0;  // until the surfels are where the mesh was captured
    double tick_s_ = 0.0;
    bool is_half_way_ = false;
    bool is_placed_ = false;  // nothing moves any more and the grid holds what there is
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

/// All people of a world as moving volumes. Deterministic; not thread-safe.
class PeopleField {
public:
    void set_person(const std::string& name, const PersonShape& shape);
    bool remove_person(const std::string& name);  // false: not there
    void begin_tick(double tick_s);

    /// The surface, of whichever person, that is nearest to the point or that the point is deepest
    /// inside of; nullopt: nothing within `kFieldReachM`. Surfaces that the asker moves out of
    /// quickly do not count, so that a thin hand that has swept past the point within a tick still
    /// pushes forwards.
    std::optional<SurfacePoint> query(const Eigen::Vector3f& p_world, const Asker& asker) const;

    const std::map<std::string, PersonField>& people() const { return people_; }

private:
    std::map<std::string, PersonField> people_;
};

}  // namespace atrium::physics
