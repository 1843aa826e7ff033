#include "core/base/process_threads.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace atrium {

std::vector<ProcessThread> process_threads(std::error_code& failure) {
    std::vector<ProcessThread> threads;
    std::filesystem::directory_iterator task("/proc/self/task", failure);
    for (; !failure && task != std::filesystem::directory_iterator(); task.increment(failure)) {
        const std::string id = task->path().filename().string();
        ProcessThread& thread = threads.emplace_back();
        thread.id = static_cast<pid_t>(std::strtol(id.c_str(), nullptr, 10));
        std::getline(std::ifstream(task->path() / "comm"), thread.name);
    }
    return threads;
}

}  // namespace atrium
