#include "viewer/ui/menu.hpp"

#include "viewer/ui/fields.hpp"
#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/ui_scale.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace atrium::viewer {
namespace {

struct ShapeChoice {
    const char* title;
    bus::Shape shape;
};
constexpr std::array<ShapeChoice, 4> kShapes{{{"ball", bus::Shape::kSphere},
                                              {"box", bus::Shape::kBox},
                                              {"cylinder", bus::Shape::kCylinder},
                                              {"capsule", bus::Shape::kCapsule}}};
constexpr double kWidth_px = 290.0;  // at scale 1
constexpr double kListHeight_px = 100.0;
constexpr NumberRange kNewSizes{0.03f, 2.0f, "%.2f m", 0.005f};

}  // namespace

void Menu::draw_new_object(SurfaceEvents& events) {
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
    for (int i = 0; i < static_cast<int>(kShapes.size()); ++i) {
        const char* title = kShapes[static_cast<std::size_t>(i)].title;
        // a new row where no further button fits
        const float width = ImGui::GetFrameHeight() + gap + ImGui::CalcTextSize(title).x;
        const float from = ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x;
        if (i > 0 && from + width <= right) ImGui::SameLine();
        ImGui::RadioButton(title, &shape_, i);
    }
    const bus::Shape shape = kShapes[static_cast<std::size_t>(shape_)].shape;
    const auto number = [&](const char* title, float& value, const NumberRange& range) {
        if (std::string problem = number_field(title, {&value, 1}, range); !problem.empty())
            events.edit.hint = std::move(problem);
    };
    if (shape == bus::Shape::kBox) {
        number("length", size_m_[0], kNewSizes);
        number("width", size_m_[1], kNewSizes);
    } else {
        number("diameter", size_m_[0], kNewSizes);
    }
    if (shape != bus::Shape::kSphere) number("height", size_m_[2], kNewSizes);
    Eigen::Vector3d size_m(static_cast<double>(size_m_[0]),
                           static_cast<double>(size_m_[1]),
                           static_cast<double>(size_m_[2]));
    number("mass", mass_kg_, masses_of(shape, size_m, 0.0));
    ImGui::ColorEdit3("colour", colour_.data(), ImGuiColorEditFlags_NoInputs);
    name_field("name", name_);
    if (!ImGui::Button("add it before the eye", {-1.0f, 0.0f})) return;
    NewObject wanted;
    wanted.shape = shape;
    for (int i = 0; i < 3; ++i) {
        wanted.size_m[i] = static_cast<double>(size_m_[static_cast<std::size_t>(i)]);
        wanted.colour[i] = linear_of(colour_[static_cast<std::size_t>(i)]);
    }
    wanted.mass_kg = static_cast<double>(mass_kg_);
    wanted.name = name_.data();
    events.add = wanted;
}

void Menu::draw_object_list(const HudContent& content, SurfaceEvents& events) {
    const auto& objects = content.objects;
    const std::uint32_t selected = content.edit.selected ? content.edit.selected->object : 0;
    const bool is_newly_chosen = std::exchange(chosen_, selected) != selected && selected != 0;
    ImGui::Text("%zu objects", objects.size());
    const ObjectLine* chosen = nullptr;
    if (ImGui::BeginListBox("##things", {-1.0f, ui_px(kListHeight_px)})) {
        if (is_newly_chosen) {
            const auto at = std::ranges::find(objects, selected, &ObjectLine::object);
            const auto line = static_cast<float>(at - objects.begin());
            ImGui::SetScrollY(line * ImGui::GetTextLineHeightWithSpacing() -
                              0.4f * ui_px(kListHeight_px));
        }
        // lay out only the visible ones of thousands
        ImGuiListClipper clipper;
        clipper.Begin(static_cast<int>(objects.size()));
        while (clipper.Step()) {
            for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
                const ObjectLine& line = objects[static_cast<std::size_t>(i)];
                if (ImGui::Selectable(line.text.c_str(), line.object == chosen_))
                    events.edit.select = line.object;
            }
        }
        clipper.End();
        ImGui::EndListBox();
    }
    for (const ObjectLine& line : objects) {
        if (line.object == chosen_) chosen = &line;
    }
    ImGui::BeginDisabled(chosen == nullptr);
    const std::string title =
        (chosen == nullptr ? "remove the selected object" : "remove " + chosen->text) + "###remove";
    if (ImGui::Button(title.c_str(), {-1.0f, 0.0f}) && chosen != nullptr) {
        events.remove = chosen_;
    }
    ImGui::EndDisabled();
    ImGui::TextWrapped("Delete: remove the selected object, else the one under the mouse");
}

float Menu::width() { return ui_px(kWidth_px); }

void Menu::draw(const HudContent& content, SurfaceEvents& events) {
    begin_arranged_panel("menu", PanelKind::kInput, width());
    ImGui::PushItemWidth(-ui_px(80.0));
    ImGui::TextColored(kHintColour, "M: close the menu");
    // undo does not bring back what a reset takes from everybody
    if (ImGui::Button(
            asks_reset_ ? "reset everybody's objects?###reset" : "reset all objects###reset",
            {-1.0f, 0.0f})) {
        events.reset_scene = asks_reset_;
        asks_reset_ = !asks_reset_;
    } else if (asks_reset_ && ImGui::IsAnyItemActive() && !ImGui::IsItemActive()) {
        asks_reset_ = false;
    }
    ImGui::Separator();
    draw_new_object(events);
    ImGui::Separator();
    draw_object_list(content, events);
    worlds_.draw(content, events);
    ImGui::PopItemWidth();
    ImGui::End();
}

}  // namespace atrium::viewer
