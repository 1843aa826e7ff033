#include "viewer/ui/edit_panel.hpp"

#include "core/geometry/roll_pitch_yaw.hpp"
#include "viewer/ui/fields.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr double kAskedS = 2.5;         // then the fields show the world again
constexpr float kWidthLetters = 23.0f;  // heights of letters
constexpr NumberRange kSizes{0.01f, 20.0f, "%.3f m", 0.005f};
constexpr NumberRange kPositions{-1000.0f, 1000.0f, "%.3f m", 0.005f};
constexpr NumberRange kAngles{-360.0f, 360.0f, "%.1f deg", 0.5f};

bool is_equal(const bus::SceneObject& a, const bus::SceneObject& b) {
    return a.object == b.object && a.name == b.name && a.size_m == b.size_m &&
           a.mass_kg == b.mass_kg && a.friction == b.friction && a.restitution == b.restitution &&
           a.colour == b.colour;
}

// Keeps the exact value of the world where the field was not touched.
double kept(float field, double value) {
    return field == static_cast<float>(value) ? value : static_cast<double>(field);
}

// Less than `shown` would be shown as 0, or as -0.
std::array<float, 3> fields_of(const Eigen::Vector3d& values, double shown) {
    std::array<float, 3> fields{};
    for (int i = 0; i < 3; ++i) {
        const double value = std::abs(values[i]) < shown ? 0.0 : values[i];
        fields[static_cast<std::size_t>(i)] = static_cast<float>(value);
    }
    return fields;
}

std::array<float, 3> position_fields(const geometry::RigidTransform& pose) {
    return fields_of(pose.translation, 0.0005);
}

std::array<float, 3> angle_fields(const geometry::RigidTransform& pose) {
    return fields_of(geometry::roll_pitch_yaw_deg(pose.rotation), 0.05);
}

// Of something of wood that fills half of its extents: for a fixed object that becomes movable.
float usual_mass_kg(const bus::SceneObject& object) {
    constexpr double kDensity = 300.0;
    constexpr double kLeast_kg = 0.001;
    return static_cast<float>(std::max(kDensity * object.size_m.prod(), kLeast_kg));
}

}  // namespace

void EditPanel::load(const bus::SceneObject& object) {
    if (object.object != seen_.object) movable_mass_kg_ = usual_mass_kg(object);
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

// Returns the problem of a number that was typed; empty: none.
std::string EditPanel::draw_fields(const bus::SceneObject& object) {
    std::string problem;
    const auto number = [&](const char* title, std::span<float> values, const NumberRange& range) {
        if (std::string found = number_field(title, values, range); !found.empty())
            problem = std::move(found);
    };
    name_field("name", name_);
    if (object.shape == bus::Shape::kBox) {
        number("size", size_m_, kSizes);
    } else if (object.shape < bus::Shape::kConvex && object.shape != bus::Shape::kPlane) {
        number("diameter", {&size_m_[0], 1}, kSizes);
        if (object.shape != bus::Shape::kSphere) number("height", {&size_m_[2], 1}, kSizes);
    }
    if (object.shape != bus::Shape::kPlane) {
        ImGui::Checkbox("fixed", &is_fixed_);
        ImGui::BeginDisabled(is_fixed_);
        number("mass",
               {&mass_kg_, 1},
               masses_of(object.shape,
                         object.size_m,
                         is_fixed_ ? static_cast<double>(mass_kg_) : object.mass_kg));
        ImGui::EndDisabled();
        if (!is_fixed_ && mass_kg_ > 0.0f) movable_mass_kg_ = mass_kg_;
    }
    number("friction", {&friction_, 1}, {0.0f, 10.0f, "%.2f", 0.005f});
    number("bounce", {&restitution_, 1}, {0.0f, 1.0f, "%.2f", 0.0025f});
    ImGui::ColorEdit3("colour", colour_.data(), ImGuiColorEditFlags_NoInputs);
    return problem;
}

geometry::RigidTransform EditPanel::typed_pose(const geometry::RigidTransform& from) const {
    geometry::RigidTransform pose = from;
    const std::array<float, 3> shown = position_fields(from);
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (position_m_[k] != shown[k]) pose.translation[i] = static_cast<double>(position_m_[k]);
    }
    if (angles_deg_ != angle_fields(from))
        pose.rotation = geometry::rotation_of_roll_pitch_yaw(
            Eigen::Map<const Eigen::Vector3f>(angles_deg_.data()).cast<double>());
    return pose;
}

