#include "viewer/control/viewpoint_control.hpp"

#include <fmt/format.h>

namespace atrium::viewer {
namespace {

using ViewpointAsk = ViewpointEvent::Kind;

constexpr const char* kNoViewpoint = "no viewpoint yet; Ctrl+1 keeps this one";

}  // namespace

std::string ViewpointControl::keep(int number, Viewpoint viewpoint) {
    const auto kept = book_.keep(number, std::move(viewpoint));
    const std::string text = fmt::format("viewpoint {} kept: {}", number, book_.at(number)->name);
    return kept ? text : text + ", but only until the end: " + kept.error().message;
}

std::string ViewpointControl::handle(const ViewpointEvent& event,
                                     UserControl& control,
                                     std::chrono::steady_clock::time_point now) {
    int number = event.number;
    if (event.kind == ViewpointAsk::kGoNext) number = book_.next(last_, 1);
    if (event.kind == ViewpointAsk::kGoPrevious) number = book_.next(last_, -1);
    if (number < 1 || number > ViewpointBook::kNum) return kNoViewpoint;
    if (event.kind == ViewpointAsk::kKeep) {
        last_ = number;
        return keep(number, {"", control.camera()});
    }
    if (!book_.at(number))
        return fmt::format("no viewpoint {}; Ctrl+{} keeps this one", number, number);
    if (event.kind == ViewpointAsk::kRename)
        return keep(number, {event.name, book_.at(number)->camera});
    if (event.kind == ViewpointAsk::kForget) {
        const auto saved = book_.forget(number);
        return saved ? fmt::format("viewpoint {} deleted", number) : saved.error().message;
    }
    last_ = number;
    control.fly_to(book_.at(number)->camera, now);
    return fmt::format("viewpoint {}: {}", number, book_.at(number)->name);
}

}  // namespace atrium::viewer
