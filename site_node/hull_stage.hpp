#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "site_node/hull/corner_rounding.hpp"
#include "site_node/hull/regions.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/refine/photo_refinement.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::site_node {

inline constexpr double kLitresPerM3 = 1000.0;

/// `[[hull.region]]`: a part of the site and the cameras that watch it.
struct RegionOptions {
    std::string name;
    geometry::Aabb bounds;             // site frame [m]
    std::vector<std::string> cameras;  // names; empty: all
    bool is_elsewhere = false;         // another host of the site computes it
};

/// `[hull]` of a site file.
struct HullStageOptions {
    std::optional<geometry::Aabb> bounds;  // where people can be, site frame [m]
    std::uint32_t min_views = 0;           // cameras that must see a point of the hull
    bool keep_phantoms = false;
    double min_component_l = 0.005;  // [l]
    /// What looks like the empty room in one camera is added to its silhouettes: CamouflageStage.
    bool find_camouflaged = true;
    /// "photo": the surface moves to where the pictures agree (PhotoRefinement); "round": corners
    /// move to where a smooth body would be (CornerRounding); "round_photo": first the corners,
    /// then the surface; "off": exact hull.
    std::string refine = "off";
    bool pause_refinement = true;  // from pictures, while the host is too slow: RefinementPause
    /// False: nobody is outside a picture, and its border cuts the hull. True: space outside the
    /// pictures is unknown; needs bounds, here or in the rig.
    bool partial_views = false;
    std::vector<std::string>
        whole_cameras;                   // with partial_views: names of cameras that see everybody
    std::vector<RegionOptions> regions;  // instead of `bounds`
    /// Place of each key in the file, for errors: "hull.region[0].cameras" -> "site.toml:7". If
    /// the command line may override the option, the key includes the value: "hull.min_views = 3".
    std::map<std::string, std::string> places;
};

/// Checks everything that does not depend on the cameras. Errors name the key, and its place if
/// known.
Expected<void> check(const HullStageOptions& options);

/// Whether the hull is refined by the cameras' pictures, which only their host has.
bool needs_pictures(const HullStageOptions& options);

/// The same where the same hulls come of the same contours and rig, on any host.
std::uint64_t fingerprint(const HullStageOptions& options);

/// Returns "a and b" for each pair of regions that share space: people there appear twice in the
/// mesh.
std::vector<std::string> overlapping_regions(std::span<const RegionOptions> regions);

/// Computes the visual hull of all cameras from their contours, and refines it. Any camera may be
/// missing in any metaframe.
class HullStage {
public:
    /// `tolerance_px` is the tolerance of the silhouettes. Errors: kConfiguration, with the key and
    /// the camera.
    static Expected<HullStage> create(std::span<const geometry::CalibratedCamera> cameras,
                                      const HullStageOptions& options,
                                      double tolerance_px);

    /// All cameras in the order of the rig, with the contours of the last metaframe of each.
    std::span<const hull::SilhouetteView> views() const { return views_; }

    /// Contours of one camera [undistorted px], to be filled in place. Threads may fill different
    /// cameras at the same time.
    std::vector<std::vector<Eigen::Vector2d>>& contours(std::size_t camera) {
        return views_[camera].contours;
    }

    /// Computes the hull from the cameras with `delivered[camera] != 0`; the others cut nothing
    /// away. Status kTooFewViews if fewer than two cameras, or fewer than `min_views`, delivered.
    /// With regions, a region with too few cameras is skipped and counted as failed.
    ///
    /// `pictures`, if it `uses_pictures`: one per camera, empty where there is none. Less than two
    /// move nothing.
    void compute(std::span<const std::uint8_t> delivered,
                 std::span<const refine::PictureView> pictures,
                 Executor& executor,
                 hull::VisualHull& hull);

    bool uses_pictures() const { return moves_to_pictures_; }

    /// While it is paused, pictures move nothing, and what they showed before is forgotten.
    void pause_pictures(bool is_paused) { is_paused_ = is_paused; }

    /// How long the refinement of the last hull took, part of `compute`; 0 if nothing was refined.
    double refinement_ms() const { return refinement_ms_; }

    const std::vector<hull::Region>& regions() const { return regions_; }

    /// Whether this host computes a hull.
    bool has_own() const {
        return regions_.empty() || !std::ranges::all_of(regions_, &hull::Region::is_elsewhere);
    }

    /// The parts of the last hull, in the order of the regions; empty without regions.
    std::span<const hull::VisualHull> region_hulls() const { return region_scratch_.parts; }

private:
    HullStage() = default;
    void compute_within_bounds(Executor& executor, hull::VisualHull& hull);
    void refine(hull::VisualHull& hull,
                std::span<const refine::PictureView> pictures,
                Executor& executor);
    void refine(geometry::TriangleMesh& mesh, refine::PhotoRefinement& photo, Executor& executor);
    void forget_surfaces();
    Expected<void> add_regions(std::span<const geometry::CalibratedCamera> cameras,
                               const HullStageOptions& options);
    Expected<void> add_fields(std::span<const geometry::CalibratedCamera> cameras,
                              const HullStageOptions& options,
                              double tolerance_px);

    hull::HullOptions options_;
    std::uint32_t min_delivered_ = 2;
    bool are_bounds_optional_ = false;         // the cameras alone limit the hull
    int num_bounded_left_ = 0;                 // metaframes until it is tried without bounds again
    std::vector<hull::SilhouetteView> views_;  // one per camera
    std::vector<hull::Region> regions_;
    std::vector<const hull::SilhouetteView*> pointers_;
    hull::HullScratch hull_scratch_;
    hull::RegionScratch region_scratch_;
    bool rounds_corners_ = false;
    bool moves_to_pictures_ = false;
    bool is_paused_ = false;
    double refinement_ms_ = 0.0;
    hull::CornerRounding rounding_;
    std::vector<refine::PhotoRefinement> photo_;  // per region, or one; each has its memory
    // of the mesh that is refined
    std::vector<const hull::SilhouetteView*> refined_views_;
    std::vector<refine::PictureView> refined_pictures_;
};

}  // namespace atrium::site_node
