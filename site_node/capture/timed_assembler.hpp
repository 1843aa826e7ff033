#pragma once

#include "site_node/capture/metaframe_assembler.hpp"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace atrium::capture {

/// Runs a MetaframeAssembler on the steady clock: its own thread ends a metaframe at its deadline,
/// also if no picture comes. Thread-safe.
class TimedAssembler {
public:
    /// Receives the result of each picture and of each deadline, and the assembler that gave it.
    /// Calls never overlap.
    using Sink = std::function<void(std::optional<Metaframe>, const MetaframeAssembler&)>;

    TimedAssembler(std::size_t num_cameras, const AssemblerOptions& options, Sink sink);

    /// As MetaframeAssembler::add, with arrival now.
    void add(CameraFrame frame);

    /// As MetaframeAssembler::finish.
    void finish();

private:
    void watch_deadlines(const std::stop_token& stop);

    std::mutex mutex_;
    MetaframeAssembler assembler_;
    Sink sink_;
    bool is_idle_ = false;  // the thread waits for a metaframe, not for a deadline
    std::condition_variable_any opened_;
    std::jthread watcher_;  // last member: it uses all others
};

}  // namespace atrium::capture
