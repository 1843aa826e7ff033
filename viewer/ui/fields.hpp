#pragma once

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

/// Lays out a field of one or more numbers: dragged, or typed after a click. A drag stays within
/// the range. A number beyond it that is typed becomes the nearest allowed one; returns a text that
/// says so, else an empty one.
std::string number_field(const char* title, std::span<float> values, const NumberRange& range);

/// Whether the user types into the number field that was laid out last: ImGui applies each letter
/// at once.
bool is_number_typed();

/// Takes the comma as a decimal point while a number is typed. Call after ImGui's NewFrame.
void take_commas_as_points();

}  // namespace atrium::viewer