// The fields follow the object until the user takes one. Returns the problem of a number that was
// typed; empty: none.
std::string EditPanel::draw_place(const EditView& edit, SurfaceEvents& events) {
    const geometry::RigidTransform from = held_ ? held_->from : edit.pose;
    if (!held_) {
        position_m_ = position_fields(from);
        angles_deg_ = angle_fields(from);
    }
    std::string problem;
    bool is_active = false;
    bool is_done = false;
    bool is_typed = false;   // a half number is no place
    bool is_allowed = true;  // a number that was typed may be beyond the range for one picture
    const auto numbers = [&](const char* title, std::span<float> values, const NumberRange& range) {
        if (std::string found = number_field(title, values, range); !found.empty())
            problem = std::move(found);
        is_allowed = is_allowed && std::ranges::all_of(values, [&](float value) {
                         return value >= range.least && value <= range.most;
                     });
        is_active = is_active || ImGui::IsItemActive();
        is_typed = is_typed || is_number_typed();
        is_done = is_done || ImGui::IsItemDeactivatedAfterEdit();
    };
    numbers("x y z", position_m_, kPositions);
    numbers("angles", angles_deg_, kAngles);
    if (!problem.empty() || !(is_active || is_done)) {
        held_.reset();
        return problem;
    }
    const geometry::RigidTransform pose = typed_pose(from);
    const bool is_changed =
        pose.translation != from.translation || pose.rotation.coeffs() != from.rotation.coeffs();
    const bool is_moved = (is_changed && !is_typed) || (held_ && held_->is_moved);
    if (is_allowed && !is_typed && (is_done || is_moved))
        events.edit.place = PlaceWanted{edit.selected->object, pose, is_active && !is_done};
    if (is_active)
        held_ = is_done ? Held{pose, false} : Held{from, is_moved};
    else
        held_.reset();
    return problem;
}

void EditPanel::draw_buttons(const EditView& edit, SurfaceEvents& events) {
    const bool is_soft = edit.selected->shape == bus::Shape::kSoft;
    if (is_soft || !edit.is_supported) {
        const Eigen::Vector3d& at = edit.pose.translation;
        ImGui::Text("x %.3f  y %.3f  z %.3f m", at.x(), at.y(), at.z());
    }
    if (is_soft) {
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
    if (!is_soft && edit.is_supported) {
        if (ImGui::Button("duplicate")) events.edit.duplicate = true;
        ImGui::SameLine();
    }
    ImGui::BeginDisabled(edit.undo.empty());
    if (ImGui::Button("undo")) events.edit.undo = true;
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(edit.redo.empty());
    if (ImGui::Button("redo")) events.edit.redo = true;
    ImGui::EndDisabled();
}

float EditPanel::width() { return kWidthLetters * ImGui::GetFontSize(); }

void EditPanel::draw(const HudContent& content, SurfaceEvents& events) {
    if (!content.edit.selected) {
        seen_ = {};
        held_.reset();
        return;
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
    begin_arranged_panel("edit", PanelKind::kInput, width());
    ImGui::PushItemWidth(-6.5f * font);
    ImGui::Text("%s (%u)", object.name.c_str(), object.object);
    std::string problem;
    if (!content.edit.is_supported)
        ImGui::TextWrapped("This world server does not know edits.");
    else if (object.shape != bus::Shape::kSoft)
        problem = draw_fields(object);
    std::string misplaced;
    if (content.edit.is_supported && object.shape != bus::Shape::kSoft)
        misplaced = draw_place(content.edit, events);
    draw_buttons(content.edit, events);
    ImGui::PopItemWidth();
    ImGui::End();
    if (!misplaced.empty()) events.edit.hint = std::move(misplaced);
    if (ImGui::IsAnyItemActive() || object.shape == bus::Shape::kSoft) return;
    if (!problem.empty()) {
        events.edit.hint = std::move(problem);
        load(object);
        return;
    }
    bus::SceneObject wanted = form();
    if (is_equal(wanted, asked_)) return;
    asked_ = wanted;
    asked_at_s_ = now_s;
    events.edit.change = std::move(wanted);
}

}  // namespace atrium::viewer
