#pragma once

#include "core/base/expected.hpp"
#include "core/codec/texture_codec.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"
#include "site_node/texture/texture.hpp"

#include <cstdint>

namespace atrium::site_node {

/// How to code the colours of one metaframe.
struct ColourCoding {
    int jpeg_quality = 86;
    int divisor = 1;  // 1: as large as the mask; 2: half as wide and high
};

/// Coded texture of one camera.
struct CodedCamera {
    std::uint32_t camera = 0;
    image::PixelRect crop_px;
    codec::CodedTexture texture;
};

/// Crops and codes the textures of one camera. Keeps its memory; cameras are independent.
class TextureStage {
public:
    /// Codes what `seen` shows of people, all but `coded.camera`. False, and `coded` is
    /// unspecified, if that is nothing.
    Expected<bool> encode(const PictureSilhouette& seen,
                          const texture::TextureOptions& options,
                          const ColourCoding& coding,
                          CodedCamera& coded);

private:
    texture::TextureScratch scratch_;
    codec::TextureCrop crop_;
    codec::TextureEncoder encoder_;
};

}  // namespace atrium::site_node
