#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "site_node/camouflage/camouflaged_parts.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/hull_stage.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace atrium::site_node {

/// Adds to the silhouettes of an instant what looks like the empty room in one camera but is part
/// of a person for all others (CamouflagedParts). Keeps its memory. Not thread-safe.
class CamouflageStage {
public:
    /// Nullopt if it is off (HullStageOptions::find_camouflaged) or cannot work: nobody knows where
    /// people can be, that is more than 200 m3, or there are too few cameras.
    static std::optional<CamouflageStage> create(
        std::span<const geometry::CalibratedCamera> cameras, const HullStageOptions& options);

    /// A camera's silhouette of this instant, and what found it.
    struct Camera {
        SilhouetteStage* stage = nullptr;  // null: the camera does not count
        PictureSilhouette* silhouette = nullptr;
    };
    /// One camera per frame of the metaframe. Silhouettes that grow have new contours.
    void add(const capture::Metaframe& metaframe,
             std::span<const Camera> cameras,
             Executor& executor);

    /// Pixels that the last `add` added, and its time.
    std::uint64_t num_pixels() const { return num_pixels_; }
    double milliseconds() const { return milliseconds_; }

private:
    explicit CamouflageStage(camouflage::CamouflagedParts parts) : parts_(std::move(parts)) {}

    camouflage::CamouflagedParts parts_;
    std::vector<camouflage::CameraView> views_;
    std::vector<std::uint64_t> pixels_;  // per camera
    std::vector<std::size_t> changed_;   // cameras
    std::uint64_t num_pixels_ = 0;
    double milliseconds_ = 0.0;
};

}  // namespace atrium::site_node
