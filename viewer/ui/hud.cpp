#include "viewer/ui/hud.hpp"

#include "viewer/ui/curve.hpp"
#include "viewer/ui/keys.hpp"
#include "viewer/ui/local_time.hpp"
#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/ui_scale.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace atrium::viewer {
namespace {

constexpr double kHistory_s = 30.0;
// The short panel stays this small, so it does not cover people.
constexpr double kLineWidth_px = 330.0;  // at scale 1; longer lines are wrapped
constexpr double kTwoListsFrom_px = 900.0;
constexpr double kDetailWidth_px = 460.0;
constexpr float kKeysShare = 0.95f;  // of the picture's width
constexpr std::size_t kMostWarnings = 2;

void draw_warning(const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, kWarningColour);
    draw_wrapped(text);
    ImGui::PopStyleColor();
}

void draw_losses(const HudContent& content) {
    if (content.num_skipped + content.num_incomplete + content.num_rejected == 0) return;
    ImGui::Text("skipped %llu  incomplete %llu  rejected %llu",
                static_cast<unsigned long long>(content.num_skipped),
                static_cast<unsigned long long>(content.num_incomplete),
                static_cast<unsigned long long>(content.num_rejected));
}

void draw_sites(const HudContent& content) {
    const auto num_people =
        std::ranges::count_if(content.sites, [](const SiteLine& line) { return line.number > 0; });
    if (num_people == 0) {
        const std::string who = nobody_text(content);
        const auto& heard = content.other_worlds.heard;
        const std::string others =
            heard.empty() ? "" : fmt::format(" ({})", fmt::join(heard, ", "));
        draw_wrapped(who + (content.has_other_worlds ? "   Backspace: other worlds" + others : ""));
    }
    if (!content.left.empty()) draw_warning(content.left);
    const auto num_hidden =
        std::ranges::count_if(content.sites, [](const SiteLine& line) { return !line.is_shown; });
    if (num_hidden > 0)
        draw_warning(
            fmt::format("{} {} hidden (L)", num_hidden, num_hidden == 1 ? "site is" : "sites are"));
    if (!content.bad_files.missing.empty())
        draw_warning(content.bad_files.missing +
                     " is missing, damaged or closed: see the log, --viewer.models");
    if (!content.bad_files.differing.empty())
        draw_warning(content.bad_files.differing +
                     " differs: the world's server has another version, see the log");
    for (const SiteLine& line : content.sites)
        if (line.number > 0 && line.is_warning) draw_warning(line.name + ": " + line.state);
}

// The short panel shows the first of them without their details, and not that this viewer is slow:
// its reduced quality says so.
void draw_warnings(const HudContent& content, bool has_details) {
    std::size_t num = 0;
    std::size_t num_left = 0;
    for (const HudLine& line : content.warnings) {
        const bool is_said =
            !content.quality.empty() && line.text.starts_with("this viewer: machine too slow");
        if (has_details)
            draw_warning(line.text);
        else if (!is_said && num++ < kMostWarnings)
            draw_warning(line.text.substr(0, line.text.find(';')));
        else if (!is_said)
            ++num_left;
    }
    if (num_left > 0) draw_warning(fmt::format("... and {} more (T)", num_left));
}

void draw_recording(const HudContent& content, bool has_details) {
    if (content.recording_s)
        draw_warning(fmt::format("recording, {:.1f} s at {:g} pictures/s   F9: stop",
                                 *content.recording_s,
                                 content.video_fps));
    if (!content.live.empty()) draw_warning(content.live);
    // the message at the end of a video tells its own
    const bool is_running = content.recording_s || !content.live.empty();
    if (content.num_video_dropped > 0 && (is_running || has_details))
        draw_warning(
            fmt::format("pictures missing in videos and streams: {}", content.num_video_dropped));
}

void draw_details(const HudContent& content) {
    if (content.capture_to_display.num_samples > 0) {
        ImGui::Text("capture to display %.0f ms (99 %%: %.0f ms)",
                    content.capture_to_display.median_ms,
                    content.capture_to_display.p99_ms);
    }
    ImGui::Text("%.2f MB/s   %zu objects", 1e-6 * content.bytes_per_s, content.num_objects);
    draw_losses(content);
    draw_curve("capture to display", "ms", content.latency_ms, 50.0f, kHistory_s);
    draw_curve("drawing", "pictures/s", content.pictures_per_s, 20.0f, kHistory_s);
    for (const SiteLine& line : content.sites)
        ImGui::TextUnformatted(
            fmt::format("{}: {} meshes  {}", line.name, line.rate, line.state).c_str());
    for (const HudLine& line : content.details) ImGui::TextUnformatted(line.text.c_str());
}

