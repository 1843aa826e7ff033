#include "simulation/render_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <system_error>

namespace atrium::simulation {

RenderLock RenderLock::wait(const std::filesystem::path& loop_file,
                            const std::function<void()>& on_wait,
                            std::stop_token stop) {
    constexpr std::chrono::milliseconds kBetweenLooks{100};
    std::filesystem::path file = loop_file;
    file += ".lock";
    std::error_code ignored;
    std::filesystem::create_directories(file.parent_path(), ignored);
    Descriptor lock(open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644));
    if (lock.get() < 0) return {file, Descriptor(-1)};
    std::mutex mutex;
    std::condition_variable_any wake;
    for (bool has_told = false; flock(lock.get(), LOCK_EX | LOCK_NB) != 0; has_told = true) {
        if (stop.stop_requested()) return {file, Descriptor(-1)};
        if (!has_told && on_wait) on_wait();
        std::unique_lock guard(mutex);
        wake.wait_for(guard, stop, kBetweenLooks, [] { return false; });
    }
    return {file, std::move(lock)};
}

// Who waits for the removed file finds the loop.
RenderLock::~RenderLock() {
    std::error_code ignored;
    if (lock_.get() >= 0) std::filesystem::remove(file_, ignored);
}

}  // namespace atrium::simulation
