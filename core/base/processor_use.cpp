#include "core/base/processor_use.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>

namespace atrium {
namespace {

// Three numbers of at most 20 digits each, two spaces and a line end.
constexpr std::size_t kMaxLine = 64;

std::optional<SchedStat> read_schedstat(int file) {
    std::array<char, kMaxLine> text;
    const ssize_t size = pread(file, text.data(), text.size(), 0);
    if (size <= 0) return std::nullopt;
    return parse_schedstat({text.data(), static_cast<std::size_t>(size)});
}

std::uint64_t process_run_ns() {
    timespec time{};
    // exact, and includes ended threads
    if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time) != 0) return 0;
    return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000'000U +
           static_cast<std::uint64_t>(time.tv_nsec);
}

double seconds(std::uint64_t ns) { return 1e-9 * static_cast<double>(ns); }

std::int16_t own_niceness() {
    return static_cast<std::int16_t>(getpriority(PRIO_PROCESS, static_cast<id_t>(getpid())));
}

}  // namespace

std::optional<SchedStat> parse_schedstat(std::string_view text) {
    SchedStat stat;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (std::uint64_t* const value : {&stat.run_ns, &stat.waited_ns, &stat.num_runs}) {
        while (at != end && *at == ' ') ++at;
        const auto [rest, failure] = std::from_chars(at, end, *value);
        if (failure != std::errc()) return std::nullopt;
        if (rest != end && *rest != ' ' && *rest != '\n') return std::nullopt;
        at = rest;
    }
    if (at != end && *at == '\n') ++at;
    if (at != end) return std::nullopt;
    // any existing thread has run: zeros mean that the kernel does not count
    if (stat.run_ns == 0 && stat.num_runs == 0) return std::nullopt;
    return stat;
}

ProcessorMeter::ProcessorMeter(std::string tasks, Clock::time_point now)
    : tasks_(std::move(tasks)), last_(now) {
    const Waits waits = read_threads();
    use_.run_ns = process_run_ns();
    use_.waited_ns = waits.sum_ns;
    use_.is_waiting_known = waits.is_known;
    use_.nice = own_niceness();
}

ProcessorMeter::Waits ProcessorMeter::read_threads() {
    Waits waits;
    const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir(tasks_.c_str()), closedir);
    if (folder == nullptr) return waits;
    std::map<pid_t, SchedStat> threads;
    while (const dirent* const entry = readdir(folder.get())) {
        const std::string_view name = entry->d_name;
        pid_t thread = 0;
        const auto [rest, failure] =
            std::from_chars(name.data(), name.data() + name.size(), thread);
        if (failure != std::errc() || rest != name.data() + name.size()) continue;
        const Descriptor file(openat(
            dirfd(folder.get()), (std::string(name) + "/schedstat").c_str(), O_RDONLY | O_CLOEXEC));
        const auto stat = file.get() >= 0 ? read_schedstat(file.get()) : std::nullopt;
        const auto before = threads_.find(thread);
        if (!stat) {  // the thread has ended, the kernel does not count, or no file can be opened
            if (before != threads_.end()) threads.insert(*before);
            continue;
        }
        waits.is_known = true;
        threads.emplace(thread, *stat);
        // lower counts: a new thread has reused the id of an ended one
        const bool is_same = before != threads_.end() && before->second.run_ns <= stat->run_ns &&
                             before->second.waited_ns <= stat->waited_ns;
        const std::uint64_t waited_ns =
            stat->waited_ns - (is_same ? before->second.waited_ns : std::uint64_t{0});
        waits.sum_ns += waited_ns;
        waits.longest_ns = std::max(waits.longest_ns, waited_ns);
    }
    threads_ = std::move(threads);
    return waits;
}

ProcessorUse ProcessorMeter::update(Clock::time_point now) {
    if (now - last_ < kLeastInterval) return use_;
    const Waits waits = read_threads();
    const std::uint64_t run_ns = std::max(use_.run_ns, process_run_ns());
    const double elapsed_s = std::chrono::duration<double>(now - last_).count();
    use_.run_per_s = seconds(run_ns - use_.run_ns) / elapsed_s;
    use_.waited_per_s = seconds(waits.sum_ns) / elapsed_s;
    // a wait that began before the interval can be longer than it
    use_.longest_wait_per_s = std::min(1.0, seconds(waits.longest_ns) / elapsed_s);
    use_.run_ns = run_ns;
    use_.waited_ns += waits.sum_ns;
    use_.is_waiting_known = waits.is_known;
    use_.nice = own_niceness();
    last_ = now;
    return use_;
}

}  // namespace atrium
