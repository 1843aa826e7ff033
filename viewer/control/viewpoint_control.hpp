#pragma once

#include "viewer/config/viewpoints.hpp"
#include "viewer/control/surface_events.hpp"
#include "viewer/control/user_control.hpp"

#include <chrono>
#include <string>
#include <utility>

namespace atrium::viewer {

/// Keeps viewpoints and flies to them as the user asks.
class ViewpointControl {
public:
    explicit ViewpointControl(ViewpointBook book) : book_(std::move(book)) {}

    /// Returns a message for the user.
    std::string handle(const ViewpointEvent& event,
                       UserControl& control,
                       std::chrono::steady_clock::time_point now);
    const ViewpointBook& book() const { return book_; }

private:
    std::string keep(int number, Viewpoint viewpoint);

    ViewpointBook book_;
    int last_ = 0;  // number of the last viewpoint that was kept or flown to; 0: none
};

}  // namespace atrium::viewer
