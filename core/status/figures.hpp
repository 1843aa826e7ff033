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
    bool is_alarming = false;  // growth deserves a warning to the user of a viewer
};

/// The contents of a status as named counters, stages and notes, the same for each kind of program.
/// The monitor and the viewer show these: a new counter is one line in figures.cpp. The monitor
/// shows `losses` as text, and all in its JSON. The demo's table and report take a choice of their
/// own.
struct Figures {
    struct Stage {
        std::string name;
        bus::LatencySummary latency;
        bool has_p99 = true;
        bool is_from_capture_elsewhere = false;  // compares a site's clock with another host's
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

    /// A state that does not mend itself.
    struct Alarm {
        std::string what;    // "camera north was moved (turned by 0.20 degrees)"
        std::string advice;  // in a few words: "calibrate refine"
        std::string cure;    // the whole command, or what to check
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
    std::optional<bus::RigCoherence> coherence;  // of a site
    std::vector<bus::HostStatus> hosts;          // of a site on several
    std::vector<Alarm> alarms;
    std::vector<Note> notes;  // values that are not counters
    std::uint64_t resident_bytes = 0;
    ProcessorUse processor;
    double first_output_s = 0.0;  // from the start of the process; 0: none yet
};

Figures figures_of(const bus::SiteStatus& status);
Figures figures_of(const bus::WorldStatus& status);
Figures figures_of(const bus::ViewerStatus& status);
Figures figures_of(const bus::CameraNodeStatus& status);
Figures figures_of(const bus::RegionNodeStatus& status);

/// The name of a figure for people: "dropped late" for "dropped_late".
std::string spaced(std::string name);
/// "29.9 metaframes/s".
std::string rate_text(double rate, const std::string& unit);

/// "in_use", "clock_wrong".
const char* name_of(bus::HostState state);
/// "coherent", "moved".
const char* name_of(bus::RigVerdict verdict);
/// "coherent", "0.42 px", "worst north 0.61 px", "48 instants". Empty if nothing is known.
std::vector<std::string> rig_items(const bus::RigCoherence& coherence);

/// True if `now` can be of the same process as `before`: neither time nor any counter decreased.
bool may_be_same_process(const Figures& before, const Figures& now);

}  // namespace atrium::status
