#pragma once

#include "core/base/expected.hpp"
#include "tools/export/atlas/textured_mesh.hpp"

#include <cstdint>
#include <vector>

namespace atrium::exporting {

/// The picture as JPEG with full chroma: the charts of a texture are small. Fails as
/// codec::PictureEncoder.
Expected<std::vector<std::uint8_t>> texture_bytes(const Picture& picture, int quality);

}  // namespace atrium::exporting
