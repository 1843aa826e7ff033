#include "core/bus/limits.hpp"
#include "core/bus/wire_fields.hpp"

namespace atrium::bus {

namespace {

void put_camera(const geometry::CalibratedCamera& camera, atrium_Camera& out) {
    const geometry::PinholeCamera& intrinsics = camera.intrinsics;
    put_name(camera.name, out.name);
    out.width = static_cast<std::uint32_t>(intrinsics.width);
    out.height = static_cast<std::uint32_t>(intrinsics.height);
    out.fx = intrinsics.fx;
    out.fy = intrinsics.fy;
    out.cx = intrinsics.cx;
    out.cy = intrinsics.cy;
    out.skew = intrinsics.skew;
    std::copy(intrinsics.distortion.begin(), intrinsics.distortion.end(), out.distortion);
    put_pose(camera.camera_from_site, out.camera_from_site);
}

/// Clamps a number of pixels to the range of int. `check` rejects such sizes anyway.
int get_pixels(std::uint32_t value) {
    return static_cast<int>(std::min<std::uint32_t>(value, std::numeric_limits<int>::max()));
}

geometry::CalibratedCamera get_camera(const atrium_Camera& wire) {
    geometry::CalibratedCamera camera;
    camera.name = get_name(wire.name);
    geometry::PinholeCamera& intrinsics = camera.intrinsics;
    intrinsics.width = get_pixels(wire.width);
    intrinsics.height = get_pixels(wire.height);
    intrinsics.fx = wire.fx;
    intrinsics.fy = wire.fy;
    intrinsics.cx = wire.cx;
    intrinsics.cy = wire.cy;
    intrinsics.skew = wire.skew;
    std::copy_n(wire.distortion, intrinsics.distortion.size(), intrinsics.distortion.begin());
    camera.camera_from_site = get_pose(wire.camera_from_site);
    return camera;
}

}  // namespace

void to_wire(const SiteDescription& message, WireScratch& scratch, atrium_SiteDescription& out) {
    key_to_wire(message, out);
    scratch.cameras.resize(message.cameras.size());
    for (std::size_t i = 0; i < message.cameras.size(); ++i)
        put_camera(message.cameras[i], scratch.cameras[i]);
    lend(scratch.cameras, out.cameras);
    put_vector(message.bounds_site.min, out.bounds_min);
    put_vector(message.bounds_site.max, out.bounds_max);
}

Expected<SiteDescription> from_wire(const atrium_SiteDescription& wire) {
    if (wire.cameras._length > kMaxCamerasPerSite) return too_many("SiteDescription.cameras");
    SiteDescription message;
    message.site = get_name(wire.site);
    for (const atrium_Camera& camera : elements_of(wire.cameras))
        message.cameras.push_back(get_camera(camera));
    message.bounds_site.min = get_vector(wire.bounds_min);
    message.bounds_site.max = get_vector(wire.bounds_max);
    auto result = checked(std::move(message));
    if (result) {
        for (auto& camera : result->cameras) normalise_rotation(camera.camera_from_site);
    }
    return result;
}

void key_to_wire(const SiteDescription& message, atrium_SiteDescription& out) {
    put_name(message.site, out.site);
}

Expected<SiteDescription> key_from_wire(const atrium_SiteDescription& wire) {
    SiteDescription key;
    key.site = get_name(wire.site);
    return with_checked_name(std::move(key), key.site);
}

std::size_t payload_bytes(const SiteDescription& message) {
    std::size_t bytes = message.site.size() + 2 * kVectorBytes;
    constexpr std::size_t kNumbers = 2 * sizeof(std::uint32_t) + 10 * sizeof(double) + kPoseBytes;
    for (const auto& camera : message.cameras) bytes += camera.name.size() + kNumbers;
    return bytes;
}

void to_wire(const SiteMesh& message, WireScratch& /*scratch*/, atrium_SiteMesh& out) {
    key_to_wire(message, out);
    out.frame_id = message.frame_id;
    out.capture_time_ns = message.capture_time.ns;
    lend(message.textured_cameras, out.textured_cameras);
    lend(message.draco, out.draco);
}

Expected<SiteMesh> from_wire(const atrium_SiteMesh& wire) {
    if (wire.textured_cameras._length > kMaxCamerasPerSite)
        return too_many("SiteMesh.textured_cameras");
    if (wire.draco._length > kMaxCodedBytes) return too_many("SiteMesh.draco");
    SiteMesh message;
    message.site = get_name(wire.site);
    message.frame_id = wire.frame_id;
    message.capture_time.ns = wire.capture_time_ns;
    const auto cameras = elements_of(wire.textured_cameras);
    message.textured_cameras.assign(cameras.begin(), cameras.end());
    const auto draco = elements_of(wire.draco);
    message.draco.assign(draco.begin(), draco.end());
    return checked(std::move(message));
}

void key_to_wire(const SiteMesh& message, atrium_SiteMesh& out) {
    put_name(message.site, out.site);
}

Expected<SiteMesh> key_from_wire(const atrium_SiteMesh& wire) {
    SiteMesh key;
    key.site = get_name(wire.site);
    return with_checked_name(std::move(key), key.site);
}

std::size_t payload_bytes(const SiteMesh& message) {
    return message.site.size() + 2 * sizeof(std::int64_t) +
           message.textured_cameras.size() * sizeof(std::uint32_t) + message.draco.size();
}

void to_wire(const CameraTexture& message, WireScratch& /*scratch*/, atrium_CameraTexture& out) {
    key_to_wire(message, out);
    out.frame_id = message.frame_id;
    out.capture_time_ns = message.capture_time.ns;
    out.crop_x = static_cast<std::uint32_t>(message.crop_px.x);
    out.crop_y = static_cast<std::uint32_t>(message.crop_px.y);
    out.crop_width = static_cast<std::uint32_t>(message.crop_px.width);
    out.crop_height = static_cast<std::uint32_t>(message.crop_px.height);
    lend(message.colour, out.colour);
    lend(message.mask, out.mask);
}

Expected<CameraTexture> from_wire(const atrium_CameraTexture& wire) {
    if (wire.colour._length > kMaxCodedBytes) return too_many("CameraTexture.colour");
    if (wire.mask._length > kMaxCodedBytes) return too_many("CameraTexture.mask");
    CameraTexture message;
    message.site = get_name(wire.site);
    message.camera = wire.camera;
    message.frame_id = wire.frame_id;
    message.capture_time.ns = wire.capture_time_ns;
    message.crop_px = {get_pixels(wire.crop_x),
                       get_pixels(wire.crop_y),
                       get_pixels(wire.crop_width),
                       get_pixels(wire.crop_height)};
    const auto colour = elements_of(wire.colour);
    message.colour.assign(colour.begin(), colour.end());
    const auto mask = elements_of(wire.mask);
    message.mask.assign(mask.begin(), mask.end());
    return checked(std::move(message));
}

void key_to_wire(const CameraTexture& message, atrium_CameraTexture& out) {
    put_name(message.site, out.site);
    out.camera = message.camera;
}

Expected<CameraTexture> key_from_wire(const atrium_CameraTexture& wire) {
    CameraTexture key;
    key.site = get_name(wire.site);
    key.camera = wire.camera;
    if (key.camera >= kMaxCamerasPerSite)
        return make_error(ErrorKind::kInvalidData, "key: camera index out of range");
    return with_checked_name(std::move(key), key.site);
}

std::size_t payload_bytes(const CameraTexture& message) {
    return message.site.size() + 2 * sizeof(std::int64_t) + 5 * sizeof(std::uint32_t) +
           message.colour.size() + message.mask.size();
}

}  // namespace atrium::bus
