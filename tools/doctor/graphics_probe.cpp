#include "core/gl/egl_context.hpp"

#include <cstdio>

// Says whether pictures are drawn by a GPU. `doctor` runs it as a process of its own.
int main() {
    const auto context = atrium::gl::EglContext::create(atrium::gl::EglDevices::kHardware);
    std::puts(context ? "hardware" : context.error().message.c_str());
    return context ? 0 : 3;
}
