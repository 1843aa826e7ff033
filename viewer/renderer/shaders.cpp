#include "viewer/renderer/shaders.hpp"

#include <algorithm>
#include <initializer_list>

namespace atrium::renderer::shaders {
namespace {

// Repeats `line` for each camera slot and replaces every '#' by the slot's number.
std::string for_each_slot(std::size_t num_cameras, const std::string& line) {
    std::string text;
    for (std::size_t i = 0; i < num_cameras; ++i) {
        for (const char c : line) {
            if (c == '#')
                text += std::to_string(i);
            else
                text += c;
        }
        text += '\n';
    }
    return text;
}

// GLSL type of the next layers, as many as fit one attribute.
std::string layers_type(std::size_t num_layers) {
    return num_layers == 1 ? "float"
                           : "vec" + std::to_string(std::min(num_layers, kLayersPerAttribute));
}

}  // namespace

std::string person_vertex(std::size_t num_cameras) {
    // attributes 0, 1: position, fallback colour; 2..: layers in fours; then one vec4 per camera
    std::string text =
        "#version 330 core\nlayout(location = 0) in vec3 position;\n"
        "layout(location = 1) in vec3 fallback;\n"
        "uniform mat4 clip_from_site;\nout vec3 fallback_colour;\n";
    unsigned location = 2;
    std::string copies;
    for (std::size_t i = 0; i < num_cameras; i += kLayersPerAttribute) {
        const std::string slot = std::to_string(i);
        const std::string type = layers_type(num_cameras - i);
        text += "layout(location = " + std::to_string(location++) + ") in " + type + " layers" +
                slot + ";\nflat out " + type + " used_layers" + slot + ";\n";
        copies += "    used_layers" + slot + " = layers" + slot + ";\n";
    }
    for (std::size_t i = 0; i < num_cameras; ++i) {
        text += "layout(location = " + std::to_string(location++) + ") in vec4 picture" +
                std::to_string(i) + ";\nout vec4 in_picture" + std::to_string(i) + ";\n";
    }
    text +=
        "void main() {\n    gl_Position = clip_from_site * vec4(position, 1.0);\n"
        "    fallback_colour = fallback;\n";
    return text + copies + for_each_slot(num_cameras, "    in_picture# = picture#;") + "}\n";
}

std::string person_fragment(std::size_t num_cameras) {
    std::string text =
        "#version 330 core\nuniform sampler2DArray pictures;\n"
        "in vec3 fallback_colour;\nout vec4 fragment;\n";
    for (std::size_t i = 0; i < num_cameras; i += kLayersPerAttribute)
        text +=
            "flat in " + layers_type(num_cameras - i) + " used_layers" + std::to_string(i) + ";\n";
    text += for_each_slot(num_cameras, "in vec4 in_picture#;");
    // texels hold colour times mask, so the division gives a colour of the person alone; the
    // fallback takes over smoothly where weights and masks are nearly 0
    text += "void main() {\n    vec4 sum = vec4(fallback_colour, 1.0) * 0.01;\n";
    for (std::size_t i = 0; i < num_cameras; ++i) {
        const std::string slot = std::to_string(i);
        const std::size_t first = i - i % kLayersPerAttribute;
        const std::string layer =
            "used_layers" + std::to_string(first) +
            (num_cameras - first == 1 ? "" : "[" + std::to_string(i - first) + "]");
        text += "    sum += in_picture" + slot + ".w * texture(pictures, vec3(in_picture" + slot +
                ".xy / in_picture" + slot + ".z, " + layer + "));\n";
    }
    return text + "    fragment = vec4(sum.rgb / sum.a, 1.0);\n}\n";
}

const char* const kObjectVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 place;
layout(location = 3) in mat4 world_from_mesh;
layout(location = 7) in vec3 instance_colour;
uniform mat4 clip_from_world;
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
    gl_Position = clip_from_world * p;
}
)";

const char* const kSoftVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 place;
uniform mat4 clip_from_world;
uniform vec3 soft_colour;
out vec2 p_picture;
out vec3 p_mesh;
out vec3 p_world;
out vec3 normal_world;
flat out vec3 colour;
void main() {
    p_mesh = p_world = position;
    p_picture = place;
    normal_world = normal;
    colour = soft_colour;
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
uniform sampler2D picture;
uniform vec3 light;
uniform vec3 eye;
out vec4 fragment;
void main() {
    vec3 n = normalize(normal_world);
    // seen from behind: flip the normal
    if (!gl_FrontFacing) n = -n;
    vec3 base = colour;
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
                         surface == Surface::kStriped ? "STRIPED" : ""},
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
out vec2 at;
out float strength;
void main() {
    at = position.xy / shadow_extent + 0.5;
    // far floor has the colour of the horizon and less shadow
    float far = clamp((dot(position.xy, position.xy) - fade.x) * fade.y, 0.0, 1.0);
    strength = shadow_strength * (1.0 - far);
    gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

const char* const kFloorShadowFragment = R"(#version 330 core
in vec2 at;
in float strength;
uniform sampler2D shadow;
out vec4 fragment;
void main() { fragment = vec4(1.0 - strength * texture(shadow, at).r); }
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
void main() {
    vec3 p = (world_from_object * vec4(position, 1.0)).xyz;
    vec2 on_floor = p.xy - light.xy * (p.z / light.z);
    gl_Position = vec4(on_floor * 2.0 / shadow_extent, 0.0, 1.0);
}
)";
}

