#include "viewer/receive/person_decoder.hpp"

#include "viewer/renderer/person/needed_cameras.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

Expected<void> decode_picture(const bus::CameraTexture& texture,
                              const bus::SiteDescription& description,
                              PersonDecodeScratch& scratch,
                              renderer::CameraPicture& picture) {
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

// Selects the textures that the eyes need.
Expected<std::vector<bool>> needed_textures(const FramePair& pair,
                                            const bus::SiteDescription& description,
                                            const geometry::TriangleMesh& mesh_site,
                                            std::span<const Eigen::Vector3f> eyes_site,
                                            std::vector<Eigen::Vector3f>& centres) {
    centres.clear();
    for (const bus::CameraTexture& texture : pair.textures) {
        if (texture.camera >= description.cameras.size()) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("texture of camera {}, but the site has {} cameras",
                                          texture.camera,
                                          description.cameras.size()));
        }
        centres.push_back(description.cameras[texture.camera].centre_site().cast<float>());
    }
    Eigen::AlignedBox3d bounds;
    for (const Eigen::Vector3d& vertex : mesh_site.vertices) bounds.extend(vertex);
    return renderer::needed_cameras(centres, bounds.cast<float>(), eyes_site);
}

}  // namespace

Expected<void> decode_person(const FramePair& pair,
                             const bus::SiteDescription& description,
                             const PersonLimits& limits,
                             std::span<const Eigen::Vector3f> eyes_site,
                             PersonDecodeScratch& scratch,
                             renderer::PersonModel& out) {
    auto decoded = scratch.meshes.decode(
        pair.mesh.draco,
        pair.mesh.mesh_sizes,
        {.max_triangles = limits.max_triangles, .max_vertices = 3 * limits.max_triangles},
        scratch.mesh);
    if (!decoded) return decoded;
    const auto needed =
        needed_textures(pair, description, scratch.mesh, eyes_site, scratch.centres);
    if (!needed) return tl::unexpected(needed.error());
    const auto num_pictures = static_cast<std::size_t>(std::ranges::count(*needed, true));
    scratch.pictures.resize(num_pictures);
    int width = 0;
    int height = 0;
    std::size_t num_decoded = 0;
    for (std::size_t i = 0; i < pair.textures.size(); ++i) {
        if (!(*needed)[i]) continue;
        renderer::CameraPicture& picture = scratch.pictures[num_decoded++];
        if (auto ok = decode_picture(pair.textures[i], description, scratch, picture); !ok)
            return ok;
        width = std::max(width, picture.width);
        height = std::max(height, picture.height);
        // all layers have the size of the largest
        const std::size_t layer_bytes =
            4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        if (std::max(width, height) > limits.max_picture_side_px ||
            layer_bytes * num_pictures > limits.max_layer_bytes) {
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("{} pictures of {}x{} exceed the limit", num_pictures, width, height));
        }
    }
    renderer::build_person_model(scratch.mesh, scratch.pictures, {}, scratch.model, out);
    return {};
}

}  // namespace atrium::viewer
