#include "viewer/ui/curve.hpp"

#include "viewer/ui/ui_scale.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace atrium::viewer {
namespace {

constexpr double kCurveWidth_px = 240.0;  // at scale 1
constexpr double kCurveHeight_px = 48.0;

constexpr std::ptrdiff_t kLongestGap = 4;  // values that may be missing within a line

const ImU32 kGroundColour = IM_COL32(255, 255, 255, 18);
const ImU32 kGridColour = IM_COL32(255, 255, 255, 60);
const ImU32 kCurveColour = IM_COL32(120, 200, 255, 255);
const ImU32 kScaleColour = IM_COL32(200, 200, 205, 255);

// Writes `text` so that it ends at `right`, with its middle at height `y`.
void write_before(ImDrawList& list, float right, float y, const std::string& text) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    list.AddText({right - size.x, y - 0.5f * size.y}, kScaleColour, text.c_str());
}

}  // namespace

float top_of_scale(float largest) {
    if (!(largest > 0.0f) || !std::isfinite(largest)) return 1.0f;
    const double decade = std::pow(10.0, std::floor(std::log10(static_cast<double>(largest))));
    for (const double step : {1.0, 2.0, 5.0, 10.0}) {
        if (static_cast<float>(step * decade) >= largest) return static_cast<float>(step * decade);
    }
    return static_cast<float>(10.0 * decade);
}

void draw_curve(const char* title,
                const char* unit,
                std::span<const float> values,
                float least_top,
                double seconds) {
    if (values.size() < 2) return;
    const float top =
        top_of_scale(std::max(least_top, *std::max_element(values.begin(), values.end())));
    const auto newest =
        std::find_if(values.rbegin(), values.rend(), [](float value) { return value > 0.0f; });
    if (newest != values.rend() && newest - values.rbegin() <= kLongestGap)
        ImGui::Text("%s: %.0f %s", title, static_cast<double>(*newest), unit);
    else
        ImGui::Text("%s: none", title);
    const std::string top_text = fmt::format("{:.0f} {}", top, unit);
    const float line = ImGui::GetTextLineHeight();
    const float gap = ui_px(5.0);
    const float scale_width = ImGui::CalcTextSize("5000 pictures/s").x;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 low{at.x + scale_width + gap, at.y + 0.5f * line};
    const ImVec2 high{low.x + ui_px(kCurveWidth_px), low.y + ui_px(kCurveHeight_px)};
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(low, high, kGroundColour);
    for (const float share : {0.0f, 0.5f, 1.0f}) {
        const float y = low.y + share * (high.y - low.y);
        list.AddLine({low.x, y}, {high.x, y}, kGridColour, std::max(1.0f, ui_px(1.0)));
    }
    write_before(list, low.x - gap, low.y, top_text);
    write_before(list, low.x - gap, high.y, "0");
    const auto point = [&](std::size_t i) {
        const float along = static_cast<float>(i) / static_cast<float>(values.size() - 1);
        const float up = std::clamp(values[i] / top, 0.0f, 1.0f);
        return ImVec2{low.x + along * (high.x - low.x), high.y - up * (high.y - low.y)};
    };
    std::optional<std::size_t> before;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] <= 0.0f) continue;
        if (before && static_cast<std::ptrdiff_t>(i - *before) <= kLongestGap)
            list.AddLine(point(*before), point(i), kCurveColour, ui_px(1.5));
        before = i;
    }
    const std::string ago = fmt::format("{:.0f} s ago", seconds);
    list.AddText({low.x, high.y + 0.2f * line}, kScaleColour, ago.c_str());
    const ImVec2 now_size = ImGui::CalcTextSize("now");
    list.AddText({high.x - now_size.x, high.y + 0.2f * line}, kScaleColour, "now");
    ImGui::Dummy({high.x - at.x, high.y - at.y + 1.4f * line});
}

}  // namespace atrium::viewer
