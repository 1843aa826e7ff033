#pragma once

struct ImGuiInputTextCallbackData;

namespace atrium::viewer {

/// Linear light of an sRGB value in [0, 1], and back.
double linear_of(float encoded);
float encoded_of(double linear);

/// Filter of a text field: only the characters that names on the bus may have.
int allowed_in_names(ImGuiInputTextCallbackData* data);

}  // namespace atrium::viewer
