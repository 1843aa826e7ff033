#include "viewer/ui/edit_panel.hpp"

#include "viewer/ui/fields.hpp"

#include <imgui.h>

#include <algorithm>
#include <cstring>

namespace atrium::viewer {
namespace {

constexpr double kAskedS = 2.5;  // then the fields show the world again

bool is_equal(const bus::SceneObject& a, const bus::SceneObject& b) {
    return a.object == b.object && a.name == b.name && a.size_m == b.size_m &&
           a.mass_kg == b.mass_kg && a.friction == b.friction && a.restitution == b.restitution &&
           a.colour == b.colour;
}

// Keeps the exact value of the world where the field was not touched.
double kept(float field, double value) {
    return field == static_cast<float>(value) ? value : static_cast<double>(field);
}

}  // namespace

void EditPanel::load(const bus::SceneObject& object) {
    seen_ = asked_ = object;
    std::snprintf(name_.data(), name_.size(), "%s", object.name.c_str());
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        size_m_[k] = static_cast<float>(object.size_m[i]);
        colour_[k] = encoded_of(object.colour[i]);
    }
    is_fixed_ = object.mass_kg == 0.0;
    mass_kg_ = is_fixed_ ? movable_mass_kg_ : static_cast<float>(object.mass_kg);
    friction_ = static_cast<float>(object.friction);
    restitution_ = static_cast<float>(object.restitution);
}

bus::SceneObject EditPanel::form() const {
    bus::SceneObject form = seen_;
    if (name_[0] != '\0') form.name = name_.data();
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        form.size_m[i] = kept(size_m_[k], seen_.size_m[i]);
        if (colour_[k] != encoded_of(seen_.colour[i])) form.colour[i] = linear_of(colour_[k]);
    }
    const bool is_round = form.shape != bus::Shape::kBox && form.shape != bus::Shape::kPlane;
    if (is_round && form.shape < bus::Shape::kConvex) {
        form.size_m.y() = form.size_m.x();
        if (form.shape == bus::Shape::kSphere) form.size_m.z() = form.size_m.x();
    }
    form.mass_kg = is_fixed_ ? 0.0 : kept(mass_kg_, seen_.mass_kg);
    form.friction = kept(friction_, seen_.friction);
    form.restitution = kept(restitution_, seen_.restitution);
    return form;
}

void EditPanel::draw_fields(const bus::SceneObject& object) {
    constexpr auto kClamp = ImGuiSliderFlags_AlwaysClamp;
    ImGui::InputText("name",
                     name_.data(),
                     name_.size(),
                     ImGuiInputTextFlags_CallbackCharFilter,
                     &allowed_in_names);
    const float step = 0.005f;
    if (object.shape == bus::Shape::kBox) {
        ImGui::DragFloat3("size", size_m_.data(), step, 0.01f, 20.0f, "%.3f m", kClamp);
    } else if (object.shape < bus::Shape::kConvex && object.shape != bus::Shape::kPlane) {
        ImGui::DragFloat("diameter", &size_m_[0], step, 0.01f, 20.0f, "%.3f m", kClamp);
        if (object.shape != bus::Shape::kSphere)
            ImGui::DragFloat("height", &size_m_[2], step, 0.01f, 20.0f, "%.3f m", kClamp);
    }
    if (object.shape != bus::Shape::kPlane) {
        ImGui::Checkbox("fixed", &is_fixed_);
        ImGui::BeginDisabled(is_fixed_);
        ImGui::DragFloat("mass",
                         &mass_kg_,
                         0.02f,
                         0.001f,
                         10000.0f,
                         "%.3f kg",
                         kClamp | ImGuiSliderFlags_Logarithmic);
        ImGui::EndDisabled();
        if (!is_fixed_) movable_mass_kg_ = mass_kg_;
    }
    ImGui::SliderFloat("friction", &friction_, 0.0f, 2.0f, "%.2f");
    friction_ = std::clamp(friction_, 0.0f, 10.0f);
    ImGui::SliderFloat("bounce", &restitution_, 0.0f, 1.0f, "%.2f", kClamp);
    ImGui::ColorEdit3("colour", colour_.data(), ImGuiColorEditFlags_NoInputs);
}

void EditPanel::draw_place(const HudContent& content, SurfaceEvents& events) {
    const EditView& edit = content.edit;
    const Eigen::Vector3d& at = edit.pose.translation;
    ImGui::Text("x %.3f  y %.3f  z %.3f m", at.x(), at.y(), at.z());
    if (edit.selected->shape == bus::Shape::kSoft) {
        ImGui::TextWrapped("A soft object can be pulled and removed.");
    } else {
        const bool moves = edit.handles.mode == HandleMode::kMove;
        if (ImGui::Button(moves ? "J: rotate" : "J: move")) events.edit.next_handles = true;
        ImGui::SameLine();
        if (ImGui::Button(edit.handles.is_local ? "C: world axes" : "C: its own axes"))
            events.edit.local_axes = true;
    }
    if (ImGui::Button("remove")) events.remove = edit.selected->object;
    ImGui::SameLine();
    ImGui::BeginDisabled(edit.undo.empty());
    if (ImGui::Button("undo")) events.edit.undo = true;
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(edit.redo.empty());
    if (ImGui::Button("redo")) events.edit.redo = true;
    ImGui::EndDisabled();
}

float EditPanel::draw(const HudContent& content, float left, SurfaceEvents& events) {
    if (!content.edit.selected) {
        seen_ = {};
        return left;
    }
    const bus::SceneObject& object = *content.edit.selected;
    const double now_s = ImGui::GetTime();
    const bool is_answered = now_s - asked_at_s_ > kAskedS;
    const bool is_new = object.object != seen_.object;
    if (is_new || (!is_equal(object, seen_) && !ImGui::IsAnyItemActive()) ||
        (is_answered && !is_equal(asked_, seen_))) {
        load(object);
        asked_at_s_ = -1e9;
    }
    const float font = ImGui::GetFontSize();
    place_below(left);
    ImGui::SetNextWindowSize({23.0f * font, 0.0f});
    ImGui::SetNextWindowBgAlpha(0.85f);
    ImGui::Begin("edit",
                 nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    ImGui::PushItemWidth(-6.5f * font);
    ImGui::Text("%s (%u)", object.name.c_str(), object.object);
    if (!content.edit.is_supported)
        ImGui::TextWrapped("This world server does not know edits.");
    else if (object.shape != bus::Shape::kSoft)
        draw_fields(object);
    draw_place(content, events);
    ImGui::PopItemWidth();
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowSize().x;
    ImGui::End();
    if (ImGui::IsAnyItemActive() || object.shape == bus::Shape::kSoft) return right;
    bus::SceneObject wanted = form();
    if (is_equal(wanted, asked_)) return right;
    asked_ = wanted;
    asked_at_s_ = now_s;
    events.edit.change = std::move(wanted);
    return right;
}

}  // namespace atrium::viewer
