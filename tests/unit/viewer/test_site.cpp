#include "tests/unit/viewer/test_site.hpp"

#include "core/codec/mesh_codec.hpp"
#include "core/codec/texture_codec.hpp"
#include "tests/unit/renderer/synthetic_person.hpp"

#include <stdexcept>

namespace atrium::viewer::test_site {
namespace {

namespace synthetic = renderer::synthetic;
const synthetic::Sphere kPerson{{0.0, 0.0, 1.2}, 0.4};

}  // namespace

bus::SiteDescription description(const std::string& site) {
    bus::SiteDescription result;
    result.site = site;
    result.cameras = synthetic::ring(4, kPerson.centre);
    for (std::size_t i = 0; i < result.cameras.size(); ++i)
        result.cameras[i].name = "cam" + std::to_string(i);
    result.bounds_site.add({-1.0, -1.0, 0.0});
    result.bounds_site.add({1.0, 1.0, 2.0});
    return result;
}

Frame frame(const std::string& site, std::uint64_t frame_id, std::uint8_t luma) {
    Frame result;
    result.mesh.site = site;
    result.mesh.frame_id = frame_id;
    result.mesh.capture_time = Timestamp::now();
    if (!codec::MeshEncoder().encode(synthetic::mesh_of({kPerson}, 16), {}, result.mesh.draco))
        throw std::runtime_error("the mesh cannot be coded");
    const bus::SiteDescription site_description = description(site);
    codec::TextureEncoder encoder;
    for (std::uint32_t c = 0; c < site_description.cameras.size(); ++c) {
        const auto picture =
            synthetic::picture_of({kPerson}, site_description.cameras[c], [](const auto&) {
                return Eigen::Vector3d::Zero().eval();
            });
        codec::TextureCrop crop{.crop_px = picture.crop_px,
                                .y = {picture.width, picture.height, luma},
                                .u = {picture.width, picture.height, 128},
                                .v = {picture.width, picture.height, 128},
                                .mask = {picture.width, picture.height}};
        for (std::size_t i = 0; i < crop.mask.data.size(); ++i)
            crop.mask.data[i] = picture.rgba[4 * i + 3];
        codec::CodedTexture coded;
        if (!encoder.encode(crop, 85, coded))
            throw std::runtime_error("the texture cannot be coded");
        bus::CameraTexture texture;
        texture.site = site;
        texture.camera = c;
        texture.frame_id = frame_id;
        texture.capture_time = result.mesh.capture_time;
        texture.crop_px = picture.crop_px;
        texture.colour = coded.colour;
        texture.mask = coded.mask;
        result.textures.push_back(texture);
        result.mesh.textured_cameras.push_back(c);
    }
    return result;
}

}  // namespace atrium::viewer::test_site
