#include "viewer/ui/timeline_panel.hpp"

#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/ui_scale.hpp"

#include <fmt/format.h>
#include <glad/gl.h>
#include <imgui.h>

#include <algorithm>

namespace atrium::viewer {
namespace {

using PlaybackAsk = PlaybackEvent::Kind;
using std::chrono::nanoseconds;

constexpr double kStripHeight_px = 34.0;  // at scale 1
constexpr ImU32 kStripColour = IM_COL32(60, 64, 70, 255);
constexpr ImU32 kOutsideColour = IM_COL32(20, 22, 25, 170);
constexpr ImU32 kMarkColour = IM_COL32(255, 190, 70, 255);
constexpr ImU32 kHeadColour = IM_COL32(255, 255, 255, 255);
constexpr std::array<double, 6> kSpeeds{0.1, 0.25, 0.5, 1.0, 2.0, 4.0};

void ask(SurfaceEvents& events, PlaybackEvent event) { events.playback.push_back(event); }

// A button with a hint; true if it is pressed.
bool button(const char* label, const char* hint) {
    const bool is_pressed_now = ImGui::Button(label);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", hint);
    ImGui::SameLine();
    return is_pressed_now;
}

}  // namespace

void TimelinePanel::load_thumbnails(const TimelineContent& content) {
    if (content.thumbnails == nullptr) return;
    const std::size_t revision = content.thumbnails->revision();
    if (revision == loaded_revision_) return;
    loaded_revision_ = revision;
    const std::vector<Thumbnail> all = content.thumbnails->all();
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].rgba.empty() || textures_[i] != 0) continue;
        glGenTextures(1, &textures_[i]);
        glBindTexture(GL_TEXTURE_2D, textures_[i]);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTexImage2D(GL_TEXTURE_2D,
                     0,
                     GL_RGBA8,
                     Thumbnail::kWidth,
                     Thumbnail::kHeight,
                     0,
                     GL_RGBA,
                     GL_UNSIGNED_BYTE,
                     all[i].rgba.data());
        glBindTexture(GL_TEXTURE_2D, 0);
    }
}

void TimelinePanel::draw_strip(const TimelineContent& content, SurfaceEvents& events) {
    const recording::PlayState& state = content.state;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 size{std::max(1.0f, ImGui::GetContentRegionAvail().x), ui_px(kStripHeight_px)};
    ImGui::InvisibleButton("##strip", size);
    const double duration = std::max(1.0, static_cast<double>(state.duration.count()));
    const auto place = [&](nanoseconds time) {
        return at.x + size.x * static_cast<float>(static_cast<double>(time.count()) / duration);
    };
    const auto time_at = [&](float x) {
        const double share = std::clamp((x - at.x) / size.x, 0.0f, 1.0f);
        return nanoseconds(static_cast<std::int64_t>(share * duration));
    };
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 end{at.x + size.x, at.y + size.y};
    list.AddRectFilled(at, end, kStripColour);
    // As many as fit in their own shape, evenly.
    const float shape = static_cast<float>(Thumbnail::kWidth) / Thumbnail::kHeight;
    const auto num = static_cast<std::size_t>(
        std::clamp(size.x / (size.y * shape), 1.0f, static_cast<float>(Thumbnails::kNum)));
    const float width = size.x / static_cast<float>(num);
    for (std::size_t i = 0; i < num; ++i) {
        const std::size_t number = (2 * i + 1) * Thumbnails::kNum / (2 * num);
        if (textures_[number] == 0) continue;
        const float middle = at.x + (static_cast<float>(i) + 0.5f) * width;
        const float half = std::min(width, size.y * shape) / 2.0f;
        list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(textures_[number])),
                      {middle - half, at.y},
                      {middle + half, end.y});
    }
    if (state.in.count() > 0 || state.out < state.duration) {
        list.AddRectFilled(at, {place(state.in), end.y}, kOutsideColour);
        list.AddRectFilled({place(state.out), at.y}, end, kOutsideColour);
        for (const nanoseconds mark : {state.in, state.out})
            list.AddLine({place(mark), at.y}, {place(mark), end.y}, kMarkColour, ui_px(2.0));
    }
    list.AddLine({place(state.time), at.y - ui_px(2.0)},
                 {place(state.time), end.y + ui_px(2.0)},
                 kHeadColour,
                 ui_px(2.0));
    const float mouse_x = ImGui::GetIO().MousePos.x;
    if (ImGui::IsItemHovered() || ImGui::IsItemActive())
        ImGui::SetTooltip("%s", recording::position_text(time_at(mouse_x)).c_str());
    // While it is dragged only where the mouse has moved: each jump costs time.
    const bool scrubs =
        ImGui::IsItemActivated() || (ImGui::IsItemActive() && ImGui::GetIO().MouseDelta.x != 0.0f);
    if (scrubs) ask(events, {.kind = PlaybackAsk::kSeek, .time = time_at(mouse_x)});
}

