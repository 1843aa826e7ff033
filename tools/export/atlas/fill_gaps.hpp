#pragma once

#include "tools/export/atlas/textured_mesh.hpp"

#include <cstdint>
#include <vector>

namespace atrium::exporting {

/// Gives each texel that is not known (`is_known`, one byte per texel) a colour that continues the
/// known ones around it smoothly: means over ever larger squares (push-pull). Filtered and coded
/// textures then mix in no foreign colour. Without any known texel: grey.
///
/// After: Gortler, Grzeszczuk, Szeliski, Cohen. The Lumigraph. SIGGRAPH 1996.
void fill_gaps(const std::vector<std::uint8_t>& is_known, Picture& picture);

}  // namespace atrium::exporting
