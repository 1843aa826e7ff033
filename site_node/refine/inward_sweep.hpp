#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/axes.hpp"
#include "core/image/inverse_depth.hpp"
#include "site_node/refine/luma_picture.hpp"
#include "site_node/refine/outline_bins.hpp"
#include "site_node/refine/patch_scores.hpp"
#include "site_node/refine/phantom_parts.hpp"
#include "site_node/refine/smooth_depths.hpp"
#include "site_node/refine/surfels.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::refine {

struct InwardSweepOptions {
    SurfelOptions surfels;
    float most_depth_m = 0.1F;        // how far the surface may move inwards
    float sample_spacing_m = 0.007F;  // of a patch, on the surface
    float least_cosine = 0.35F;  // between the normal and the direction to a camera that counts

    // A depth is accepted if its score is at least `least_score`, and by `least_lead` better than
    // all that are `least_steps_apart` or more away.
    float least_score = 0.6F;
    float least_lead = 0.05F;
    std::size_t least_steps_apart = 3;

    PhantomPartsOptions phantoms;
    SmoothDepthsOptions smooth;
    double outline_bin_px = 8.0;  // in each such part of an outline the person touches the hull
};

/// How far the surface of a person lies below the visual hull, from the pictures: where the hull is
/// the person's surface, the cameras show the same there.
///
/// Surfels of the hull are swept inwards along their normals. At every second step, those between
/// for every second surfel, a small patch is compared in up to three unoccluded cameras that face
/// it most (score_depths). A clear and single best step is accepted, judged together with the
/// neighbours. All others follow from a smooth solution over the surface, in which outliers lose
/// their weight (SmoothDepths).
///
/// The silhouettes hold the surface: behind each point of an outline the person touches its viewing
/// ray somewhere (Furukawa, Ponce, "Carved Visual Hulls for Image-Based Modeling", 2006, "rims").
/// Of the surfels along it, the one that lies least deep is held on the hull. We choose it from the
/// solution before, three times, instead of by dynamic programming along the outlines.
///
/// Where the hull's surface has barely moved, the depths of the mesh before count, too: noise and
/// chance make the surface flicker otherwise, and what the cameras have just seen is not forgotten.
/// Of the surfels there, half are swept, in turns.
///
/// Parts that no silhouette needs, and of which the cameras show different things (PhantomParts),
/// do not hold the surface. `move_at` says how surely a point belongs to one.
///
/// Deterministic, for any number of workers. Keeps its memory. Not thread-safe.
class InwardSweep {
public:
    /// Over `most_depth_m`, evenly.
    static constexpr std::size_t kNumSteps = 16;

    explicit InwardSweep(const InwardSweepOptions& options = {})
        : options_(options), phantom_parts_(options.phantoms) {}

    struct Counts {
        std::size_t num_surfels = 0;
        std::size_t num_swept = 0;     // with a score of its own or of a neighbour
        std::size_t num_accepted = 0;  // with a clear best step
        std::size_t num_held = 0;      // on the hull, by an outline
        double mean_depth_m = 0.0;
    };

    /// Finds the depths below `mesh`, the visual hull of `views` or some components of it. Views
    /// without a picture only hold the surface. The mesh before should be that of the metaframe
    /// before.
    void find(const geometry::TriangleMesh& mesh,
              std::span<const PictureView> views,
              Executor& executor);

    /// Forgets the mesh before.
    void forget();

    struct Move {
        Eigen::Vector3f by_m = Eigen::Vector3f::Zero();
        float phantom = 0.0F;  // how surely it belongs to a part that nobody has: 0 to 1
    };
    /// How a point of the hull moves; `normal` is that of the surface there.
    Move move_at(const Eigen::Vector3f& point_site,
                 const Eigen::Vector3f& normal,
                 NearScratch& scratch) const;

    const Surfels& surfels() const { return surfels_; }
    float depth_m(std::size_t surfel) const { return smooth_.depths_m[surfel]; }
    const Counts& counts() const { return counts_; }

private:
    // A camera's view of the surfels.
    struct Camera {
        Eigen::Vector3f place_of(const Eigen::Vector3f& point_site) const;

        LumaPicture luma;
        LumaScratch luma_scratch;
        Eigen::Matrix3f px_from_site = Eigen::Matrix3f::Zero();  // homogeneous, without distortion
        Eigen::Vector3f offset = Eigen::Vector3f::Zero();        // likewise
        image::InverseDepthPicture inverse_depth;                // of the mesh
        std::vector<Eigen::Vector4f> corners;                    // vertices in it
        image::Axes points;                                      // vertices
    };
    void look(const geometry::TriangleMesh& mesh,
              std::span<const PictureView> views,
              Executor& executor);
    using Seers = std::array<std::size_t, kMostPaths>;  // views
    std::size_t seers_of(std::size_t surfel,
                         std::span<const PictureView> views,
                         Seers& seers) const;
    std::size_t paths_of(std::size_t surfel,
                         std::span<const PictureView> views,
                         std::array<PatchPath, kMostPaths>& paths) const;
    float clash_of(std::size_t surfel, std::span<const PictureView> views) const;
    void find_phantoms(std::span<const PictureView> views, Executor& executor);
    void sweep(std::span<const PictureView> views, Executor& executor);
    void share_scores(Executor& executor);
    void accept();
    void recall(Executor& executor);
    void hold();
    float* scores(std::size_t surfel) { return scores_.data() + surfel * kNumSteps; }

    InwardSweepOptions options_;
    Surfels surfels_;
    Surfels earlier_surfels_;
    std::vector<float> earlier_depths_m_;
    std::vector<float> earlier_phantoms_;
    std::size_t turn_ = 0;
    std::vector<NearScratch> near_;              // per worker
    std::vector<Eigen::Vector3d> centres_site_;  // per view
    std::vector<Eigen::Matrix3d> rotations_;     // per view: camera_from_site
    std::vector<Camera> cameras_;
    std::vector<float> scores_;         // per surfel and step
    std::vector<float> shared_scores_;  // the same, with those of the neighbours
    PhantomParts phantom_parts_;
    std::vector<float> clashes_;   // of parts that no silhouette needs
    std::vector<float> phantoms_;  // per surfel: 0 to 1
    SmoothDepths smooth_;
    std::vector<double> bins_px_;            // per view
    std::vector<OutlinePoint> on_outlines_;  // surfels, by their parts of outlines
    Counts counts_;
};

}  // namespace atrium::refine
