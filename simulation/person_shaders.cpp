#include "simulation/person_shaders.hpp"

namespace atrium::simulation {

const char* const kPersonVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position_site;
layout(location = 1) in vec3 normal_site;
layout(location = 2) in vec3 position_rest;
layout(location = 3) in vec2 vertex_texture_place;
layout(location = 4) in vec3 vertex_colour;
uniform mat4 camera_from_site;
uniform vec4 focal_and_centre;   // fx, fy, cx, cy [px]
uniform float skew;
uniform vec4 radial_tangential;  // k1, k2, p1, p2
uniform float radial_3;          // k3
uniform vec2 image_size;
out vec3 place;
out vec3 normal;
out vec3 at_site;
out vec2 texture_place;
out vec3 own_colour;
void main() {
    vec3 p = (camera_from_site * vec4(position_site, 1.0)).xyz;
    vec2 n = p.xy / max(p.z, 1e-3);
    float r2 = dot(n, n);
    vec4 k = radial_tangential;
    float radial = 1.0 + r2 * (k.x + r2 * (k.y + r2 * radial_3));
    vec2 d = n * radial + vec2(2.0 * k.z * n.x * n.y + k.w * (r2 + 2.0 * n.x * n.x),
                               k.z * (r2 + 2.0 * n.y * n.y) + 2.0 * k.w * n.x * n.y);
    vec2 px = vec2(focal_and_centre.x * d.x + skew * d.y, focal_and_centre.y * d.y) + focal_and_centre.zw;
    vec2 ndc = 2.0 * (px + 0.5) / image_size - 1.0;
    const float near = 0.05;
    const float far = 30.0;
    gl_Position = vec4(ndc * p.z, ((far + near) * p.z - 2.0 * far * near) / (far - near), p.z);
    place = position_rest;
    normal = normal_site;
    at_site = position_site;
    texture_place = vertex_texture_place;
    own_colour = vertex_colour;
}
)";

const char* const kFlatFragmentShader = R"(#version 330 core
uniform vec4 value;
out vec4 fragment;
void main() { fragment = value; }
)";

const char* const kModelFragmentShader = R"(#version 330 core
in vec3 normal;
in vec3 at_site;
in vec2 texture_place;
in vec3 own_colour;
uniform sampler2D surface;
uniform int has_surface;
uniform int is_cut_out;
uniform vec3 lamp;
uniform float ambient;
uniform float diffuse;
out vec4 fragment;
void main() {
    vec3 n = normalize(normal);
    float lit = ambient * (0.88 + 0.12 * n.z) + diffuse * max(0.0, dot(n, normalize(lamp - at_site)));
    vec4 painted = has_surface == 1 ? texture(surface, texture_place) : vec4(1.0);
    if (is_cut_out == 1 && painted.a < 0.5) discard;
    vec3 colour = own_colour * painted.rgb;
    fragment = vec4(clamp(colour * (0.10 + lit), 0.0, 1.0), 1.0);
}
)";

const char* const kPersonFragmentShader = R"(#version 330 core
in vec3 place;
in vec3 normal;
in vec3 at_site;
uniform vec3 skin, hair, shirt, back, emblem_colour, sleeve_left, sleeve_right, trousers, stripe, shoes;
uniform int hair_style;  // 0 short, 1 long, 2 bun
uniform int emblem;      // 0 star, 1 seven, 2 heart, 3 rings
uniform int beard;
uniform vec3 lamp;
uniform float ambient;
uniform float diffuse;
out vec4 fragment;

const vec3 kShoulder = vec3(0.175, -0.005, 1.405);
const vec3 kArm = vec3(0.6428, 0.0, -0.7660);

float line(vec2 p, vec2 a, vec2 b) {
    vec2 along = b - a;
    return length(p - a - along * clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0));
}

// Negative inside the emblem; p is one at its rim.
float emblem_distance(vec2 p) {
    if (emblem == 0) {
        float turn = 6.2831853 / 5.0;
        float angle = mod(atan(p.x, p.y) + 0.5 * turn, turn) - 0.5 * turn;
        vec2 q = length(p) * vec2(cos(angle), abs(sin(angle)));
        vec2 tip = vec2(1.0, 0.0);
        vec2 notch = 0.42 * vec2(cos(0.5 * turn), sin(0.5 * turn));
        vec2 edge = notch - tip;
        return dot(q - tip, normalize(vec2(edge.y, -edge.x)));
    }
    if (emblem == 1) {
        return min(line(p, vec2(-0.55, 0.85), vec2(0.55, 0.85)), line(p, vec2(0.55, 0.85), vec2(-0.2, -0.9))) - 0.19;
    }
    if (emblem == 2) {
        vec2 q = vec2(abs(p.x), p.y + 0.15);
        float lobes = length(q - vec2(0.42, 0.42)) - 0.50;
        float tip = max(dot(q - vec2(0.0, -0.85), vec2(0.76, -0.65)), q.y - 0.42);
        return min(lobes, tip);
    }
    float r = length(p);
    return min(abs(r - 0.85) - 0.12, min(abs(r - 0.45) - 0.10, r - 0.12));
}

vec3 paint_arm(float t, bool right) {
    vec3 sleeve = right ? sleeve_right : sleeve_left;
    if (t > 0.515) return skin;
    if (t > 0.485) return 0.62 * sleeve;
    if (right) return t > 0.19 && t < 0.25 ? emblem_colour : sleeve;
    return fract(t * 14.0) < 0.28 && t > 0.12 ? 0.70 * sleeve + 0.30 * shirt : sleeve;
}

