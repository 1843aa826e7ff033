#include "bench/world/trial_options.hpp"

#include "core/config/option_set.hpp"

#include <sstream>

namespace atrium::bench {

bool TrialOptions::wants(const std::string& name) const {
    std::istringstream beginnings(only);
    for (std::string beginning; std::getline(beginnings, beginning, ',');) {
        if (name.starts_with(beginning)) return true;
    }
    return only.empty();
}

app::Start start(const app::ProgramInfo& info, TrialOptions& options, int argc, char** argv) {
    config::OptionSet set;
    set.add("rig", options.rig, "cameras of the simulated room, a rig file");
    set.add("trials", options.num_trials, "of each kind", {1, 10'000});
    set.add("first", options.first, "seed of the first trial");
    set.add("only", options.only, "kinds whose names begin with one of these, comma-separated");
    set.add("trace", options.traces, "what happens, 30 lines per second, on standard error");
    return app::start(info, set, argc, argv);
}

}  // namespace atrium::bench
