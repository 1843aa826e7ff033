#pragma once

#include <imgui.h>

#include <vector>

namespace atrium::viewer {

/// Lets ImGui see keys that were pressed and released between two of its frames, which happens when
/// pictures take long: ImGui only looks at the keys that are down in a frame.
class TappedKeys {
public:
    /// Call for each press of a key.
    void pressed(int key) { taps_.push_back(key); }
    /// Call before ImGui's NewFrame.
    void begin_frame() {
        ImGuiIO& io = ImGui::GetIO();
        std::erase_if(taps_, [&](int key) {
            return key < 0 || key >= IM_ARRAYSIZE(io.KeysDown) || io.KeysDown[key];
        });
        for (const int key : taps_) io.KeysDown[key] = true;
    }
    /// Call after ImGui's frame.
    void end_frame() {
        for (const int key : taps_) ImGui::GetIO().KeysDown[key] = false;
        taps_.clear();
    }

private:
    std::vector<int> taps_;
};

}  // namespace atrium::viewer
