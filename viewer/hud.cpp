#include "viewer/hud.hpp"

#include <imgui.h>

namespace atrium::viewer {

void draw_hud(const HudFigures& figures) {
    ImGui::SetNextWindowPos({10.0f, 10.0f});
    ImGui::SetNextWindowBgAlpha(0.6f);
    const int flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                      ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoSavedSettings;
    ImGui::Begin("figures", nullptr, flags);
    ImGui::Text("%.0f pictures/s", figures.frames_per_s);
    if (figures.capture_to_display.num_samples > 0) {
        ImGui::Text("capture to display %.0f ms (99 %%: %.0f ms)",
                    figures.capture_to_display.median_ms,
                    figures.capture_to_display.p99_ms);
    }
    ImGui::Text("%zu objects", figures.num_objects);
    for (const std::string& site : figures.sites) ImGui::TextUnformatted(site.c_str());
    if (figures.sites.empty()) ImGui::TextUnformatted("nobody is here");
    ImGui::Separator();
    ImGui::TextUnformatted("drag: orbit   shift-drag: look   right: pan   wheel: zoom");
    ImGui::TextUnformatted("WASD QE: fly   V: view   R: reset objects   F12: picture   H: hide");
    ImGui::End();
}

}  // namespace atrium::viewer