const char* const kShadowFragment = R"(#version 330 core
uniform float darkness;
out vec4 fragment;
void main() { fragment = vec4(darkness); }
)";

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
    float sum = texture(picture, at + reach).r + texture(picture, at - reach).r
              + texture(picture, at + vec2(-reach.y, reach.x)).r
              + texture(picture, at + vec2(reach.y, -reach.x)).r;
    fragment = vec4(0.25 * sum);
}
)";

const char* const kScreenVertex = R"(#version 330 core
layout(location = 0) in vec2 corner;
out vec2 at;
void main() {
    at = corner * 0.5 + 0.5;
    gl_Position = vec4(corner, 0.0, 1.0);
}
)";

const char* const kLabelVertex = R"(#version 330 core
layout(location = 0) in vec2 corner;
uniform mat4 clip_from_view;
uniform vec3 middle;
uniform vec2 half_size;
out vec2 at;
void main() {
    at = vec2(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y);
    gl_Position = clip_from_view * vec4(middle + vec3(corner * half_size, 0.0), 1.0);
}
)";

const char* const kLabelFragment = R"(#version 330 core
in vec2 at;
uniform sampler2D picture;
uniform float opacity;
out vec4 fragment;
void main() { fragment = opacity * texture(picture, at); }
)";

const char* const kLineVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 colour;
uniform mat4 clip_from_world;
out vec3 line_colour;
void main() {
    line_colour = colour;
    gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

const char* const kLineFragment = R"(#version 330 core
in vec3 line_colour;
uniform float opacity;
out vec4 fragment;
void main() { fragment = vec4(line_colour, opacity); }
)";

const char* const kSilhouetteVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 place;
uniform mat4 clip_from_site;
out vec2 at;
void main() {
    at = place;
    gl_Position = clip_from_site * vec4(position, 1.0);
}
)";

// The outline is one screen pixel wide around the person, at any size of the person.
const char* const kSilhouetteFragment = R"(#version 330 core
in vec2 at;
uniform sampler2DArray pictures;
uniform float layer;
uniform float opacity;
uniform vec3 outline;
out vec4 fragment;
const float kInside = 0.1;  // least alpha of texels inside the mask; at its edge alpha is lower
void main() {
    vec4 here = texture(pictures, vec3(at, layer));
    vec2 right = dFdx(at);
    vec2 up = dFdy(at);
    vec2 beside = max(vec2(texture(pictures, vec3(at - right, layer)).a,
                           texture(pictures, vec3(at - up, layer)).a),
                      vec2(texture(pictures, vec3(at + right, layer)).a,
                           texture(pictures, vec3(at + up, layer)).a));
    vec4 colour = vec4(outline, 0.12);
    if (here.a >= kInside)
        colour = vec4(here.rgb / here.a, 0.95);
    else if (max(beside.x, beside.y) >= kInside)
        colour.a = 1.0;
    fragment = vec4(colour.rgb * colour.a, colour.a) * opacity;
}
)";

// After: Lottes. FXAA. 2009. In its shortest form: where the luma of the four diagonal neighbours
// differs, average along the edge.
const char* const kFxaaFragment = R"(#version 330 core
in vec2 at;
uniform sampler2D picture;
uniform vec2 pixel;
out vec4 fragment;
void main() {
    const vec3 luma = vec3(0.299, 0.587, 0.114);
    vec3 centre = texture(picture, at).rgb;
    float nw = dot(texture(picture, at + vec2(-0.5, 0.5) * pixel).rgb, luma);
    float ne = dot(texture(picture, at + vec2(0.5, 0.5) * pixel).rgb, luma);
    float sw = dot(texture(picture, at + vec2(-0.5, -0.5) * pixel).rgb, luma);
    float se = dot(texture(picture, at + vec2(0.5, -0.5) * pixel).rgb, luma);
    float low = min(min(nw, ne), min(sw, se));
    float high = max(max(nw, ne), max(sw, se));
    if (high - low < max(0.03, 0.12 * high)) {
        fragment = vec4(centre, 1.0);
        return;
    }
    vec2 along = vec2(sw + se - nw - ne, nw + sw - ne - se);
    along = vec2(nw + ne - sw - se, nw + sw - ne - se) * vec2(-1.0, 1.0);
    float least = min(abs(along.x), abs(along.y)) + 0.02;
    along = clamp(along / least, -4.0, 4.0) * pixel;
    vec3 near = 0.5 * (texture(picture, at + along * (1.0 / 3.0 - 0.5)).rgb
                     + texture(picture, at + along * (2.0 / 3.0 - 0.5)).rgb);
    fragment = vec4(near, 1.0);
}
)";

}  // namespace atrium::renderer::shaders
