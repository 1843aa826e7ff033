#pragma once

#include "viewer/renderer/drawing/object_look.hpp"

#include <memory>
#include <string>

namespace atrium::viewer {

inline constexpr int kTextHeight_px = 64;

/// Height of the text's picture for a label of that share of a picture's height, so that its pixels
/// are those of the picture. Within limits.
int text_height_px(double share, int picture_height_px);

/// Renders `text` for a label: white with a dark rim, colours multiplied by alpha. Characters other
/// than printable ASCII become '?'; text beyond 63 characters is cut.
std::shared_ptr<const renderer::TexturePicture> draw_text(const std::string& text,
                                                          int height_px = kTextHeight_px);

}  // namespace atrium::viewer
