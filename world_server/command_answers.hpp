#pragma once

#include "core/bus/messages.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace atrium::world_server {

/// Decides which commands get an answer, and builds it as an EditResult without number.
///
/// Grab, push and reset are answered if they are refused, a reset also if it is done: at most four
/// times a second for each sender and kind, so that many commands give no flood. Thread-safe.
class CommandAnswers {
public:
    using Clock = std::chrono::steady_clock;

    /// `target` is the object of a grab or push. `why` may begin with the name of the command, as
    /// in the log.
    std::optional<bus::EditResult> refused(const std::string& sender,
                                           bus::CommandKind kind,
                                           std::uint32_t target,
                                           const std::string& why,
                                           Clock::time_point now);
    std::optional<bus::EditResult> done(const std::string& sender,
                                        bus::CommandKind kind,
                                        Clock::time_point now);
    void forget(const std::string& sender);
    std::size_t num_remembered() const;

private:
    bool is_due(const std::string& sender, bus::CommandKind kind, Clock::time_point now);

    mutable std::mutex mutex_;
    std::map<std::pair<std::string, bus::CommandKind>, Clock::time_point> answered_;
};

}  // namespace atrium::world_server
