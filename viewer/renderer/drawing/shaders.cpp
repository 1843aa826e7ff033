#include "viewer/renderer/drawing/shaders.hpp"

#include <initializer_list>

namespace atrium::renderer::shaders {

const char* const kObjectVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 place;
layout(location = 3) in mat4 world_from_mesh;
layout(location = 7) in vec3 instance_colour;
layout(location = 8) in vec3 vertex_colour;  // of painted meshes
uniform mat4 clip_from_world;
out vec3 paint;
out vec2 p_picture;
out vec3 p_mesh;
out vec3 p_world;
out vec3 normal_world;
flat out vec3 colour;
void main() {
    vec4 p = world_from_mesh * vec4(position, 1.0);
    p_mesh = position;
    p_picture = place;
    p_world = p.xyz;
    // normals scale inversely
    mat3 linear = mat3(world_from_mesh);
    vec3 scale2 = vec3(dot(linear[0], linear[0]), dot(linear[1], linear[1]), dot(linear[2], linear[2]));
    normal_world = linear * (normal / scale2);
    colour = instance_colour;
    paint = vertex_colour;
    gl_Position = clip_from_world * p;
}
)";

const char* const kSoftVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 place;
uniform mat4 clip_from_world;
uniform vec3 soft_colour;
out vec3 paint;
out vec2 p_picture;
out vec3 p_mesh;
out vec3 p_world;
out vec3 normal_world;
flat out vec3 colour;
void main() {
    p_mesh = p_world = position;
    p_picture = place;
    normal_world = normal;
    colour = paint = soft_colour;
    gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

namespace {

// Encodes linear light as sRGB, to a tenth of a grey level. Two roots replace the power, which
// costs a software renderer a logarithm and an exponential.
constexpr const char* kEncode = R"(
vec3 encode(vec3 linear) {
    vec3 root = sqrt(linear);
    vec3 curve = 0.8337082 * root + 0.2981508 * sqrt(root) - 0.0553056 * linear - 0.0769137;
    return mix(12.92 * linear, curve, step(0.0031308, linear));
}
)";

std::string with_defines(std::initializer_list<const char*> defines,
                         std::initializer_list<const char*> parts) {
    std::string text = "#version 330 core\n";
    for (const char* define : defines) {
        if (*define != '\0') text += std::string("#define ") + define + '\n';
    }
    for (const char* part : parts) text += part;
    return text;
}

// One shader per kind of surface: a software renderer executes both sides of a branch for every
// pixel.
constexpr const char* kObjectFragment = R"(
in vec3 p_mesh;
in vec2 p_picture;
in vec3 p_world;
in vec3 normal_world;
flat in vec3 colour;
in vec3 paint;
uniform sampler2D picture;
uniform vec3 light;
uniform vec3 eye;
out vec4 fragment;
void main() {
    vec3 n = normalize(normal_world);
    // seen from behind: flip the normal
    if (!gl_FrontFacing) n = -n;
#ifdef PAINTED
    vec3 base = paint;
#else
    vec3 base = colour;
#endif
#ifdef TEXTURED
    vec4 painted = texture(picture, p_picture);
    base = mix(base, painted.rgb, painted.a);
#endif
#ifdef STRIPED
    // three lighter sectors show that a ball turns: sin(3 a) of the angle a around its axis
    vec2 around = p_mesh.xy * inversesqrt(max(dot(p_mesh.xy, p_mesh.xy), 1e-12));
    float wave = around.y * (3.0 - 4.0 * around.y * around.y);
    base = mix(base, mix(base, vec3(1.0), 0.35), smoothstep(-0.05, 0.05, wave));
#endif
    vec3 ambient = mix(vec3(0.22, 0.21, 0.20), vec3(0.42, 0.44, 0.48), 0.5 + 0.5 * n.z);
    float key = max(dot(n, light), 0.0) * 0.75;
    vec3 to_eye = normalize(eye - p_world);
    float shine = max(dot(n, normalize(to_eye + light)), 0.0);
    shine *= shine;
    shine *= shine;
    shine *= shine;  // power of 8; power of 40 at the end
    float shine_16 = shine * shine;
    shine *= shine_16 * shine_16 * 0.12;
    fragment = vec4(encode(clamp(base * (ambient + key) + shine, 0.0, 1.0)), 1.0);
}
)";

}  // namespace

std::string object_fragment(Surface surface) {
    return with_defines({surface == Surface::kTextured ? "TEXTURED" : "",
                         surface == Surface::kStriped ? "STRIPED" : "",
                         surface == Surface::kPainted ? "PAINTED" : ""},
                        {kEncode, kObjectFragment});
}

const char* const kFloorVertex = R"(#version 330 core
layout(location = 0) in vec2 corner;
uniform mat4 clip_from_world;
uniform mat4 world_from_floor;
uniform vec2 half_size;
out vec2 p_world;
out vec2 p_floor;
void main() {
    p_floor = corner * half_size;
    vec4 p = world_from_floor * vec4(p_floor, 0.0, 1.0);
    p_world = p.xy;
    gl_Position = clip_from_world * p;
}
)";

namespace {

// Works in sRGB: darkening by a factor is the same there except at the ends of the curve, and it
// saves three powers per pixel for half of the picture.
constexpr const char* kFloorFragment = R"(
in vec2 p_world;
in vec2 p_floor;
uniform vec3 colour;
uniform vec3 horizon;
uniform sampler2D picture;
uniform vec2 fade;
out vec4 fragment;
void main() {
    vec3 base = colour;
#ifdef TEXTURED
    vec4 painted = texture(picture, vec2(p_floor.x, -p_floor.y));
    base = mix(base, encode(painted.rgb), painted.a);
#endif
    vec2 line = abs(fract(p_floor - 0.5) - 0.5) / max(fwidth(p_floor), 1e-4);
    float bright = 0.90 + 0.10 * min(min(line.x, line.y), 1.0);
    float far = clamp((dot(p_world, p_world) - fade.x) * fade.y, 0.0, 1.0);
    fragment = vec4(mix(base * bright, horizon, far), 1.0);
}
)";

}  // namespace

