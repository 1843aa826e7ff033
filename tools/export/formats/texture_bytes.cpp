#include "tools/export/formats/texture_bytes.hpp"

#include "core/codec/picture_encoder.hpp"

namespace atrium::exporting {

Expected<std::vector<std::uint8_t>> texture_bytes(const Picture& picture, int quality) {
    codec::PictureEncoder encoder;
    const auto jpeg =
        encoder.encode(picture.rgba, picture.width, picture.height, quality, codec::Chroma::kFull);
    if (!jpeg) return tl::unexpected(jpeg.error());
    return std::vector<std::uint8_t>(jpeg->begin(), jpeg->end());
}

}  // namespace atrium::exporting
