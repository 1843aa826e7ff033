#pragma once

#include "core/base/expected.hpp"
#include "site_node/preview/preview_picture.hpp"

#include <memory>

namespace atrium::preview {

/// A window that shows one picture after another, scaled to its size. All calls come from the
/// thread that opened it (GLFW asks for the main thread; with X11 any one will do). One at a time,
/// and none while something is rendered offscreen: they share the table of GL functions.
class PreviewWindow {
public:
    /// Error kUnavailable where there is no display or no OpenGL 3.3 on it.
    static Expected<std::unique_ptr<PreviewWindow>> open(const std::string& title);
    ~PreviewWindow();
    PreviewWindow(const PreviewWindow&) = delete;
    PreviewWindow& operator=(const PreviewWindow&) = delete;

    /// The first one gives the window its size.
    void show(const Picture& picture);

    /// Looks after the window's events. False: whoever looks has closed it, or pressed Escape.
    bool stays_open();

private:
    struct Impl;
    explicit PreviewWindow(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::preview
