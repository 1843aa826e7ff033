#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/codec/texture_codec.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/camouflage_stage.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/hosts/remote_regions.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/hull_stage.hpp"
#include "site_node/mesh_coding.hpp"
#include "site_node/rig_check/rig_watch.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"
#include "site_node/texture/texture.hpp"
#include "site_node/texture_stage.hpp"
#include "site_node/views/named_view.hpp"

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {

struct PipelineOptions : SilhouetteStageOptions {
    HullStageOptions hull;
    /// With position_bits 0, codec::position_bits_for chooses them.
    codec::MeshCodecOptions mesh{.position_bits = 0};
    texture::TextureOptions texture;
    int jpeg_quality = 86;  // chosen from the table in docs/measurements/codecs.md
};

/// A texture that a camera node publishes itself.
struct RemoteTexture {
    std::uint32_t camera = 0;
    std::uint64_t frame_id = 0;
    Timestamp capture_time;          // on the camera node's clock
    std::uint32_t colour_bytes = 0;  // of the camera's previous texture
    std::uint32_t mask_bytes = 0;
};

/// Counts the losses and repairs in the hull of one metaframe.
struct MetaframeLosses {
    std::uint32_t cameras = 0;           // without a picture
    std::uint32_t phantoms = 0;          // components that no silhouette needs
    std::uint32_t fragments = 0;         // components below hull.min_component_l
    double dropped_l = 0.0;              // volume of both [l]
    std::uint32_t contours_dropped = 0;  // too small, or impossible to undistort or repair
    std::uint32_t contours_repaired = 0;
    std::uint32_t regions_failed = 0;  // while others succeeded
};

/// One metaframe, ready to publish. Reusable: vectors keep their capacity.
struct SiteFrame {
    std::uint64_t frame_id = 0;
    Timestamp capture_time;
    std::vector<CodedCamera> cameras;  // cameras that see somebody; empty if nobody is there
    std::vector<RemoteTexture> remote_textures;  // of further such cameras
    std::vector<std::uint8_t> draco;             // empty: nobody is there
    std::vector<std::uint32_t> mesh_sizes;       // as in bus::SiteMesh
    hull::VisualHull hull;                       // of the regions that this host computes
    std::vector<bus::RegionMeshes> remote;       // regions that other hosts computed
    MetaframeLosses losses;
    std::uint64_t num_camouflaged_px = 0;  // added to silhouettes: CamouflageStage

    struct Milliseconds {
        double silhouettes = 0.0;  // segmentation and polygons of all cameras
        double hull = 0.0;
        double encode = 0.0;  // mesh and textures
        double total = 0.0;
    } milliseconds;

    /// Work of this host inside these stages, summed over the cameras. With enough workers the sum
    /// exceeds the duration of the stage.
    struct WorkMilliseconds {
        double segmentation = 0.0;  // includes the conversion of raw pictures
        double polygons = 0.0;
        double hull = 0.0;  // without its refinement
        double refinement = 0.0;
        double mesh = 0.0;
        double textures = 0.0;
        double waiting = 0.0;  // for hosts of regions
    } work_milliseconds;
};

/// Turns the pictures of one metaframe into a coded mesh and textures, in two stages: the
/// silhouettes of all cameras, then hull and coding. Of frames that come as `FoundSilhouette` it
/// uses the contours; their camera nodes code the textures. Creates no threads.
class Pipeline {
public:
    /// Data that the first stage hands to the second for one metaframe. Reusable: keeps its memory.
    /// Holds the pictures until its next use or `release`.
    class Silhouettes {
    public:
        Silhouettes();
        Silhouettes(Silhouettes&&) noexcept;
        Silhouettes& operator=(Silhouettes&&) noexcept;
        ~Silhouettes();

        const capture::Metaframe& metaframe() const { return metaframe_; }
        /// Releases the pictures, whose memory cameras may need for the next ones.
        void release() { metaframe_.frames.clear(); }

        /// Returns the silhouettes of one camera as polygons in the delivered picture [px].
        std::vector<std::vector<Eigen::Vector2d>> delivered_outlines(std::size_t camera) const;

    private:
        friend class Pipeline;
        struct Camera;
        capture::Metaframe metaframe_;
        std::vector<std::unique_ptr<Camera>> cameras_;
        std::vector<std::uint8_t> delivered_;  // per camera
        double milliseconds_ = 0.0;
        double camouflage_ms_ = 0.0;  // part of it
        std::uint64_t num_camouflaged_px_ = 0;
    };

    /// Loads or learns the background of each camera, unless the frames of `source` carry
    /// silhouettes. A camera that cannot show the empty room now (kUnavailable) is excluded from
    /// all metaframes. Error kUnavailable once `stop` is requested.
    static Expected<Pipeline> create(capture::FrameSource& source,
                                     const PipelineOptions& options,
                                     std::stop_token stop);

    /// Names of the excluded cameras.
    std::vector<std::string> cameras_without_background() const;

    /// Counts the answers of the segmentation worker; null if none is used.
    segmentation_worker::WorkerTally* worker() const { return worker_.get(); }

    /// The empty room of a camera as it was learned; null if there is none. Valid as long as this.
    const segmentation::BackgroundStatistics* room(std::size_t camera) const;

    /// Whether the room of a camera was learned from pictures with people in it.
    bool had_people() const;

    Pipeline(Pipeline&&) noexcept;
    Pipeline& operator=(Pipeline&&) noexcept;
    ~Pipeline();

    /// Who computes the regions that are elsewhere. Must outlive the pipeline.
    void set_remote_regions(hosts::RemoteRegions* remote) { remote_ = remote; }

    /// Whether pictures refine the hull, unless that is paused.
    bool refines_by_pictures() const { return hull_.uses_pictures(); }
    /// From the next `compute` on; not during one.
    void pause_refinement(bool is_paused) { hull_.pause_pictures(is_paused); }

    /// First stage. Ignores cameras that the metaframe lacks. Takes metaframes in their order, one
    /// at a time. After an error `out` is unspecified but reusable.
    Expected<void> find_silhouettes(const capture::Metaframe& metaframe,
                                    Executor& executor,
                                    Silhouettes& out);

    /// Second stage. Takes one metaframe at a time, in any order, and may run while the first stage
    /// works on other `Silhouettes`. After an error, for example too few cameras, `frame` is
    /// unspecified.
    Expected<void> compute(Silhouettes& silhouettes,
                           const ColourCoding& coding,
                           Executor& executor,
                           SiteFrame& frame);

    /// Copies the contours of the cameras that delivered: after `compute`, before the next.
    std::vector<views::NamedView> views(const Silhouettes& silhouettes) const;

    /// Copies what a check of the rig needs of a metaframe: after `compute`, before the next.
    rig_check::Look look(const Silhouettes& silhouettes, const SiteFrame& frame) const;

    /// Runs both stages, with the colour coding of the options. Must not overlap with either stage.
    Expected<void> process(const capture::Metaframe& metaframe,
                           Executor& executor,
                           SiteFrame& frame);

private:
    struct CameraStage;
    Pipeline(std::vector<geometry::CalibratedCamera> cameras,
             const PipelineOptions& options,
             HullStage hull);
    Expected<void> encode_texture(Silhouettes& silhouettes,
                                  const ColourCoding& coding,
                                  std::size_t camera,
                                  CodedCamera& coded);
    void add_camouflaged(Executor& executor, Silhouettes& out);
    std::span<const refine::PictureView> pictures_of(const Silhouettes& silhouettes);
    Expected<void> encode(Silhouettes& silhouettes,
                          const ColourCoding& coding,
                          Executor& executor,
                          SiteFrame& frame);
    const geometry::TriangleMesh& mesh_of(const SiteFrame& frame, std::size_t index) const;
    void join_meshes(SiteFrame& frame);
    Expected<void> first_failure(const Silhouettes& silhouettes) const;
    static void sum_up(const Silhouettes& silhouettes, SiteFrame& frame);

    std::vector<geometry::CalibratedCamera> cameras_;
    PipelineOptions options_;
    std::vector<std::unique_ptr<CameraStage>> stages_;  // one per camera
    std::optional<CamouflageStage> camouflage_;
    std::vector<CamouflageStage::Camera> camouflage_cameras_;
    HullStage hull_;
    std::shared_ptr<segmentation_worker::WorkerTally> worker_;
    std::vector<refine::PictureView> pictures_;  // per camera
    hosts::RemoteRegions* remote_ = nullptr;
    MeshCoding meshes_;                     // one of each region, or one
    std::vector<CodedCamera> spare_coded_;  // memory for cameras that see somebody again
    Silhouettes own_silhouettes_;           // used by `process`
};

}  // namespace atrium::site_node
