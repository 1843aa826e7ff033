#pragma once

namespace atrium::simulation {

/// Projects as the camera's lens does, distortion included; top picture row first in the
/// framebuffer.
extern const char* const kPersonVertexShader;
/// Paints skin, hair, face and clothes by the place in the rest pose, and lights them.
extern const char* const kPersonFragmentShader;
extern const char* const kModelFragmentShader;
/// One flat value, for shadows and for what hides a person.
extern const char* const kFlatFragmentShader;

}  // namespace atrium::simulation
