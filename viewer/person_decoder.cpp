#include "viewer/person_decoder.hpp"

#include "core/codec/mesh_codec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

Expected<void> decode_picture(const bus::CameraTexture& texture,
                              const bus::SiteDescription& description,
                              PersonDecodeScratch& scratch,
                              renderer::CameraPicture& picture) {
    if (texture.camera >= description.cameras.size()) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("texture of camera {}, but there are {} cameras",
                                      texture.camera,
                                      description.cameras.size()));
    }
    if (auto ok = scratch.textures.decode(texture.colour, texture.mask, scratch.texture); !ok)
        return ok;
    const int divisor = scratch.texture.width == texture.crop_px.width ? 1 : 2;
    if (scratch.texture.width * divisor != texture.crop_px.width ||
        scratch.texture.height * divisor != texture.crop_px.height) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("texture of {}x{} for a crop of {}x{}",
                                      scratch.texture.width,
                                      scratch.texture.height,
                                      texture.crop_px.width,
                                      texture.crop_px.height));
    }
    picture.camera = description.cameras[texture.camera];
    picture.crop_px = texture.crop_px;
    picture.width = scratch.texture.width;
    picture.height = scratch.texture.height;
    std::swap(picture.rgba, scratch.texture.rgba);
    return {};
}

}  // namespace

Expected<void> decode_person(const FramePair& pair,
                             const bus::SiteDescription& description,
                             const PersonLimits& limits,
                             PersonDecodeScratch& scratch,
                             renderer::PersonModel& out) {
    const auto mesh = codec::decode_mesh(
        pair.mesh.draco,
        {.max_triangles = limits.max_triangles, .max_vertices = 3 * limits.max_triangles});
    if (!mesh) return tl::unexpected(mesh.error());
    scratch.pictures.resize(pair.textures.size());
    int width = 0;
    int height = 0;
    for (std::size_t i = 0; i < pair.textures.size(); ++i) {
        renderer::CameraPicture& picture = scratch.pictures[i];
        if (auto ok = decode_picture(pair.textures[i], description, scratch, picture); !ok)
            return ok;
        width = std::max(width, picture.width);
        height = std::max(height, picture.height);
        // the layers of all cameras are as large as the largest one
        const std::size_t layer_bytes =
            4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        if (std::max(width, height) > limits.max_picture_side_px ||
            layer_bytes * pair.textures.size() > limits.max_layer_bytes) {
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format(
                    "{} pictures of {}x{} are too much", pair.textures.size(), width, height));
        }
    }
    renderer::build_person_model(*mesh, scratch.pictures, {}, scratch.model, out);
    return {};
}

}  // namespace atrium::viewer
