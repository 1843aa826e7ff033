#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// GLSL sources. Colours of people are sRGB as the cameras gave them and pass through unchanged;
/// what the renderer lights itself is linear and encoded at the end.
namespace atrium::renderer::shaders {

/// A person's triangles that blend up to `num_cameras` pictures (see camera_blend.hpp).
std::string person_vertex(std::size_t num_cameras);
std::string person_fragment(std::size_t num_cameras);

/// Of rigid things, one instance each: world_from_mesh, colour and sectors as ObjectBatch has them.
extern const char* const kObjectVertex;
/// Of soft things, whose nodes are in the world.
extern const char* const kSoftVertex;
extern const char* const kObjectFragment;

extern const char* const kFloorVertex;
extern const char* const kFloorFragment;

extern const char* const kBackgroundVertex;
extern const char* const kBackgroundFragment;

/// Flattens what it draws along the light onto the floor, in the floor's shadow picture.
enum class Placed : std::uint8_t { kAllAlike, kEachInstance };  // world_from_object
std::string shadow_vertex(Placed placed);
extern const char* const kShadowFragment;

/// A picture at a place before the eye, its colours multiplied by alpha.
extern const char* const kLabelVertex;
extern const char* const kLabelFragment;

/// A line of two colours.
extern const char* const kLineVertex;
extern const char* const kLineFragment;

/// A camera's picture of a person in the world: her colours, her outline, and a tint around her.
extern const char* const kSilhouetteVertex;
extern const char* const kSilhouetteFragment;

/// Smooths edges of the finished picture (`view.antialias = "fxaa"`).
extern const char* const kScreenVertex;
extern const char* const kSmoothFragment;

}  // namespace atrium::renderer::shaders
