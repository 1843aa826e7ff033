#include "core/app/process.hpp"

#include "core/app/log.hpp"
#include "core/base/process_threads.hpp"

#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace atrium::app {

void declare(ProcessOptions& options, config::OptionSet& set) {
    set.add("process.nice",
            options.nice,
            "niceness of this program: -20 highest priority, 19 lowest; 0: as started; below 0 "
            "needs a privilege",
            {-20, 19});
}

int apply(const ProcessOptions& options) {
    const auto process = static_cast<id_t>(getpid());
    const int before = getpriority(PRIO_PROCESS, process);
    if (options.nice == 0) return before;
    const int wanted = options.nice < 0 ? options.nice : std::max(options.nice, before);
    int failure = 0;
    // on Linux each thread has its own niceness; some threads may run already
    std::error_code unreadable;
    for (const ProcessThread& thread : process_threads(unreadable)) {
        const auto id = static_cast<id_t>(thread.id);
        // ESRCH: the thread has ended meanwhile
        if (setpriority(PRIO_PROCESS, id, wanted) != 0 && errno != ESRCH) failure = errno;
    }
    if (unreadable) failure = unreadable.value();
    const int now = getpriority(PRIO_PROCESS, process);
    if (failure != 0) {
        log::warn(
            "niceness_refused wanted={} has={} reason=\"{}\" it needs CAP_SYS_NICE or RLIMIT_NICE "
            "(systemd: Nice= or LimitNICE=; atrium doctor)",
            wanted,
            now,
            std::strerror(failure));
    }
    return now;
}

std::optional<std::uint64_t> parse_start_ticks(std::string_view stat) {
    // the second field is the program's name in parentheses, with any characters inside
    constexpr int kFirstField = 3;
    constexpr int kStartField = 22;
    const std::size_t name_end = stat.rfind(')');
    if (name_end == std::string_view::npos) return std::nullopt;
    std::string_view rest = stat.substr(name_end + 1);
    for (int field = kFirstField;; ++field) {
        const std::size_t begin = rest.find_first_not_of(' ');
        if (begin == std::string_view::npos) return std::nullopt;
        rest.remove_prefix(begin);
        if (field == kStartField) break;
        const std::size_t end = rest.find(' ');
        if (end == std::string_view::npos) return std::nullopt;
        rest.remove_prefix(end);
    }
    std::uint64_t ticks = 0;
    const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), ticks);
    if (failure != std::errc()) return std::nullopt;
    if (end != rest.data() + rest.size() && *end != ' ' && *end != '\n') return std::nullopt;
    return ticks;
}

double seconds_since_start() {
    std::ifstream file("/proc/self/stat");
    const std::string stat{std::istreambuf_iterator<char>(file), {}};
    const auto ticks = parse_start_ticks(stat);
    const long ticks_per_s = sysconf(_SC_CLK_TCK);
    timespec now{};
    if (!ticks || ticks_per_s <= 0 || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return 0.0;
    const double now_s = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    return std::max(0.0, now_s - static_cast<double>(*ticks) / static_cast<double>(ticks_per_s));
}

std::filesystem::path program_folder() {
    std::error_code unknown;
    return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
}

}  // namespace atrium::app
