#include "core/bus/receive_threads.hpp"

#include "core/base/process_threads.hpp"

#include <fcntl.h>

#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace atrium::bus {
namespace {

constexpr std::chrono::seconds kFindAgain{1};

// Thread names of Cyclone DDS 0.10.2: "recv", "recvMC", "recvUC" receive datagrams; "dq.user"
// delivers the samples that those do not deliver themselves.
bool receives(std::string_view name) { return name.starts_with("recv") || name == "dq.user"; }

// The state is the first word after the thread's name. The name is in brackets and may contain any
// character, brackets included.
bool is_asleep(int descriptor) {
    std::array<char, 128> text{};
    const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
    if (size <= 0) return true;  // the thread has ended
    const std::string_view line(text.data(), static_cast<std::size_t>(size));
    const std::size_t end_of_name = line.rfind(')');
    return end_of_name != std::string_view::npos && line.substr(end_of_name).starts_with(") S");
}

}  // namespace

ReceiveThreads::ReceiveThreads() { find(); }

void ReceiveThreads::find() {
    found_ = Clock::now();
    states_.clear();
    std::error_code failure;
    const std::vector<ProcessThread> threads = process_threads(failure);
    can_list_ = !failure;
    for (const ProcessThread& thread : threads) {
        if (!receives(thread.name)) continue;
        const std::string stat = "/proc/self/task/" + std::to_string(thread.id) + "/stat";
        const int opened = open(stat.c_str(), O_RDONLY | O_CLOEXEC);
        if (opened >= 0) states_.emplace_back(opened);
    }
}

bool ReceiveThreads::are_asleep() {
    if (Clock::now() - found_ >= kFindAgain) {
        find();
        was_listed_twice_ = true;
    }
    if (!can_list_) return true;
    if (!was_listed_twice_) return false;
    for (const Descriptor& state : states_) {
        if (!is_asleep(state.get())) return false;
    }
    return true;
}

}  // namespace atrium::bus
