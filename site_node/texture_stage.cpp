#include "site_node/texture_stage.hpp"

namespace atrium::site_node {

Expected<bool> TextureStage::encode(const PictureSilhouette& seen,
                                    const texture::TextureOptions& options,
                                    const ColourCoding& coding,
                                    CodedCamera& coded) {
    if (!texture::crop_texture(
            seen.picture, seen.mask.mask, seen.subject, options, scratch_, crop_))
        return false;
    coded.crop_px = crop_.crop_px;
    const auto encoded = encoder_.encode(crop_, coding.jpeg_quality, coding.divisor, coded.texture);
    if (!encoded) return tl::unexpected(encoded.error());
    return true;
}

}  // namespace atrium::site_node
