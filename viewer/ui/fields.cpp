#include "viewer/ui/fields.hpp"

#include <fmt/format.h>
#include <imgui.h>
// for the id of a number that is typed, and the time that the mouse rests on a field
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace atrium::viewer {
namespace {

constexpr float kTooltipAfterS = 0.6f;
constexpr float kLeastDragged = 0.01f;  // a drag moves smaller values as fast as this one

void explain(const char* text) {
    if (ImGui::IsItemHovered() && !ImGui::IsItemActive() &&
        ImGui::GetCurrentContext()->HoveredIdTimer > kTooltipAfterS)
        ImGui::SetTooltip("%s", text);
}

std::string number_text(float value, const NumberRange& range) {
    const std::string_view format = range.format;
    const auto unit = format.find(' ');
    return fmt::format("{:g}{}", value, unit == std::string_view::npos ? "" : format.substr(unit));
}

}  // namespace

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
    if (!is_allowed) data->EventChar = '_';
    return 0;
}

void name_field(const char* title, std::span<char> name) {
    ImGui::InputText(
        title, name.data(), name.size(), ImGuiInputTextFlags_CallbackCharFilter, &allowed_in_names);
    explain("letters, digits, _ . -; other characters become _");
}

std::string number_field(const char* title, std::span<float> values, const NumberRange& range) {
    const float largest = *std::ranges::max_element(values);
    const float step =
        range.step_per_px > 0.0f ? range.step_per_px : 0.01f * std::max(largest, kLeastDragged);
    if (values.size() == 1)
        ImGui::DragFloat(title, values.data(), step, range.least, range.most, range.format);
    else
        ImGui::DragScalarN(title,
                           ImGuiDataType_Float,
                           values.data(),
                           static_cast<int>(values.size()),
                           step,
                           &range.least,
                           &range.most,
                           range.format);
    explain("drag it; a click, a double click or Ctrl+click types a number");
    if (ImGui::IsItemActive()) return {};
    std::string problem;
    for (float& value : values) {
        if (value >= range.least && value <= range.most) continue;
        const std::string_view shown = title;
        problem = fmt::format("{} must be {} to {}, not {:g}",
                              shown.substr(0, shown.find("##")),
                              number_text(range.least, range),
                              number_text(range.most, range),
                              value);
        value = value > range.most ? range.most : range.least;
    }
    return problem;
}

bool is_number_typed() {
    const ImGuiContext& context = *ImGui::GetCurrentContext();
    return ImGui::IsItemActive() && context.ActiveId != 0 &&
           ImGui::TempInputIsActive(context.ActiveId);
}

void take_commas_as_points() {
    const ImGuiContext& context = *ImGui::GetCurrentContext();
    if (context.ActiveId == 0 || !ImGui::TempInputIsActive(context.ActiveId)) return;
    for (ImWchar& character : ImGui::GetIO().InputQueueCharacters)
        if (character == ',') character = '.';
}

}  // namespace atrium::viewer
