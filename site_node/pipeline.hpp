#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/codec/texture_codec.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/backgrounds.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/hull_stage.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/texture/texture.hpp"

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {

struct PipelineOptions {
    segmentation::SegmentationOptions segmentation;
    BackgroundOptions background;
    std::vector<CameraAreas> areas;
    silhouette::SilhouetteOptions silhouette;
    HullStageOptions hull;
    /// With 0 position_bits, those of codec::position_bits_for.
    codec::MeshCodecOptions mesh{.position_bits = 0};
    texture::TextureOptions texture;
    int jpeg_quality = 86;  // docs/streams.md has the table from which it is taken
};

/// How the colours of one metaframe are coded.
struct ColourCoding {
    int jpeg_quality = 86;
    int divisor = 1;  // 1: as large as the mask; 2: half as wide and high
};

/// What one camera adds to a frame.
struct CodedCamera {
    std::uint32_t camera = 0;
    image::PixelRect crop_px;
    codec::CodedTexture texture;
};

/// What was left out of the hull of one metaframe, or mended in it.
struct LeftOut {
    std::uint32_t cameras = 0;           // that delivered nothing
    std::uint32_t phantoms = 0;          // components that no silhouette needs
    std::uint32_t fragments = 0;         // components below hull.min_component_l
    double dropped_l = 0.0;              // volume of both [l]
    std::uint32_t contours_dropped = 0;  // too small, or could neither be undistorted nor mended
    std::uint32_t contours_repaired = 0;
    std::uint32_t regions_failed = 0;  // beside others that did not
};

/// One metaframe, ready to be published. Reused: vectors keep their capacity.
struct SiteFrame {
    std::uint64_t frame_id = 0;
    Timestamp capture_time;
    std::vector<CodedCamera> cameras;  // those that see somebody; none where nobody is there
    std::vector<std::uint8_t> draco;   // empty: nobody is there
    hull::VisualHull hull;
    LeftOut left_out;

    struct Milliseconds {
        double silhouettes = 0.0;  // segmentation and polygons of all cameras
        double hull = 0.0;
        double encode = 0.0;  // mesh and textures
        double total = 0.0;
    } milliseconds;

    /// What the parts of those stages took, summed over the cameras: as long as there are workers
    /// enough, more than the stage itself.
    struct WorkMilliseconds {
        double segmentation = 0.0;  // with the conversion of raw pictures
        double polygons = 0.0;
        double mesh = 0.0;
        double textures = 0.0;
    } work_milliseconds;
};

/// From the pictures of one instant to the coded mesh and textures. No network, no threads of its
/// own.
class Pipeline {
public:
    /// Learns the empty room from `source`, or takes it as learned before, unless its frames carry
    /// silhouettes. A camera that cannot show it now (kUnavailable) is left out from then on. Error
    /// kUnavailable once `stop` is requested.
    static Expected<Pipeline> create(capture::FrameSource& source,
                                     const PipelineOptions& options,
                                     std::stop_token stop);

    /// Names of those that are left out.
    std::vector<std::string> cameras_without_background() const;

    Pipeline(Pipeline&&) noexcept;
    Pipeline& operator=(Pipeline&&) noexcept;
    ~Pipeline();

    /// Cameras that the metaframe lacks are left out of hull and textures. Not thread-safe;
    /// `executor` is lent for the call. An error leaves `frame` unspecified; too few cameras are
    /// one.
    Expected<void> process(const capture::Metaframe& metaframe,
                           Executor& executor,
                           SiteFrame& frame);
    /// The same, with colours coded in another way than the options say.
    Expected<void> process(const capture::Metaframe& metaframe,
                           const ColourCoding& coding,
                           Executor& executor,
                           SiteFrame& frame);

    /// Silhouettes of one camera in the metaframe that was processed last, as polygons in the
    /// delivered picture [px]. Not to be called while `process` runs.
    std::vector<std::vector<Eigen::Vector2d>> delivered_outlines(std::size_t camera) const;

private:
    struct CameraStage;
    Pipeline(std::vector<geometry::CalibratedCamera> cameras,
             const PipelineOptions& options,
             HullStage hull);
    Expected<void> find_silhouette(const capture::CameraFrame& frame, CameraStage& stage);
    Expected<void> find_silhouettes(const capture::Metaframe& metaframe, Executor& executor);
    Expected<void> encode_texture(std::size_t camera, CodedCamera& coded);
    Expected<void> encode(Executor& executor, SiteFrame& frame);
    Expected<void> first_failure() const;
    void sum_up(SiteFrame& frame) const;

    std::vector<geometry::CalibratedCamera> cameras_;
    PipelineOptions options_;
    std::vector<std::unique_ptr<CameraStage>> stages_;  // one per camera
    std::vector<std::uint8_t> delivered_;               // per camera
    ColourCoding coding_;                               // of the metaframe that is worked on
    HullStage hull_;
    codec::MeshEncoder mesh_encoder_;
    std::vector<CodedCamera> spare_coded_;  // memory for cameras that see somebody again
};

}  // namespace atrium::site_node
