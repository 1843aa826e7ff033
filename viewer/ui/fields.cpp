#include "viewer/ui/fields.hpp"

#include "core/base/allowed_mass.hpp"
#include "core/geometry/simple_volumes.hpp"
#include "viewer/ui/panel_style.hpp"

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
constexpr double kNoNumberShownS = 4.0;
constexpr std::string_view kOfNumbers = "0123456789.,-+*/eE ";  // that ImGui's fields take
constexpr float kLeastDragged = 0.01f;  // a drag moves smaller values as fast as this one

// Shows a text beside the panel, at the height of the last field, where it covers no other field.
// Without room there it lies above the field, over rows that the user has passed.
void tell_beside(const std::string& text) {
    constexpr float kLeastLetters = 8.0f;  // to break lines for
    const ImVec2 panel = ImGui::GetWindowPos();
    const float gap = panel_margin();
    const float borders = 2.0f * ImGui::GetStyle().WindowPadding.x;
    const float right = panel.x + ImGui::GetWindowSize().x + gap;
    const float room_right = ImGui::GetIO().DisplaySize.x - right - gap - borders;
    const float room_left = panel.x - 2.0f * gap - borders;
    const float row = ImGui::GetItemRectMin().y;
    const bool is_right = room_right >= std::min(room_left, text_width(text));
    float room = std::max(room_left, room_right);
    if (room < kLeastLetters * ImGui::GetFontSize()) {
        room = ImGui::GetIO().DisplaySize.x - panel.x - gap - borders;
        ImGui::SetNextWindowPos({panel.x, row - gap}, ImGuiCond_Always, {0.0f, 1.0f});
    } else {
        if (is_right) room = room_right;
        ImGui::SetNextWindowPos({is_right ? right : panel.x - gap, row},
                                ImGuiCond_Always,
                                {is_right ? 0.0f : 1.0f, 0.0f});
    }
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetStyle().WindowPadding.x +
                           std::min(room, text_width(text) + 1.0f));
    draw_wrapped(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void explain(const char* text) {
    if (ImGui::IsItemHovered() && !ImGui::IsItemActive() &&
        ImGui::GetCurrentContext()->HoveredIdTimer > kTooltipAfterS)
        tell_beside(text);
}

// Says near the last field that letters typed into it are no number: while it is typed, and for
// some seconds after. The field then keeps its values. `before`: those before this picture.
void refuse_letters(const char* title,
                    std::span<float> values,
                    const std::array<float, 3>& before) {
    auto* typed = static_cast<TypedText*>(ImGui::GetIO().UserData);
    if (typed == nullptr) return;
    if (!typed->has_before && is_number_typed()) {
        typed->before = before;
        typed->has_before = true;
    }
    if (typed->is_number) return;
    const ImGuiID field = ImGui::GetID(title);
    const double now_s = ImGui::GetTime();
    if (ImGui::IsItemActive() && typed->typed_into == ImGui::GetCurrentContext()->ActiveId) {
        typed->field = field;
        typed->until_s = now_s + kNoNumberShownS;
    }
    if (typed->field != field) return;
    if (ImGui::IsItemDeactivated() && typed->has_before)
        std::copy_n(typed->before.begin(), values.size(), values.begin());
    if (now_s < typed->until_s) tell_beside("not a number: " + typed->typed);
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

NumberRange masses_of(bus::Shape shape, const Eigen::Vector3d& size_m, double mass_kg) {
    const double volume_m3 =
        shape == bus::Shape::kSphere     ? geometry::sphere_volume(size_m.x())
        : shape == bus::Shape::kCylinder ? geometry::cylinder_volume(size_m.x(), size_m.z())
        : shape == bus::Shape::kCapsule  ? geometry::capsule_volume(size_m.x(), size_m.z())
                                         : size_m.prod();
    if (!(volume_m3 > 0.0)) return {0.0f, static_cast<float>(kMaxObjectMass_kg), "%.3f kg"};
    auto [least_kg, most_kg] = allowed_masses(volume_m3);
    if (shape >= bus::Shape::kConvex) least_kg = 0.0;
    if (mass_kg > 0.0) least_kg = std::min(least_kg, mass_kg);
    return {
        static_cast<float>(least_kg), static_cast<float>(std::max(most_kg, mass_kg)), "%.3f kg"};
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
    std::array<float, 3> before{};
    std::ranges::copy(values, before.begin());
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
    refuse_letters(title, values, before);
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

void take_typed_letters() {
    const ImGuiContext& context = *ImGui::GetCurrentContext();
    auto* typed = static_cast<TypedText*>(ImGui::GetIO().UserData);
    const bool is_typing = context.ActiveId != 0 && ImGui::TempInputIsActive(context.ActiveId);
    if (typed != nullptr && !is_typing) typed->typed_into = 0;
    if (!is_typing) return;
    if (typed != nullptr && typed->typed_into != context.ActiveId) {
        *typed = {};  // the user types another number, or anew
        typed->typed_into = context.ActiveId;
    }
    if (typed != nullptr && (is_pressed(ImGuiKey_Backspace) || is_pressed(ImGuiKey_Delete))) {
        typed->typed.clear();  // the user corrects it
        typed->is_number = true;
    }
    for (ImWchar& character : ImGui::GetIO().InputQueueCharacters) {
        if (typed != nullptr && character >= ' ' && character < 127) {
            const char letter = static_cast<char>(character);
            typed->typed += letter;
            typed->is_number &= kOfNumbers.find(letter) != std::string_view::npos;
        }
        if (character == ',') character = '.';
    }
}

}  // namespace atrium::viewer
