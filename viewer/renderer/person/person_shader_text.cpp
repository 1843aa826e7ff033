#include "viewer/renderer/person/person_shader_text.hpp"

#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/outline_strip.hpp"
#include "viewer/renderer/person/person_rows.hpp"

#include <algorithm>

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
    text += "void main() {\n    vec4 sum = vec4(fallback_colour, 1.0) * " +
            std::to_string(kFallbackWeight) + ";\n";
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

std::string outline_strip_fragment() {
    std::string text =
        "#version 330 core\nuniform sampler2DArray pictures;\nuniform float opacity;\n"
        "in vec3 fallback_colour;\nout vec4 fragment;\nflat in " +
        layers_type(kStripCameras) + " used_layers0;\n" +
        for_each_slot(kStripCameras, "in vec4 in_picture#;") +
        "void main() {\n    float seen = 0.0;\n";
    // texels at the outline of a mask have little alpha, but show the person
    text += for_each_slot(kStripCameras,
                          "    seen += in_picture#.w * min(texture(pictures, vec3(in_picture#.xy / "
                          "in_picture#.z, used_layers0[#])).a * " +
                              std::to_string(255.0 / kOutlineAlpha) + ", 1.0);");
    return text +
           "    float alpha = opacity * max(2.0 * seen - 1.0, 0.0);\n"
           "    fragment = vec4(fallback_colour * alpha, alpha);\n}\n";
}

}  // namespace atrium::renderer::shaders
