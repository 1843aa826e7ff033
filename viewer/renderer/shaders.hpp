#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// GLSL sources. Colours of people are sRGB as the cameras gave them and pass through unchanged;
/// what the renderer lights itself is linear and encoded at the end.
namespace atrium::renderer::shaders {

/// A person's triangles that blend up to `num_cameras` pictures (see camera_blend.hpp).
/// The layers of all cameras follow each other in attributes of up to four numbers.
inline constexpr std::size_t kLayersPerAttribute = 4;
std::string person_vertex(std::size_t num_cameras);
std::string person_fragment(std::size_t num_cameras);

/// Rigid things, one instance each: world_from_mesh and colour as ObjectBatch lays them out.
extern const char* const kObjectVertex;
/// Soft things, whose nodes are in the world.
extern const char* const kSoftVertex;

/// Shades rigid and soft things. A striped ball has lighter sectors, which show that it turns.
enum class Surface : std::uint8_t { kPlain, kTextured, kStriped };
inline constexpr std::size_t kNumSurfaces = 3;
std::string object_fragment(Surface surface);

/// A plane in the light: the square of -1 to 1, times the uniform `half_size`, in its own frame
/// [m].
extern const char* const kFloorVertex;
std::string floor_fragment(bool is_textured);

/// What part of its light a floor keeps where shadows lie on it, which it is to be multiplied by.
extern const char* const kFloorShadowVertex;
extern const char* const kFloorShadowFragment;

extern const char* const kBackgroundVertex;
extern const char* const kBackgroundFragment;

/// Flattens what it draws along the light onto the floor, in the floor's shadow picture.
enum class Placed : std::uint8_t { kAllAlike, kEachInstance };  // world_from_object
std::string shadow_vertex(Placed placed);
extern const char* const kShadowFragment;

/// Blurs a part of the picture of the shadows, given by triangles in the world.
extern const char* const kBlurVertex;
extern const char* const kBlurFragment;

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
