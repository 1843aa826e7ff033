#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/messages.hpp"
#include "site_node/capture/metaframe.hpp"
#include "site_node/texture_stage.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace atrium::camera_node {

/// The work on the pictures of one camera: silhouette, then texture. Publishes both. Not
/// thread-safe; cameras are independent.
class CameraWork {
public:
    struct Writers {
        bus::Writer<bus::CameraSilhouette> silhouettes;
        bus::Writer<bus::CameraTexture> textures;
    };

    /// `camera`: index in the rig of the site. Without `stage` all its pictures count as lost.
    /// `rig`: hosts::part_fingerprint.
    CameraWork(std::string site,
               std::string host,
               std::uint32_t camera,
               std::uint64_t rig,
               std::optional<site_node::SilhouetteStage> stage,
               const texture::TextureOptions& options,
               Writers writers);

    /// Publishes what is in the picture; of a lost picture, that it is lost. `on_silhouette` gets
    /// the bytes of a silhouette that is out, before the texture. Returns the bytes of the texture;
    /// 0: nobody is there. Afterwards `frame` has no picture.
    Expected<std::size_t> process(capture::CameraFrame& frame,
                                  std::uint64_t clock_epoch,
                                  const bus::SiteOrders& orders,
                                  const std::function<void(std::size_t)>& on_silhouette);

    /// What was found in the last picture.
    const site_node::PictureSilhouette& seen() const { return seen_; }

    /// Publishes that the picture of this time is lost.
    Expected<std::size_t> publish_lost(Timestamp capture_time, std::uint64_t clock_epoch);

private:
    Expected<std::size_t> publish_silhouette(std::uint64_t clock_epoch, bool is_texture_wanted);
    Expected<std::size_t> publish_texture(const site_node::ColourCoding& coding);

    std::optional<site_node::SilhouetteStage> stage_;
    site_node::TextureStage textures_;
    texture::TextureOptions options_;
    Writers writers_;
    site_node::PictureSilhouette seen_;
    site_node::CodedCamera coded_;
    bus::CameraSilhouette message_;
};

}  // namespace atrium::camera_node
