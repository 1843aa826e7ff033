#pragma once

#include "core/base/descriptor.hpp"

#include <filesystem>
#include <functional>
#include <stop_token>

namespace atrium::simulation {

/// Held by the process that renders a loop: others that need the same one wait for its file instead
/// of rendering it, too. In a folder that cannot be written nobody waits.
class RenderLock {
public:
    /// Waits while another process renders `loop_file`, and calls `on_wait` before. Ends early once
    /// `stop` is requested.
    static RenderLock wait(const std::filesystem::path& loop_file,
                           const std::function<void()>& on_wait,
                           std::stop_token stop);
    ~RenderLock();
    RenderLock(RenderLock&&) noexcept = default;
    RenderLock& operator=(RenderLock&&) = delete;

private:
    RenderLock(std::filesystem::path file, Descriptor lock)
        : file_(std::move(file)), lock_(std::move(lock)) {}

    std::filesystem::path file_;
    Descriptor lock_;  // negative: none
};

}  // namespace atrium::simulation
