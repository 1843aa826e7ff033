#pragma once

#include "core/bus/field_visitor.hpp"
#include "core/bus/status_fields.hpp"

/// Lists the fields of the messages between the hosts of a site, like fields.hpp, which includes
/// it. Private to core/bus and its tests.
namespace atrium::bus {

// hosts.idl

void fields(auto& v, Of<CameraSilhouette> auto& m, auto& w) {
    v.key("CameraSilhouette.site", m.site, w.site, Text::kName);
    v.key("CameraSilhouette.camera", m.camera, w.camera, Range{0, kMaxCamerasPerSite - 1});
    v("CameraSilhouette.host", m.host, w.host, Text::kName);
    v(m.frame_id, w.frame_id);
    v("CameraSilhouette.capture_time", m.capture_time, w.capture_time_ns);
    v(m.clock_epoch, w.clock_epoch);
    v(m.rig, w.rig);
    v("CameraSilhouette.has_picture", m.has_picture, w.has_picture);
    v("CameraSilhouette.has_texture", m.has_texture, w.has_texture);
    v("CameraSilhouette.is_view_shifted", m.is_view_shifted, w.is_view_shifted);
    const Range shift = within(kMaxImageSide_px);
    v("CameraSilhouette.view_shift_px", m.view_shift_px, w.view_shift_px, shift);
    v(m.num_contours_dropped, w.num_contours_dropped);
    v("CameraSilhouette.segmentation_ms", m.segmentation_ms, w.segmentation_ms, kStatistic);
    v("CameraSilhouette.polygons_ms", m.polygons_ms, w.polygons_ms, kStatistic);
    v("CameraSilhouette.texture_ms", m.texture_ms, w.texture_ms, kStatistic);
    v(m.colour_bytes, w.colour_bytes);
    v(m.mask_bytes, w.mask_bytes);
    const ContourSizes contours{kMaxContours};
    v("CameraSilhouette.contour_sizes", m.contour_sizes, w.contour_sizes, contours);
    const Vertices vertices{kMaxContourVertices, m.contour_sizes};
    v("CameraSilhouette.vertices_px", m.vertices_px, w.vertices_px, vertices);
}

void fields(auto& v, Of<SiteOrders> auto& m, auto& w) {
    v.key("SiteOrders.site", m.site, w.site, Text::kName);
    v(m.number, w.number);
    v("SiteOrders.asked", m.asked, w.asked_ns);
    v("SiteOrders.jpeg_quality", m.jpeg_quality, w.jpeg_quality, Range{1, 100});
    v("SiteOrders.colour_divisor", m.colour_divisor, w.colour_divisor, Range{1, 2});
    v("SiteOrders.send_every", m.send_every, w.send_every, Range{1, kMaxSendEvery});
    v("SiteOrders.sent", m.sent, w.sent_ns);
    v("SiteOrders.period", m.period, w.period_ns);
}

void fields(auto& v, Of<ClockAnswer> auto& m, auto& w) {
    v.key("ClockAnswer.site", m.site, w.site, Text::kName);
    v.key("ClockAnswer.host", m.host, w.host, Text::kName);
    v(m.number, w.number);
    v("ClockAnswer.asked", m.asked, w.asked_ns);
    v("ClockAnswer.received", m.received, w.received_ns);
    v("ClockAnswer.answered", m.answered, w.answered_ns);
    v(m.clock_epoch, w.clock_epoch);
}

void fields(auto& v, Of<RegionOrder> auto& m, auto& w) {
    v.key("RegionOrder.site", m.site, w.site, Text::kName);
    v.key("RegionOrder.host", m.host, w.host, Text::kName);
    v(m.number, w.number);
    v(m.frame_id, w.frame_id);
    v("RegionOrder.capture_time", m.capture_time, w.capture_time_ns);
    v(m.settings, w.settings);
    v("RegionOrder.cameras", m.cameras, w.cameras, CameraSet{});
    const ContourCounts counts{m.cameras.size()};
    v("RegionOrder.contour_counts", m.contour_counts, w.contour_counts, counts);
    const ContourSizes contours{kMaxOrderContours, &m.contour_counts};
    v("RegionOrder.contour_sizes", m.contour_sizes, w.contour_sizes, contours);
    const Vertices vertices{kMaxOrderVertices, m.contour_sizes};
    v("RegionOrder.vertices_px", m.vertices_px, w.vertices_px, vertices);
}

void fields(auto& v, Of<RegionHull> auto& m, auto& w) {
    v("RegionMeshes.regions.region", m.region, w.region, AtMost{kMaxRegions - 1});
    v("RegionMeshes.regions.outcome", m.outcome, w.outcome, Last{RegionOutcome::kOtherRig});
    v(m.num_bytes, w.num_bytes);
}

void fields(auto& v, Of<RegionMeshes> auto& m, auto& w) {
    v.key("RegionMeshes.site", m.site, w.site, Text::kName);
    v.key("RegionMeshes.host", m.host, w.host, Text::kName);
    v(m.frame_id, w.frame_id);
    v("RegionMeshes.capture_time", m.capture_time, w.capture_time_ns);
    v("RegionMeshes.hull_ms", m.hull_ms, w.hull_ms, kStatistic);
    v("RegionMeshes.mesh_ms", m.mesh_ms, w.mesh_ms, kStatistic);
    v.part(m.left_out, w.left_out);
    v("RegionMeshes.reason", m.reason, w.reason, Text::kLine);
    v("RegionMeshes.draco", m.draco, w.draco, AtMost{kMaxCodedBytes});
    const MeshesOf meshes{kMaxRegions, m.draco.size()};
    v("RegionMeshes.regions", m.regions, w.regions, meshes);
}

void fields(auto& v, Of<RegionNodeStatus> auto& m, auto& w) {
    v.key("RegionNodeStatus.site", m.site, w.site, Text::kName);
    v.key("RegionNodeStatus.host", m.host, w.host, Text::kName);
    v("RegionNodeStatus.time", m.time, w.time_ns);
    v(m.num_regions, w.num_regions);
    v(m.num_orders, w.num_orders);
    v(m.num_meshes, w.num_meshes);
    v(m.num_dropped_late, w.num_dropped_late);
    v(m.num_failed, w.num_failed);
    v(m.num_bytes_published, w.num_bytes_published);
    v("RegionNodeStatus.orders_per_s", m.orders_per_s, w.orders_per_s, kStatistic);
    v("RegionNodeStatus.bytes_per_s", m.bytes_per_s, w.bytes_per_s, kStatistic);
    v("RegionNodeStatus.order_to_mesh", m.order_to_mesh, w.order_to_mesh);
    v(m.resident_bytes, w.resident_bytes);
    v.part(m.stages, w.stages);
    v.part(m.processor, w.processor);
    v("first_output_s", m.first_output_s, w.first_output_s, kStatistic);
}

void fields(auto& v, Of<CameraNodeStatus> auto& m, auto& w) {
    v.key("CameraNodeStatus.site", m.site, w.site, Text::kName);
    v.key("CameraNodeStatus.host", m.host, w.host, Text::kName);
    v("CameraNodeStatus.time", m.time, w.time_ns);
    v(m.num_pictures, w.num_pictures);
    v(m.num_silhouettes, w.num_silhouettes);
    v(m.num_textures, w.num_textures);
    v(m.num_dropped_late, w.num_dropped_late);
    v(m.num_failed, w.num_failed);
    v(m.num_bytes_published, w.num_bytes_published);
    v("CameraNodeStatus.silhouettes_per_s", m.silhouettes_per_s, w.silhouettes_per_s, kStatistic);
    v("CameraNodeStatus.bytes_per_s",
      m.silhouette_bytes_per_s,
      w.silhouette_bytes_per_s,
      kStatistic);
    v("CameraNodeStatus.bytes_per_s", m.texture_bytes_per_s, w.texture_bytes_per_s, kStatistic);
    v("CameraNodeStatus.capture_to_silhouette", m.capture_to_silhouette, w.capture_to_silhouette);
    v(m.resident_bytes, w.resident_bytes);
    v("CameraNodeStatus.camera_indices", m.camera_indices, w.camera_indices, CameraSet{});
    v("CameraNodeStatus.cameras", m.cameras, w.cameras, AtMost{m.camera_indices.size()});
    v.part(m.processor, w.processor);
    v("first_output_s", m.first_output_s, w.first_output_s, kStatistic);
    v("CameraNodeStatus.is_clock_synchronised", m.is_clock_synchronised, w.is_clock_synchronised);
    v("CameraNodeStatus.clock_max_error", m.clock_max_error, w.clock_max_error_ns);
}

}  // namespace atrium::bus