void TimelinePanel::draw_buttons(const TimelineContent& content, SurfaceEvents& events) {
    const recording::PlayState& state = content.state;
    if (button(state.is_playing ? "pause###play" : "play###play", "Space"))
        ask(events, {.kind = PlaybackAsk::kToggle});
    if (button("<", "one frame back: ,")) ask(events, {.kind = PlaybackAsk::kStep, .number = -1});
    if (button(">", "one frame on: .")) ask(events, {.kind = PlaybackAsk::kStep, .number = 1});
    ImGui::AlignTextToFramePadding();
    ImGui::Text("%s / %s",
                recording::position_text(state.time).c_str(),
                recording::position_text(state.duration).c_str());
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ui_px(64.0));
    if (ImGui::BeginCombo("##speed", fmt::format("x{:g}", state.speed).c_str())) {
        for (const double speed : kSpeeds) {
            if (ImGui::Selectable(fmt::format("x{:g}", speed).c_str(), speed == state.speed))
                ask(events, {.kind = PlaybackAsk::kSpeed, .factor = speed});
        }
        ImGui::EndCombo();
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("speed: - and +");
    ImGui::SameLine();
    bool loops = state.loops;
    if (ImGui::Checkbox("loop", &loops)) ask(events, {.kind = PlaybackAsk::kToggleLoop});
    ImGui::SameLine();
    if (button("in", "begin here: [")) ask(events, {.kind = PlaybackAsk::kMarkIn});
    if (button("out", "end here: ]")) ask(events, {.kind = PlaybackAsk::kMarkOut});
    const bool has_marks = state.in.count() > 0 || state.out < state.duration;
    ImGui::BeginDisabled(!has_marks);
    if (button("all", "no marks")) ask(events, {.kind = PlaybackAsk::kClearMarks});
    ImGui::EndDisabled();
    if (has_marks) {
        ImGui::AlignTextToFramePadding();
        ImGui::TextColored(kHintColour,
                           "%s to %s",
                           recording::position_text(state.in).c_str(),
                           recording::position_text(state.out).c_str());
        ImGui::SameLine();
    }
    ImGui::NewLine();
}

void TimelinePanel::draw(const TimelineContent& content, SurfaceEvents& events) {
    load_thumbnails(content);
    const ImVec2 picture = ImGui::GetIO().DisplaySize;
    const float margin = panel_margin();
    ImGui::SetNextWindowPos({margin, picture.y - margin}, ImGuiCond_Always, {0.0f, 1.0f});
    ImGui::SetNextWindowSize({picture.x - 2.0f * margin, 0.0f});
    ImGui::SetNextWindowBgAlpha(0.85f);
    ImGui::Begin("timeline",
                 nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_AlwaysAutoResize);
    draw_strip(content, events);
    draw_buttons(content, events);
    height_px_ = ImGui::GetWindowHeight() + margin;
    ImGui::End();
}

}  // namespace atrium::viewer
