#pragma once

#include <pthread.h>

#include <functional>
#include <stop_token>
#include <thread>
#include <utility>

namespace atrium {

/// A thread with a name of at most 15 characters, for top and debuggers.
inline std::jthread named_thread(const char* name, std::function<void(std::stop_token)> body) {
    std::jthread thread(std::move(body));
    pthread_setname_np(thread.native_handle(), name);
    return thread;
}

}  // namespace atrium
