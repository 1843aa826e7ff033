#pragma once

#include "viewer/renderer/drawing/object_look.hpp"

#include <memory>
#include <string>

namespace atrium::viewer {

/// Renders `text` for a label: white with a dark rim, colours multiplied by alpha, 64 px high.
/// Characters other than printable ASCII become '?'; text beyond 63 characters is cut.
std::shared_ptr<const renderer::TexturePicture> draw_text(const std::string& text);

}  // namespace atrium::viewer
