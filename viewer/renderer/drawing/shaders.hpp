#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// GLSL sources of objects, floor and sky. Lighting is computed in linear light and encoded at the
/// end.
namespace atrium::renderer::shaders {

/// Rigid objects, one instance each, with world_from_mesh and colour as ObjectBatch lays them out.
extern const char* const kObjectVertex;
/// Soft objects; their nodes are in the world.
extern const char* const kSoftVertex;

/// Shades rigid and soft objects. A striped ball has lighter sectors, which make its rotation
/// visible. A painted mesh has a colour per vertex.
enum class Surface : std::uint8_t { kPlain, kTextured, kStriped, kPainted };
inline constexpr std::size_t kNumSurfaces = 4;
std::string object_fragment(Surface surface);

/// A lit plane: the square from -1 to 1, scaled by the uniform `half_size`, in its own frame [m].
extern const char* const kFloorVertex;
std::string floor_fragment(bool is_textured);

/// Factor by which shadows darken the floor; drawn with multiplicative blending. Corners are places
/// of the shadow map; `lift` moves them to the floor along the light.
extern const char* const kFloorShadowVertex;
extern const char* const kFloorShadowFragment;
/// The same for surfaces of objects that face up; with kObjectVertex.
extern const char* const kReceivedShadowFragment;

extern const char* const kBackgroundVertex;
extern const char* const kBackgroundFragment;

/// Projects objects along the light onto the floor, into the shadow map: red is their darkness,
/// green their height over `most_height`.
enum class Placed : std::uint8_t { kAllAlike, kEachInstance };  // world_from_object
std::string shadow_vertex(Placed placed);
extern const char* const kShadowFragment;

/// Transforms attribute 0 by the uniform `clip_from_model` and passes attribute 1, of the GLSL type
/// `type`, to the fragments as `name`.
std::string passing_vertex(const std::string& type, const std::string& name);

/// Blurs the darkness of the part of the shadow map given by triangles in the world; of heights the
/// highest remains.
extern const char* const kBlurVertex;
extern const char* const kBlurFragment;

}  // namespace atrium::renderer::shaders
