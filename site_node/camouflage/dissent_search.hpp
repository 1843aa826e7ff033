#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/aabb.hpp"
#include "site_node/camouflage/camera_eye.hpp"
#include "site_node/camouflage/camera_view.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::camouflage {

struct DissentSearchOptions {
    float voxel_m = 0.04F;          // space is searched so finely
    std::size_t fewest_others = 5;  // cameras that must see a person
    std::size_t num_turns = 4;      // instants in which all space is searched once
};

/// A place where one camera alone shows nobody.
struct Dissent {
    Eigen::Vector3f point_site = Eigen::Vector3f::Zero();
    std::size_t camera = 0;
};

/// Searches space for places where all cameras but one show a person. Cameras that do not see a
/// place do not count there. At the first instant it searches everywhere, then a part at each: what
/// was found elsewhere stays until its turn.
///
/// Deterministic, for any number of workers. Keeps its memory. Not thread-safe.
class DissentSearch {
public:
    /// Whether the bounds are small enough, up to 200 m3 with these voxels.
    static bool can_search(const geometry::Aabb& bounds_site,
                           const DissentSearchOptions& options = {});

    /// Within bounds that it `can_search`.
    explicit DissentSearch(const geometry::Aabb& bounds_site,
                           const DissentSearchOptions& options = {});

    /// One view per camera, at most 64, of successive instants.
    void find(std::span<const CameraView> views,
              std::span<const CameraEye> eyes,
              Executor& executor);

    std::span<const Dissent> found() const { return found_; }

private:
    // Squares of a picture that show a person somewhere.
    struct Tiles {
        int columns = 0;
        std::vector<std::uint8_t> has_person;
    };
    static void note_people(const CameraView& view, Tiles& tiles);
    static bool shows_nobody(const Tiles& tiles,
                             const CameraEye& eye,
                             const Eigen::Vector2f& px,
                             float radius_px);
    void search_cell(std::span<const CameraView> views,
                     std::span<const CameraEye> eyes,
                     const Eigen::Vector3f& low,
                     std::vector<Dissent>& found) const;

    DissentSearchOptions options_;
    std::vector<Eigen::Vector3f> cells_;          // their low corners
    std::vector<Tiles> tiles_;                    // per camera
    std::vector<std::vector<Dissent>> found_in_;  // per chunk of cells
    std::vector<Dissent> found_;
    std::size_t turn_ = 0;
};

}  // namespace atrium::camouflage
