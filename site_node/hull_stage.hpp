#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "site_node/hull/regions.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::site_node {

inline constexpr double kLitresPerM3 = 1000.0;

/// A part of the site with the cameras that watch it: `[[hull.region]]`.
struct RegionOptions {
    std::string name;
    geometry::Aabb bounds;             // site frame [m]
    std::vector<std::string> cameras;  // names; empty: all
};

/// `[hull]` of a site file.
struct HullStageOptions {
    std::optional<geometry::Aabb> bounds;  // where people can be, site frame [m]
    std::uint32_t min_views = 0;           // at least this many cameras see a point of the hull
    bool keep_phantoms = false;
    double min_component_l = 0.005;  // [l]
    /// False: nobody is outside of a picture, so that its border cuts. True: what lies outside is
    /// unknown; needs bounds.
    bool partial_views = false;
    std::vector<std::string> whole_cameras;  // names of those that see everybody all the same
    std::vector<RegionOptions> regions;      // instead of `bounds`
    /// For errors: "site.toml:7" of a key of the file, for example "hull.region[0].cameras". Of an
    /// option that the command line may change, the key is "hull.min_views = 3".
    std::map<std::string, std::string> places;
};

/// What can be said without knowing the cameras. Errors name the key, and its place if it has one.
Expected<void> check(const HullStageOptions& options);

/// "a and b" for each two regions that share space: who stands there is in the mesh twice.
std::vector<std::string> overlapping_regions(std::span<const RegionOptions> regions);

/// From the contours of all cameras to the hull. Cameras may be missing in any instant.
class HullStage {
public:
    /// `tolerance_px` is that of the silhouettes. Errors: kConfiguration, naming the key and the
    /// camera.
    static Expected<HullStage> create(std::span<const geometry::CalibratedCamera> cameras,
                                      const HullStageOptions& options,
                                      double tolerance_px);

    /// Of one camera, in undistorted pixels, to be filled in place. Different cameras may be
    /// filled at the same time.
    std::vector<std::vector<Eigen::Vector2d>>& contours(std::size_t camera) {
        return views_[camera].contours;
    }

    /// The hull from the cameras with `delivered[camera] != 0`; the others cut nothing away. Status
    /// kTooFewViews where less than two, or less than `min_views`, delivered. A region to which
    /// that happens is left out and counted as failed.
    void compute(std::span<const std::uint8_t> delivered,
                 Executor& executor,
                 hull::VisualHull& hull);

private:
    HullStage() = default;
    Expected<void> add_regions(std::span<const geometry::CalibratedCamera> cameras,
                               const HullStageOptions& options);
    Expected<void> add_fields(std::span<const geometry::CalibratedCamera> cameras,
                              const HullStageOptions& options,
                              double tolerance_px);

    hull::HullOptions options_;
    std::uint32_t min_delivered_ = 2;
    std::vector<hull::SilhouetteView> views_;  // one per camera
    std::vector<hull::Region> regions_;
    std::vector<const hull::SilhouetteView*> pointers_;
    hull::HullScratch hull_scratch_;
    hull::RegionScratch region_scratch_;
};

}  // namespace atrium::site_node
