#include "viewer/ui/fields.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace atrium::viewer {

double linear_of(float encoded) {
    const double v = static_cast<double>(std::clamp(encoded, 0.0f, 1.0f));
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

float encoded_of(double linear) {
    const double v = std::clamp(linear, 0.0, 1.0);
    return static_cast<float>(v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055);
}

int allowed_in_names(ImGuiInputTextCallbackData* data) {
    const ImWchar c = data->EventChar;
    const bool is_allowed = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                            (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '-';
    return is_allowed ? 0 : 1;
}

}  // namespace atrium::viewer
