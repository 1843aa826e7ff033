#include "viewer/renderer/shaders.hpp"

namespace atrium::renderer::shaders {
namespace {

// `line` for each camera slot, its number in place of every '#'.
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

}  // namespace

std::string person_vertex(std::size_t num_cameras) {
    // attributes 0, 1: position, fallback colour; 2..: layers in twos; then one vec4 per camera
    std::string text =
        "#version 330 core\nlayout(location = 0) in vec3 position;\n"
        "layout(location = 1) in vec3 fallback;\n"
        "uniform mat4 clip_from_site;\nout vec3 fallback_colour;\n";
    const std::size_t num_pairs = num_cameras / 2;
    for (std::size_t i = 0; i < num_pairs; ++i) {
        text += "layout(location = " + std::to_string(2 + i) + ") in vec2 layers" +
                std::to_string(i) + ";\nflat out vec2 used_layers" + std::to_string(i) + ";\n";
    }
    for (std::size_t i = 0; i < num_cameras; ++i) {
        text += "layout(location = " + std::to_string(2 + num_pairs + i) + ") in vec4 picture" +
                std::to_string(i) + ";\nout vec4 in_picture" + std::to_string(i) + ";\n";
    }
    text +=
        "void main() {\n    gl_Position = clip_from_site * vec4(position, 1.0);\n"
        "    fallback_colour = fallback;\n";
    text += for_each_slot(num_pairs, "    used_layers# = layers#;");
    text += for_each_slot(num_cameras, "    in_picture# = picture#;");
    return text + "}\n";
}

std::string person_fragment(std::size_t num_cameras) {
    std::string text =
        "#version 330 core\nuniform sampler2DArray pictures;\n"
        "in vec3 fallback_colour;\nout vec4 fragment;\n";
    text += for_each_slot(num_cameras / 2, "flat in vec2 used_layers#;");
    text += for_each_slot(num_cameras, "in vec4 in_picture#;");
    // texels carry colour times mask, so that the sum divides out to a colour of the person alone;
    // the fallback takes over, without an edge, where weights and masks leave next to nothing
    text += "void main() {\n    vec4 sum = vec4(fallback_colour, 1.0) * 0.01;\n";
    for (std::size_t i = 0; i < num_cameras; ++i) {
        const std::string slot = std::to_string(i);
        text += "    sum += in_picture" + slot + ".w * texture(pictures, vec3(in_picture" + slot +
                ".xy / in_picture" + slot + ".z, used_layers" + std::to_string(i / 2) +
                (i % 2 == 0 ? ".x" : ".y") + "));\n";
    }
    return text + "    fragment = vec4(sum.rgb / sum.a, 1.0);\n}\n";
}

const char* const kObjectVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 place;
layout(location = 3) in mat4 world_from_mesh;
layout(location = 7) in vec4 colour_and_sectors;
uniform mat4 clip_from_world;
out vec2 p_picture;
out vec3 p_mesh;
out vec3 p_world;
out vec3 normal_world;
flat out vec3 colour;
flat out float sectors;
void main() {
    vec4 p = world_from_mesh * vec4(position, 1.0);
    p_mesh = position;
    p_picture = place;
    p_world = p.xyz;
    // where it is scaled, normals are so inversely
    mat3 linear = mat3(world_from_mesh);
    vec3 scale2 = vec3(dot(linear[0], linear[0]), dot(linear[1], linear[1]), dot(linear[2], linear[2]));
    normal_world = linear * (normal / scale2);
    colour = colour_and_sectors.rgb;
    sectors = colour_and_sectors.a;
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
flat out float sectors;
void main() {
    p_mesh = p_world = position;
    p_picture = place;
    normal_world = normal;
    colour = soft_colour;
    sectors = 0.0;
    gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

const char* const kObjectFragment = R"(#version 330 core
in vec3 p_mesh;
in vec2 p_picture;
in vec3 p_world;
in vec3 normal_world;
flat in vec3 colour;
flat in float sectors;
uniform sampler2D picture;
uniform float textured;
uniform vec3 light;
uniform vec3 eye;
out vec4 fragment;
vec3 encode(vec3 linear) {
    return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));
}
void main() {
    vec3 n = normalize(normal_world);
    // of what is seen from behind, the other side
    if (!gl_FrontFacing) n = -n;
    vec3 base = colour;
    if (textured > 0.0) {
        vec4 painted = texture(picture, p_picture);
        base = mix(base, painted.rgb, painted.a);
    }
    // lighter sectors show that a ball turns
    if (sectors > 0.0) {
        float wave = sin(atan(p_mesh.y, p_mesh.x) * sectors);
        base = mix(base, mix(base, vec3(1.0), 0.35), smoothstep(-0.05, 0.05, wave));
    }
    vec3 ambient = mix(vec3(0.22, 0.21, 0.20), vec3(0.42, 0.44, 0.48), 0.5 + 0.5 * n.z);
    float key = max(dot(n, light), 0.0) * 0.75;
    vec3 to_eye = normalize(eye - p_world);
    float shine = pow(max(dot(n, normalize(to_eye + light)), 0.0), 40.0) * 0.12;
    fragment = vec4(encode(clamp(base * (ambient + key) + shine, 0.0, 1.0)), 1.0);
}
)";

