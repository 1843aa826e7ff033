#include "site_node/remote_results.hpp"

#include "core/codec/mesh_codec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>

namespace atrium::site_node {

Expected<void> failure_without_mesh(const SiteFrame& frame, bool has_own) {
    if (!frame.draco.empty()) return {};
    const hull::HullStatus status = frame.hull.status;
    if (status != hull::HullStatus::kOk && status != hull::HullStatus::kEmptyIntersection)
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("no hull: {}", hull::to_string(status)));
    if (has_own) return {};
    std::string reasons;
    for (const bus::RegionMeshes& remote : frame.remote) {
        const bool is_empty = std::ranges::any_of(remote.regions, [](const bus::RegionHull& hull) {
            return hull.outcome == bus::RegionOutcome::kNobody;
        });
        if (is_empty) return {};
        if (!remote.reason.empty())
            reasons += fmt::format(
                "{}host {}: {}", reasons.empty() ? "" : "; ", remote.host, remote.reason);
    }
    if (!reasons.empty()) return make_error(ErrorKind::kInvalidData, "no hull: " + reasons);
    return {};
}

void add(const bus::RegionMeshes& remote, SiteFrame& frame) {
    const bus::LeftOutTotals& left_out = remote.left_out;
    frame.losses.phantoms += static_cast<std::uint32_t>(left_out.num_phantoms);
    frame.losses.fragments += static_cast<std::uint32_t>(left_out.num_fragments);
    frame.losses.dropped_l += left_out.dropped_l;
    frame.losses.contours_dropped += static_cast<std::uint32_t>(left_out.num_contours_dropped);
    frame.losses.contours_repaired += static_cast<std::uint32_t>(left_out.num_contours_repaired);
    frame.losses.regions_failed += static_cast<std::uint32_t>(left_out.num_regions_failed);
}

geometry::TriangleMesh whole_mesh(const SiteFrame& frame) {
    geometry::TriangleMesh whole = frame.hull.mesh;
    codec::MeshDecoder decoder;
    geometry::TriangleMesh part;
    for (const bus::RegionMeshes& remote : frame.remote) {
        std::span<const std::uint8_t> left(remote.draco);
        for (const bus::RegionHull& hull : remote.regions) {
            // a mesh that viewers cannot read either is left out
            if (decoder.decode(left.first(hull.num_bytes), {}, part)) geometry::append(whole, part);
            left = left.subspan(hull.num_bytes);
        }
    }
    return whole;
}

void name_remote_textures(const capture::Metaframe& metaframe, SiteFrame& frame) {
    for (const capture::CameraFrame& picture : metaframe.frames) {
        const capture::FoundSilhouette* found = picture.found.get();
        if (found == nullptr || !found->has_texture) continue;
        frame.remote_textures.push_back({static_cast<std::uint32_t>(picture.camera),
                                         found->texture_frame_id,
                                         found->texture_time,
                                         found->colour_bytes,
                                         found->mask_bytes});
    }
}

}  // namespace atrium::site_node
