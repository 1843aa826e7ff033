#pragma once

#include <sys/types.h>

#include <string>
#include <system_error>
#include <vector>

namespace atrium {

struct ProcessThread {
    pid_t id = 0;
    std::string name;  // at most 15 characters; empty if the thread has ended meanwhile
};

/// Lists the threads of this process from /proc. `failure` says why the list is empty or cut.
std::vector<ProcessThread> process_threads(std::error_code& failure);

}  // namespace atrium
