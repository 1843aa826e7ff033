#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace atrium::demo {

/// Collects the status that all programs of a world publish once a second: the newest for the
/// table, the history for the report. Not thread-safe.
class StatusBoard {
public:
    static Expected<StatusBoard> create(const bus::Participant& participant);

    /// Wakes `waiter` when `update` has something to take.
    void attach(bus::Waiter& waiter) const;

    /// Takes the new samples. Returns whether there were any.
    bool update();

    /// Drops the history, so the report leaves out the start-up.
    void begin_report();

    bool has_world() const { return !world_.name.empty(); }
    bool has_viewer() const { return !viewer_.name.empty(); }
    bool site_publishes(const std::string& site) const;
    std::uint64_t num_pairs_shown() const;

    /// Table lines of equal width, with a heading.
    std::vector<std::string> table(const std::map<std::string, std::string>& notes) const;

    struct Run {
        double measured_s = 0.0;
        double until_everybody_was_on_s = 0.0;  // from the start of the first program
    };
    /// Returns medians over the seconds of the report, and totals, as JSON text.
    std::string report(const Run& run) const;

private:
    template <typename Status>
    struct History {
        std::string name;
        std::vector<Status> samples;
    };
    StatusBoard(bus::Reader<bus::SiteStatus> sites,
                bus::Reader<bus::WorldStatus> world,
                bus::Reader<bus::ViewerStatus> viewer)
        : site_reader_(std::move(sites)),
          world_reader_(std::move(world)),
          viewer_reader_(std::move(viewer)) {}

    bus::Reader<bus::SiteStatus> site_reader_;
    bus::Reader<bus::WorldStatus> world_reader_;
    bus::Reader<bus::ViewerStatus> viewer_reader_;
    std::map<std::string, History<bus::SiteStatus>> sites_;
    History<bus::WorldStatus> world_;
    History<bus::ViewerStatus> viewer_;
};

}  // namespace atrium::demo
