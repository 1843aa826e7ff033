#pragma once

#include "viewer/renderer/object_look.hpp"

#include <memory>
#include <string>

namespace atrium::viewer {

/// `text` in white with a dark rim, for labels: colours multiplied by alpha, 64 px high. What is
/// not printable ASCII becomes '?', and what is longer than 63 characters is cut.
std::shared_ptr<const renderer::TexturePicture> draw_text(const std::string& text);

}  // namespace atrium::viewer
