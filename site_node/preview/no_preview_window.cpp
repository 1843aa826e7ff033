#include "site_node/preview/preview_window.hpp"

namespace atrium::preview {

struct PreviewWindow::Impl {};

PreviewWindow::PreviewWindow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PreviewWindow::~PreviewWindow() = default;

Expected<std::unique_ptr<PreviewWindow>> PreviewWindow::open(const std::string&) {
    return make_error(ErrorKind::kUnavailable,
                      "no window: this site_node was built with ATRIUM_SIMULATION=OFF");
}

void PreviewWindow::show(const Picture&) {}

bool PreviewWindow::stays_open() { return false; }

}  // namespace atrium::preview