const char* const kFloorVertex = R"(#version 330 core
layout(location = 0) in vec2 corner;
uniform mat4 clip_from_world;
uniform mat4 world_from_floor;
uniform vec2 half_size;
out vec3 p_world;
out vec2 p_floor;
void main() {
    p_floor = corner * half_size;
    vec4 p = world_from_floor * vec4(p_floor, 0.0, 1.0);
    p_world = p.xyz;
    gl_Position = clip_from_world * p;
}
)";

// In encoded (sRGB) colours: darkening by a factor is, but for the ends of the curve, the same
// there, and spares three powers per pixel of what covers half the picture.
const char* const kFloorFragment = R"(#version 330 core
in vec3 p_world;
in vec2 p_floor;
uniform vec3 colour;
uniform vec3 horizon;
uniform sampler2D picture;
uniform float textured;
uniform sampler2D shadow;
uniform float shadow_extent;
uniform float shadow_strength;
uniform vec2 fade;
out vec4 fragment;
vec3 encode(vec3 linear) {
    return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));
}
void main() {
    vec3 base = colour;
    if (textured > 0.0) {
        vec4 painted = texture(picture, vec2(p_floor.x, -p_floor.y));
        base = mix(base, encode(painted.rgb), painted.a);
    }
    vec2 cell = p_floor;
    vec2 line = abs(fract(cell - 0.5) - 0.5) / max(fwidth(cell), 1e-4);
    float grid = 1.0 - min(min(line.x, line.y), 1.0);
    vec2 at = p_world.xy / shadow_extent + 0.5;
    float texel = 0.9 / 512.0;
    float dark = texture(shadow, at + vec2(texel, texel * 0.4)).r
               + texture(shadow, at + vec2(-texel * 0.4, texel)).r
               + texture(shadow, at + vec2(-texel, -texel * 0.4)).r
               + texture(shadow, at + vec2(texel * 0.4, -texel)).r;
    vec3 c = base * (1.0 - 0.10 * grid) * (1.0 - shadow_strength * dark);
    float far = clamp((dot(p_world.xy, p_world.xy) - fade.x) * fade.y, 0.0, 1.0);
    fragment = vec4(mix(c, horizon, far), 1.0);
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

// The outline is a pixel of the screen wide, around the person, however small she is there.
const char* const kSilhouetteFragment = R"(#version 330 core
in vec2 at;
uniform sampler2DArray pictures;
uniform float layer;
uniform float opacity;
uniform vec3 outline;
out vec4 fragment;
const float kInside = 0.1;  // least alpha of the mask's texels, which is less at its edge
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

// After the idea of fast approximate anti-aliasing (Lottes 2009), in its shortest form: where the
// luma of the four diagonal neighbours differs, average along the edge.
const char* const kSmoothFragment = R"(#version 330 core
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
