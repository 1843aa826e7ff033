#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// What Esc ends, in this order; docs/viewer_window.md lists it. Esc in a text field never gets
/// here: the field takes it.
enum class EscapeEnds : std::uint8_t {
    kQuestion,
    kPopup,  // colour picker, or list that drops down
    kDrag,
    kPanel,  // the one that was opened last
    kSelection,
    kFollowing,
    kEyes,
    kViewer,  // after a question
};

/// What is open, as far as Esc ends it.
struct Openings {
    bool question = false;
    bool popup = false;
    bool drag = false;
    bool panel = false;
    bool selection = false;
    bool following = false;
    bool eyes = false;
};

inline EscapeEnds escape_ends(const Openings& open) {
    for (const auto& [is_open, ends] : {std::pair{open.question, EscapeEnds::kQuestion},
                                        std::pair{open.popup, EscapeEnds::kPopup},
                                        std::pair{open.drag, EscapeEnds::kDrag},
                                        std::pair{open.panel, EscapeEnds::kPanel},
                                        std::pair{open.selection, EscapeEnds::kSelection},
                                        std::pair{open.following, EscapeEnds::kFollowing},
                                        std::pair{open.eyes, EscapeEnds::kEyes}})
        if (is_open) return ends;
    return EscapeEnds::kViewer;
}

/// The panels that the user opened, in this order.
template <class Panel>
class OpenedPanels {
public:
    bool has(Panel panel) const { return std::ranges::find(panels_, panel) != panels_.end(); }
    bool is_empty() const { return panels_.empty(); }
    void open(Panel panel) {
        if (!has(panel)) panels_.push_back(panel);
    }
    void toggle(Panel panel) {
        if (std::erase(panels_, panel) == 0) panels_.push_back(panel);
    }
    void close_last() {
        if (!panels_.empty()) panels_.pop_back();
    }

private:
    std::vector<Panel> panels_;
};

}  // namespace atrium::viewer
