#pragma once

#include "core/bus/messages.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace atrium::status {

struct Counter {
    std::string what;
    std::uint64_t total = 0;
};

/// What a status of any kind of program says.
struct Figures {
    struct Stage {
        std::string name;
        bus::LatencySummary latency;
        bool has_p99 = true;
        bool is_from_capture_elsewhere = false;  // compares the clock of a site with another's
    };
    struct Topic {
        std::string name;
        double bytes_per_s = 0.0;
    };
    struct Camera {
        bus::CameraStatus status;
        std::vector<Counter> losses;
    };

    struct Note {
        std::string what;
        std::string text;
    };

    Timestamp time;  // on the program's clock
    std::string rate_unit;
    double rate = 0.0;
    std::vector<Counter> work;
    std::vector<Counter> losses;
    std::vector<Stage> stages;
    std::vector<Topic> topics;
    std::vector<Camera> cameras;
    std::optional<bus::StreamState> stream;
    std::vector<Note> notes;  // what is no count
    std::uint64_t resident_bytes = 0;
    ProcessorUse processor;
    double first_output_s = 0.0;  // from the start of the process; 0: none yet
};

Figures figures_of(const bus::SiteStatus& status);
Figures figures_of(const bus::WorldStatus& status);
Figures figures_of(const bus::ViewerStatus& status);

/// Whether `now` may be of the process that wrote `before`: its counters went on, and time too.
bool goes_on(const Figures& before, const Figures& now);

}  // namespace atrium::status