vec3 paint_face(vec3 p) {
    vec2 q = vec2(abs(p.x), p.z);
    vec3 c = skin;
    c = mix(c, vec3(0.85, 0.42, 0.38), 0.30 * smoothstep(0.024, 0.004, length(q - vec2(0.042, 1.588))));
    float mouth = abs(q.y - (1.5585 + 7.0 * q.x * q.x));
    bool lips = mouth < 0.0065 - 0.10 * q.x * q.x * 40.0 * 0.06 && q.x < 0.028;
    bool bearded = beard == 1 && q.y < 1.587 - 0.25 * (0.06 - min(q.x, 0.06)) && !(q.x < 0.034 && q.y > 1.548 && q.y < 1.572);
    if (bearded || (beard == 1 && abs(q.y - 1.580) < 0.006 && q.x < 0.036)) c = 0.92 * hair;
    if (lips) c = mouth < 0.0014 ? vec3(0.38, 0.10, 0.10) : vec3(0.74, 0.28, 0.27);
    vec2 eye = (q - vec2(0.0315, 1.6245)) / vec2(0.0165, 0.0095);
    if (dot(eye, eye) < 1.35) c = 0.55 * skin;
    if (dot(eye, eye) < 1.0) c = vec3(0.96);
    float iris = length(q - vec2(0.0305, 1.6245));
    if (iris < 0.0082 && dot(eye, eye) < 1.0) c = vec3(0.20, 0.36, 0.50);
    if (iris < 0.0042) c = vec3(0.04);
    if (abs(q.y - (1.6465 - 6.0 * (q.x - 0.032) * (q.x - 0.032))) < 0.0042 && q.x > 0.013 && q.x < 0.051) c = 0.7 * hair;
    return c;
}

bool is_hair(vec3 p) {
    float front = mix(0.012, 0.086, clamp((p.z - 1.60) / 0.085, 0.0, 1.0));
    if (p.z > 1.600 && p.y < front) return true;
    if (p.z > 1.692 + 0.10 * abs(p.x)) return true;
    float nape = hair_style == 1 ? 1.42 : 1.525;
    if (hair_style == 1 && p.y < -0.045 && p.z > nape && abs(p.x) < 0.13) return true;
    return p.z > nape && p.y < -0.030;
}

vec3 paint_head(vec3 p) {
    bool ear = abs(p.x) > 0.083 && abs(p.z - 1.612) < 0.030 && abs(p.y + 0.006) < 0.022 && hair_style != 1;
    if (!ear && is_hair(p)) return hair * (0.88 + 0.24 * fract(sin(floor(p.x * 260.0) * 12.9898) * 43758.5));
    return p.y > 0.02 && p.z > 1.50 ? paint_face(p) : skin;
}

vec3 paint_trunk(vec3 p) {
    if (p.z < 0.985) return p.z > 0.958 ? (abs(p.x) < 0.025 && p.y > 0.0 ? vec3(0.85, 0.72, 0.30) : vec3(0.16, 0.11, 0.08)) : trousers;
    if (p.z > 1.455) return 0.65 * shirt;
    if (p.y > -0.005) {
        vec2 q = vec2(-p.x, p.z - 1.285) / 0.078;  // as one who stands before it reads
        if (emblem_distance(q) < 0.0) return emblem_colour;
        if (abs(p.z - 1.105) < 0.018 || abs(p.z - 1.045) < 0.010) return emblem_colour;
        return shirt;
    }
    if (abs(abs(p.x) - 0.075) < 0.020) return 0.35 * back + 0.65 * emblem_colour;
    return abs(p.z - 1.36) < 0.022 ? shirt : back;
}

vec3 paint_leg(vec3 p, bool right) {
    if (p.z < 0.018) return vec3(0.92, 0.90, 0.86) * 0.9;
    if (p.z < 0.098) {
        bool lace = p.y > 0.02 && p.y < 0.10 && p.z > 0.05 && fract(p.y * 55.0) < 0.4;
        return lace ? vec3(0.95) : shoes;
    }
    float outwards = abs(p.x) - mix(0.15, 0.118, clamp((p.z - 0.1) / 0.75, 0.0, 1.0));
    if (right && outwards > 0.030 + 0.02 * p.z) return stripe;
    if (!right && abs(p.z - 0.50) < 0.055 && p.y > 0.0) return stripe;
    return p.y < -0.01 ? 0.86 * trousers : trousers;
}

vec3 paint(vec3 p) {
    bool right = p.x > 0.0;
    vec3 q = vec3(abs(p.x), p.yz);
    float t = dot(q - kShoulder, kArm);
    float off = length(q - kShoulder - t * kArm);
    if (t > 0.02 && off < 0.11 && q.x > 0.172 + 0.02 * clamp((1.37 - q.z) / 0.06, 0.0, 1.0)) return paint_arm(t, right);
    if ((p.z > 1.468 && (q.x < 0.085 || p.z > 1.51)) || (hair_style == 1 && p.z > 1.40 && p.y < -0.085)) return paint_head(p);
    return p.z > 0.90 ? paint_trunk(p) : paint_leg(p, right);
}

void main() {
    vec3 n = normalize(normal);
    float lit = ambient * (0.88 + 0.12 * n.z) + diffuse * max(0.0, dot(n, normalize(lamp - at_site)));
    fragment = vec4(paint(place) * (0.10 + lit), 1.0);
}
)";

}  // namespace atrium::simulation
