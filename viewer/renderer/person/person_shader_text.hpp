#pragma once

#include <cstddef>
#include <string>

/// GLSL sources of people. Their colours are sRGB from the cameras and pass unchanged.
namespace atrium::renderer::shaders {

/// Triangles of a person that blend up to `num_cameras` pictures (see camera_blend.hpp). The layers
/// of the cameras are packed in attributes of up to four components.
inline constexpr std::size_t kLayersPerAttribute = 4;
std::string person_vertex(std::size_t num_cameras);
std::string person_fragment(std::size_t num_cameras);

/// Fragment shader of an OutlineStrip; its vertex shader is that of kStripCameras. Colours are
/// multiplied by alpha. That is the uniform `opacity` where the masks of all its cameras show the
/// person, and falls to 0 where those with half of the weight do.
std::string outline_strip_fragment();

}  // namespace atrium::renderer::shaders