std::string floor_fragment(bool is_textured) {
    return with_defines({is_textured ? "TEXTURED" : ""}, {kEncode, kFloorFragment});
}

const char* const kFloorShadowVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_world;
uniform float shadow_extent;
uniform float shadow_strength;
uniform vec2 fade;
uniform vec3 lift;
out vec2 at;
out float strength;
void main() {
    at = position.xy / shadow_extent + 0.5;
    // far floor has the colour of the horizon and less shadow
    float far = clamp((dot(position.xy, position.xy) - fade.x) * fade.y, 0.0, 1.0);
    strength = shadow_strength * (1.0 - far);
    gl_Position = clip_from_world * vec4(position + lift, 1.0);
}
)";

const char* const kFloorShadowFragment = R"(#version 330 core
in vec2 at;
in float strength;
uniform sampler2D shadow;
uniform float lowest;  // that casts a shadow here, over most_height
out vec4 fragment;
void main() {
    vec2 blocked = texture(shadow, at).rg;
    fragment = vec4(1.0 - strength * blocked.r * step(lowest, blocked.g));
}
)";

// A surface gets no shadow of itself: what casts one is higher, by more the steeper the surface is.
const char* const kReceivedShadowFragment = R"(#version 330 core
in vec3 p_world;
in vec3 normal_world;
uniform sampler2D shadow;
uniform vec3 light;
uniform float shadow_extent;
uniform float shadow_strength;
uniform float most_height;
out vec4 fragment;
void main() {
    vec3 normal = normalize(gl_FrontFacing ? normal_world : -normal_world);
    float faces_up = clamp(4.0 * normal.z - 2.6, 0.0, 1.0);
    vec2 at = (p_world.xy - light.xy * (p_world.z / light.z)) / shadow_extent + 0.5;
    vec2 inside = step(abs(at - 0.5), vec2(0.5));
    vec2 blocked = texture(shadow, at).rg;
    float higher = step(p_world.z + 0.05 + 0.6 * (1.0 - normal.z), most_height * blocked.g);
    fragment = vec4(1.0 - shadow_strength * faces_up * inside.x * inside.y * blocked.r * higher);
}
)";

const char* const kBackgroundVertex = R"(#version 330 core
layout(location = 0) in vec2 corner;
uniform vec2 lower;
uniform vec2 upper;
out float height;
void main() {
    vec2 side = mix(lower, upper, 0.5 + 0.5 * corner.y);
    height = mix(side.x, side.y, 0.5 + 0.5 * corner.x);
    gl_Position = vec4(corner, 1.0, 1.0);
}
)";

const char* const kBackgroundFragment = R"(#version 330 core
in float height;
uniform vec3 horizon;
uniform vec3 zenith;
out vec4 fragment;
void main() { fragment = vec4(mix(horizon, zenith, clamp(height, 0.0, 1.0)), 1.0); }
)";

std::string shadow_vertex(Placed placed) {
    return std::string("#version 330 core\nlayout(location = 0) in vec3 position;\n") +
           (placed == Placed::kEachInstance ? "layout(location = 3) in" : "uniform") +
           R"( mat4 world_from_object;
uniform vec3 light;
uniform float shadow_extent;
out float height;
void main() {
    vec3 p = (world_from_object * vec4(position, 1.0)).xyz;
    vec2 on_floor = p.xy - light.xy * (p.z / light.z);
    height = p.z;
    gl_Position = vec4(on_floor * 2.0 / shadow_extent, 0.0, 1.0);
}
)";
}

const char* const kShadowFragment = R"(#version 330 core
in float height;
uniform float darkness;
uniform float most_height;
out vec4 fragment;
void main() { fragment = vec4(darkness, height / most_height, 0.0, 1.0); }
)";

std::string passing_vertex(const std::string& type, const std::string& name) {
    return "#version 330 core\nlayout(location = 0) in vec3 position;\nlayout(location = 1) in " +
           type + " passed;\nuniform mat4 clip_from_model;\nout " + type + " " + name +
           ";\nvoid main() {\n    " + name +
           " = passed;\n    gl_Position = clip_from_model * vec4(position, 1.0);\n}\n";
}

const char* const kBlurVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform float shadow_extent;
out vec2 at;
void main() {
    at = position.xy / shadow_extent + 0.5;
    gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
}
)";

// Blurs over about three pixels. The samples are rotated against the grid, which smooths edges
// along it.
const char* const kBlurFragment = R"(#version 330 core
in vec2 at;
uniform sampler2D picture;
uniform float texel;
out vec4 fragment;
void main() {
    vec2 reach = vec2(0.9, 0.36) * texel;
    vec2 a = texture(picture, at + reach).rg;
    vec2 b = texture(picture, at - reach).rg;
    vec2 c = texture(picture, at + vec2(-reach.y, reach.x)).rg;
    vec2 d = texture(picture, at + vec2(reach.y, -reach.x)).rg;
    fragment = vec4(0.25 * (a.r + b.r + c.r + d.r), max(max(a.g, b.g), max(c.g, d.g)), 0.0, 1.0);
}
)";

}  // namespace atrium::renderer::shaders
