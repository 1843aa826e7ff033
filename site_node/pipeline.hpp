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

/// From the pictures of one instant to the coded mesh and textures, in two stages: silhouettes of
/// all cameras, then hull and coding. No network, no threads of its own.
class Pipeline {
public:
    /// What the first stage hands to the second: everything that belongs to one metaframe. Reused:
    /// memory is kept. Holds the pictures until it is used again or `release`d.
    class Silhouettes {
    public:
        Silhouettes();
        Silhouettes(Silhouettes&&) noexcept;
        Silhouettes& operator=(Silhouettes&&) noexcept;
        ~Silhouettes();

        const capture::Metaframe& metaframe() const { return metaframe_; }
        /// Lets the pictures go, which cameras may need for the next ones.
        void release() { metaframe_.frames.clear(); }

        /// Silhouettes of one camera as polygons in the delivered picture [px].
        std::vector<std::vector<Eigen::Vector2d>> delivered_outlines(std::size_t camera) const;

    private:
        friend class Pipeline;
        struct Camera;
        capture::Metaframe metaframe_;
        std::vector<std::unique_ptr<Camera>> cameras_;
        std::vector<std::uint8_t> delivered_;  // per camera
        double milliseconds_ = 0.0;
    };

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

    /// First stage. Cameras that the metaframe lacks are left out. Metaframes in their order, one
    /// at a time; `executor` is lent for the call. An error leaves `out` unspecified but usable
    /// again.
    Expected<void> find_silhouettes(const capture::Metaframe& metaframe,
                                    Executor& executor,
                                    Silhouettes& out);

    /// Second stage, one at a time, in any order. May run while the first stage works on other
    /// `Silhouettes`. An error leaves `frame` unspecified; too few cameras are one.
    Expected<void> compute(Silhouettes& silhouettes,
                           const ColourCoding& coding,
                           Executor& executor,
                           SiteFrame& frame);

    /// Both stages, with colours coded as the options say. Not while one of the stages runs.
    Expected<void> process(const capture::Metaframe& metaframe,
                           Executor& executor,
                           SiteFrame& frame);

private:
    struct CameraStage;
    Pipeline(std::vector<geometry::CalibratedCamera> cameras,
             const PipelineOptions& options,
             HullStage hull);
    Expected<void> find_silhouette(const capture::CameraFrame& frame,
                                   const GiveWay& give_way,
                                   Silhouettes::Camera& out);
    Expected<void> encode_texture(Silhouettes& silhouettes,
                                  const ColourCoding& coding,
                                  std::size_t camera,
                                  CodedCamera& coded);
    Expected<void> encode(Silhouettes& silhouettes,
                          const ColourCoding& coding,
                          Executor& executor,
                          SiteFrame& frame);
    Expected<void> first_failure(const Silhouettes& silhouettes) const;
    static void sum_up(const Silhouettes& silhouettes, SiteFrame& frame);

    std::vector<geometry::CalibratedCamera> cameras_;
    PipelineOptions options_;
    std::vector<std::unique_ptr<CameraStage>> stages_;  // one per camera
    HullStage hull_;
    codec::MeshEncoder mesh_encoder_;
    std::vector<CodedCamera> spare_coded_;  // memory for cameras that see somebody again
    Silhouettes own_silhouettes_;           // of `process`
};

}  // namespace atrium::site_node