void draw_cell(std::string_view text, bool is_key) {
    if (is_key) ImGui::PushStyleColor(ImGuiCol_Text, kWarningColour);
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(text.data(), text.data() + text.size());
    ImGui::PopTextWrapPos();
    if (is_key) ImGui::PopStyleColor();
}

}  // namespace

std::string nobody_text(const HudContent& content) {
    const std::size_t num_sites = content.sites.size();
    const std::size_t num_preparing = content.preparing.size();
    if (num_sites + num_preparing == 0) return "nobody is here";
    std::string text;
    if (num_sites > 0)
        text = fmt::format("{} {}, {}",
                           num_sites,
                           num_sites == 1 ? "site" : "sites",
                           content.num_rejected == 0
                               ? "no people yet"
                               : "whose people are refused: the log says why (person_rejected)");
    if (num_preparing > 0) {
        text += fmt::format("{}{} {} {} preparing",
                            text.empty() ? "" : "; ",
                            num_preparing == 1 ? "site" : "sites",
                            fmt::join(content.preparing, ", "),
                            num_preparing == 1 ? "is" : "are");
    }
    return text;
}

void draw_hud(const HudContent& content, const HudForm& form) {
    const bool has_details = form.has_details;
    const bool takes_mouse = has_details || form.scrolls;
    begin_arranged_panel("figures", takes_mouse ? PanelKind::kInput : PanelKind::kText);
    // nor does a narrow place cut it
    const ImGuiStyle& style = ImGui::GetStyle();
    const float room =
        form.widest_px - 2.0f * style.WindowPadding.x - (takes_mouse ? style.ScrollbarSize : 0.0f);
    ImGui::PushTextWrapPos(style.WindowPadding.x +
                           std::min(room, ui_px(has_details ? kDetailWidth_px : kLineWidth_px)));
    std::string summary = content.world.empty() ? "" : content.world + "   ";
    summary += fmt::format("{:.0f} pictures/s", content.frames_per_s);
    if (content.timeline)
        summary += "   recorded " + local_time_text(content.timeline->recorded);
    else if (content.capture_to_display.num_samples > 0)
        summary += fmt::format("   {:.0f} ms old", content.capture_to_display.median_ms);
    draw_wrapped(summary);
    if (!content.quality.empty()) draw_warning("machine too slow: " + content.quality);
    if (!content.inside.empty())
        draw_wrapped("through the eyes of " + content.inside + "   Esc: leave");
    if (!content.followed.empty()) draw_wrapped("following " + content.followed + "   F: stop");
    draw_sites(content);
    draw_warnings(content, has_details);
    if (has_details) draw_details(content);
    draw_recording(content, has_details);
    ImGui::TextColored(kHintColour, "F1, ?: keys   T: %s   H: hide", has_details ? "less" : "more");
    ImGui::PopTextWrapPos();
    ImGui::End();
}

void draw_question(Action action) {
    draw_message("question",
                 Corner::kMiddle,
                 action == Action::kReset        ? "R again: reset all objects, for everybody"
                 : action == Action::kOtherWorld ? "Backspace again: leave this world   "
                                                   "Delete: remove the object"
                                                 : "Esc again: close the viewer");
}

void draw_keys() {
    begin_panel("keys", Corner::kMiddle, kKeysShare, PanelKind::kCover);
    // two lists beside each other where there is room, so that a low window shows all
    const float picture = ImGui::GetIO().DisplaySize.x;
    const std::size_t num_lists = picture >= ui_px(kTwoListsFrom_px) ? 2 : 1;
    const auto bindings = key_bindings();
    const std::size_t num_rows = (bindings.size() + num_lists - 1) / num_lists;
    std::array<float, 2> widths{};
    for (const KeyBinding& binding : bindings) {
        widths[0] = std::max(widths[0], text_width(binding.shown));
        widths[1] = std::max(widths[1], text_width(binding.what));
    }
    // a narrow window wraps the explanations
    const ImGuiStyle& style = ImGui::GetStyle();
    const float inside = kKeysShare * picture - 2.0f * style.WindowPadding.x - style.ScrollbarSize;
    const float room = inside / static_cast<float>(num_lists) - 4.0f * style.CellPadding.x;
    widths[0] = std::min(widths[0], 0.5f * room);
    widths[1] = std::min(widths[1], room - widths[0]);
    if (ImGui::BeginTable(
            "keys", 2 * static_cast<int>(num_lists), ImGuiTableFlags_SizingFixedFit)) {
        for (std::size_t i = 0; i < 2 * num_lists; ++i)
            ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, widths[i % 2]);
        for (std::size_t row = 0; row < num_rows; ++row) {
            for (std::size_t i = row; i < num_lists * num_rows; i += num_rows) {
                for (int column = 0; column < 2; ++column) {
                    ImGui::TableNextColumn();
                    if (i >= bindings.size()) continue;
                    draw_cell(column == 0 ? bindings[i].shown : bindings[i].what, column == 0);
                }
            }
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace atrium::viewer
