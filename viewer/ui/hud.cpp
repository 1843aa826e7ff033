#include "viewer/ui/hud.hpp"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr int kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                       ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoSavedSettings;
const ImVec4 kWarning{1.0f, 0.75f, 0.3f, 1.0f};
const ImVec2 kCurve{240.0f, 44.0f};

template <std::size_t Size>
void draw_curve(const char* title, const std::array<float, Size>& values, float least_top) {
    const float top = std::max(least_top, 1.1f * *std::max_element(values.begin(), values.end()));
    ImGui::PlotLines("", values.data(), static_cast<int>(Size), 0, title, 0.0f, top, kCurve);
}

void draw_losses(const HudContent& content) {
    if (content.num_skipped + content.num_incomplete + content.num_rejected == 0) return;
    ImGui::Text("skipped %llu  incomplete %llu  rejected %llu",
                static_cast<unsigned long long>(content.num_skipped),
                static_cast<unsigned long long>(content.num_incomplete),
                static_cast<unsigned long long>(content.num_rejected));
}

// Limits the number of lines, so they do not cover the picture.
void draw_lines(const std::vector<HudLine>& lines) {
    constexpr std::size_t kMostLines = 16;
    for (std::size_t i = 0; i < std::min(lines.size(), kMostLines); ++i) {
        if (lines[i].is_warning)
            ImGui::TextColored(kWarning, "%s", lines[i].text.c_str());
        else
            ImGui::TextUnformatted(lines[i].text.c_str());
    }
    if (lines.size() > kMostLines) ImGui::Text("... and %zu more", lines.size() - kMostLines);
}

}  // namespace

void draw_hud(const HudContent& content, bool has_details) {
    ImGui::SetNextWindowPos({10.0f, 10.0f});
    ImGui::SetNextWindowBgAlpha(0.6f);
    ImGui::Begin("figures", nullptr, kFlags);
    ImGui::Text("%.0f pictures/s", content.frames_per_s);
    if (!content.quality.empty())
        ImGui::TextColored(kWarning, "machine too slow: %s", content.quality.c_str());
    if (content.capture_to_display.num_samples > 0) {
        ImGui::Text("capture to display %.0f ms (99 %%: %.0f ms)",
                    content.capture_to_display.median_ms,
                    content.capture_to_display.p99_ms);
    }
    ImGui::Text("%.2f MB/s   %zu objects", 1e-6 * content.bytes_per_s, content.num_objects);
    draw_losses(content);
    draw_lines(content.sites);
    if (content.sites.empty()) ImGui::TextUnformatted("nobody is here");
    draw_lines(content.warnings);
    if (has_details) draw_lines(content.details);
    draw_curve("capture to display, ms, 30 s", content.latency_ms, 50.0f);
    draw_curve("pictures/s, 30 s", content.pictures_per_s, 60.0f);
    if (content.recording_s)
        ImGui::TextColored(kWarning, "recording, %.1f s   F9: stop", *content.recording_s);
    if (content.num_video_dropped > 0)
        ImGui::TextColored(kWarning,
                           "pictures missing in videos: %llu",
                           static_cast<unsigned long long>(content.num_video_dropped));
    if (!content.notice.empty()) ImGui::TextUnformatted(content.notice.c_str());
    ImGui::TextUnformatted("?: keys   M: menu   T: times   H: hide");
    ImGui::End();
}

void draw_keys() {
    constexpr std::array<std::pair<const char*, const char*>, 25> kKeys{{
        {"drag left, on an object", "pull it; release to throw it"},
        {"click an object", "select it; its panel edits it"},
        {"drag an arrow or a ring", "move or rotate the selected object; with Ctrl in steps"},
        {"J, C", "arrows or rings; axes of the world or of the object"},
        {"X, Y, Z while dragging", "only along or about this axis"},
        {"Ctrl-Z, Ctrl-Shift-Z", "undo, redo"},
        {"Esc", "end the drag, close the menu, select nothing, close"},
        {"drag left elsewhere", "orbit around the target"},
        {"shift and drag left", "look around"},
        {"drag right, wheel", "pan, zoom"},
        {"W A S D, Q E", "fly; down, up"},
        {"G", "walk on the floor, or fly"},
        {"1 ... 9", "look through the eyes of that person; again: leave"},
        {"F", "follow the nearest person, or stop following"},
        {"V", "return to the first viewpoint"},
        {"N", "show or hide the names of people"},
        {"M", "menu: add objects and models, save and load worlds"},
        {"Delete", "remove the selected object, else the one under the mouse"},
        {"B", "debug view: wireframe, silhouettes, collision shapes"},
        {"R", "reset all objects"},
        {"F11", "full screen on or off"},
        {"F12, P", "screenshot"},
        {"F9", "start or stop a video"},
        {"T", "show or hide stage times of sites and worlds"},
        {"H", "show or hide the statistics"},
    }};
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({0.5f * size.x, 0.5f * size.y}, 0, {0.5f, 0.5f});
    ImGui::SetNextWindowBgAlpha(0.85f);
    ImGui::Begin("keys", nullptr, kFlags);
    if (ImGui::BeginTable("keys", 2)) {
        for (const auto& [key, what] : kKeys) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(key);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(what);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace atrium::viewer
