#pragma once

namespace atrium::simulation {

/// Projects with lens distortion; the top picture row comes first in the framebuffer.
extern const char* const kPersonVertexShader;
/// Paints skin, hair, face and clothes by position in the rest pose, and lights them.
extern const char* const kPersonFragmentShader;
extern const char* const kModelFragmentShader;
/// Writes one flat value, for shadows and occluders.
extern const char* const kFlatFragmentShader;

}  // namespace atrium::simulation
