#pragma once

#include "core/bus/messages.hpp"

#include <Eigen/Core>

#include <array>
#include <span>
#include <string>

struct ImGuiInputTextCallbackData;

namespace atrium::viewer {

/// Linear light of an sRGB value in [0, 1], and back.
double linear_of(float encoded);
float encoded_of(double linear);

/// Filter of a text field: characters that names on the bus may not have become '_'.
int allowed_in_names(ImGuiInputTextCallbackData* data);

/// Text field for a name on the bus.
void name_field(const char* title, std::span<char> name);

/// Values of a number field.
struct NumberRange {
    float least;
    float most;
    const char* format;        // with the unit
    float step_per_px = 0.0f;  // of a drag; 0: 1 % of the value
};

/// Masses [kg] that the world server accepts for a movable object of that shape and size, and the
/// mass that it has now. Of a model only the extents are known: at most what fills them.
NumberRange masses_of(bus::Shape shape, const Eigen::Vector3d& size_m, double mass_kg);

/// Lays out a field of one or more numbers: dragged, or typed after a click. A drag stays within
/// the range. A number beyond it that is typed becomes the nearest allowed one; returns a text that
/// says so, else an empty one.
std::string number_field(const char* title, std::span<float> values, const NumberRange& range);

/// Whether the user types into the number field that was laid out last: ImGui applies each letter
/// at once.
bool is_number_typed();

/// What was typed into a number field and is no number. ImGui drops these letters and would take
/// the rest, "12" of "12x"; the window keeps them as ImGui's UserData, and the field its value.
struct TypedText {
    unsigned typed_into = 0;  // ImGui's id of the number that is typed; 0: none
    std::string typed;        // all that was typed into it
    bool is_number = true;
    unsigned field = 0;             // that shows `typed` as no number; 0: none
    std::array<float, 3> before{};  // values of the field when the user began
    bool has_before = false;
    double until_s = 0.0;
};

/// Takes the comma as a decimal point while a number is typed, and notes what is no number. Call
/// after ImGui's NewFrame.
void take_typed_letters();

}  // namespace atrium::viewer
