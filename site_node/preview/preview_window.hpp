#pragma once

#include "core/base/expected.hpp"
#include "site_node/preview/preview_picture.hpp"

#include <memory>

namespace atrium::preview {

/// A window that shows successive pictures, scaled to its size. Use it only on the thread that
/// opened it (GLFW asks for the main thread; with X11 any works). Only one at a time, and no
/// offscreen rendering meanwhile: both share the table of GL functions.
class PreviewWindow {
public:
    /// Error kUnavailable without a display or without OpenGL 3.3 on it.
    static Expected<std::unique_ptr<PreviewWindow>> open(const std::string& title);
    ~PreviewWindow();
    PreviewWindow(const PreviewWindow&) = delete;
    PreviewWindow& operator=(const PreviewWindow&) = delete;

    /// The first picture sets the size of the window.
    void show(const Picture& picture);

    /// Processes window events. Returns false once the user closed the window or pressed Escape.
    bool stays_open();

private:
    struct Impl;
    explicit PreviewWindow(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::preview
