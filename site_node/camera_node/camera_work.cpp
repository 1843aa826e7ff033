#include "site_node/camera_node/camera_work.hpp"

#include <chrono>
#include <tuple>
#include <utility>

namespace atrium::camera_node {

CameraWork::CameraWork(std::string site,
                       std::string host,
                       std::uint32_t camera,
                       std::uint64_t rig,
                       std::optional<site_node::SilhouetteStage> stage,
                       const texture::TextureOptions& options,
                       Writers writers)
    : stage_(std::move(stage)), options_(options), writers_(std::move(writers)) {
    message_.site = std::move(site);
    message_.host = std::move(host);
    message_.camera = camera;
    message_.rig = rig;
}

Expected<std::size_t> CameraWork::process(capture::CameraFrame& frame,
                                          std::uint64_t clock_epoch,
                                          const bus::SiteOrders& orders,
                                          const std::function<void(std::size_t)>& on_silhouette) {
    const bool is_lost = frame.is_lost() || !stage_;
    const auto found = is_lost ? Expected<void>() : stage_->find(frame, {}, seen_);
    if (is_lost || !found) {
        const auto lost = publish_lost(frame.capture_time, clock_epoch);
        if (!found) return tl::unexpected(found.error());
        if (!lost) return tl::unexpected(lost.error());
        return std::size_t{0};
    }
    ++message_.frame_id;
    message_.capture_time = frame.capture_time;
    const auto silhouette =
        publish_silhouette(clock_epoch, bus::is_texture_wanted(orders, frame.capture_time));
    if (!silhouette) {
        // for example too many contours: nobody needs to wait for it
        std::ignore = publish_lost(frame.capture_time, clock_epoch);
        return tl::unexpected(silhouette.error());
    }
    on_silhouette(*silhouette);
    std::size_t num_texture_bytes = 0;
    if (message_.has_texture) {
        const auto texture = publish_texture(
            {static_cast<int>(orders.jpeg_quality), static_cast<int>(orders.colour_divisor)});
        if (!texture) return tl::unexpected(texture.error());
        num_texture_bytes = *texture;
    }
    frame.image = {};  // its memory may be a camera's
    return num_texture_bytes;
}

Expected<std::size_t> CameraWork::publish_lost(Timestamp capture_time, std::uint64_t clock_epoch) {
    bus::CameraSilhouette lost;
    lost.site = message_.site;
    lost.host = message_.host;
    lost.camera = message_.camera;
    lost.rig = message_.rig;
    lost.capture_time = capture_time;
    lost.clock_epoch = clock_epoch;
    return writers_.silhouettes.write(lost);
}

Expected<std::size_t> CameraWork::publish_silhouette(std::uint64_t clock_epoch,
                                                     bool is_texture_wanted) {
    message_.clock_epoch = clock_epoch;
    message_.has_picture = true;
    message_.has_texture = is_texture_wanted && !seen_.contours.empty() && !seen_.subject.empty();
    message_.is_view_shifted = seen_.view_shift_px.has_value();
    if (seen_.view_shift_px)
        message_.view_shift_px = {seen_.view_shift_px->x(), seen_.view_shift_px->y()};
    message_.num_contours_dropped = seen_.counts.num_not_undistorted + seen_.counts.num_not_simple;
    message_.segmentation_ms = seen_.segmentation_ms;
    message_.polygons_ms = seen_.polygons_ms;
    message_.contour_sizes.clear();
    message_.vertices_px.clear();
    for (const auto& contour : seen_.contours) {
        message_.contour_sizes.push_back(static_cast<std::uint32_t>(contour.size()));
        for (const Eigen::Vector2d& vertex : contour)
            message_.vertices_px.push_back({vertex.x(), vertex.y()});
    }
    return writers_.silhouettes.write(message_);
}

Expected<std::size_t> CameraWork::publish_texture(const site_node::ColourCoding& coding) {
    const auto begin = std::chrono::steady_clock::now();
    const auto encoded = textures_.encode(seen_, options_, coding, coded_);
    if (!encoded) return tl::unexpected(encoded.error());
    if (!*encoded)
        return make_error(ErrorKind::kInternal, "a picture with a silhouette has no texture");
    bus::CameraTexture texture{message_.site,
                               message_.camera,
                               message_.frame_id,
                               message_.capture_time,
                               coded_.crop_px,
                               std::move(coded_.texture.colour),
                               std::move(coded_.texture.mask)};
    message_.texture_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    message_.colour_bytes = static_cast<std::uint32_t>(texture.colour.size());
    message_.mask_bytes = static_cast<std::uint32_t>(texture.mask.size());
    const auto written = writers_.textures.write(texture);
    coded_.texture = {std::move(texture.colour), std::move(texture.mask)};
    return written;
}

}  // namespace atrium::camera_node
