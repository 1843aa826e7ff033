// Prints how fast this machine is: `machine_score [--json]`, about four seconds.
//
// Two fixed kernels do a fixed amount of work. "integer" runs four chains of multiplications, each
// step with a load from a table of 16 kB. "memory" follows a chain of 32,768 cache lines in random
// order (2 MB), 32 times, then reads and writes 16 MB from front to back, 4 times. The score is 100
// * reference / time, with the least time of several runs. The score of both is the geometric mean.
// A machine of score 200 does the same work in half the time of one of score 100.
//
// "one core" runs one thread. "all cores" runs one pinned thread on each core that this process may
// use, all at the same time, and takes the slowest thread. It is lower than "one core" if cores
// share an execution unit, a cache or the memory bus, or if other programs run.
//
// CMakeLists.txt sets the compiler's flags. The score then depends on the machine and hardly on the
// compiler.
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

namespace {

// Seconds of one run of each kernel on one core. Measured with this program on 2026-11-23 on an
// idle virtual machine with 2 cores of an AMD EPYC (family 25, model 1, 2.45 GHz, KVM): the least
// of ten calls, g++ 12.2.
constexpr double kReferenceIntegerSeconds = 0.0295;
constexpr double kReferenceMemorySeconds = 0.0240;

constexpr int kNumRuns = 40;

volatile std::uint64_t sink;  // uses the result, which prevents the compiler from dropping the work

std::uint64_t integer_kernel() {
    std::array<std::uint64_t, 2048> table;  // 16 kB: fits the first cache of any x86-64
    std::uint64_t state = 88172645463325252ULL;
    for (std::uint64_t& entry : table) {
        state ^= state << 13U;
        state ^= state >> 7U;
        state ^= state << 17U;
        entry = state | 1U;
    }
    std::array<std::uint64_t, 4> x{1, 2, 3, 4};
    std::uint64_t sum = 0;
    for (int i = 0; i < 6'000'000; ++i) {
        for (std::uint64_t& chain : x) {
            chain = chain * 6364136223846793005ULL + table[chain >> 53U];
            sum += chain ^ (chain >> 29U);
        }
    }
    return sum;
}

/// 16 MB of pages of 4 kB, whatever the system's policy on large pages.
class Memory {
public:
    static constexpr std::size_t kNumWords = 2U << 20U;
    static constexpr std::size_t kWordsPerLine = 8;
    static constexpr std::size_t kNumLines = 32U << 10U;  // of the chain

    Memory() {
        void* mapped = mmap(nullptr,
                            kNumWords * sizeof(std::uint64_t),
                            PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS,
                            -1,
                            0);
        if (mapped == MAP_FAILED) {
            std::perror("machine_score: 16 MB of memory");
            std::exit(3);
        }
        madvise(mapped, kNumWords * sizeof(std::uint64_t), MADV_NOHUGEPAGE);
        words_ = static_cast<std::uint64_t*>(mapped);
        for (std::size_t i = 0; i < kNumWords; ++i) words_[i] = i;
        link_lines();
    }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
    ~Memory() { munmap(words_, kNumWords * sizeof(std::uint64_t)); }

    std::uint64_t kernel() {
        std::uint64_t line = 0;
        for (std::size_t i = 0; i < 32 * kNumLines; ++i) line = words_[line * kWordsPerLine];
        // next to the chain's links, at the start of every line
        std::uint64_t sum = line;
        for (int pass = 0; pass < 4; ++pass) {
            for (std::size_t i = 1; i < kNumWords; i += 2) {
                sum += words_[i];
                words_[i] = sum;
            }
        }
        return sum;
    }

private:
    // Sattolo's algorithm: one cycle through all lines
    void link_lines() {
        std::vector<std::uint64_t> next(kNumLines);
        for (std::size_t i = 0; i < kNumLines; ++i) next[i] = i;
        std::uint64_t state = 1;
        for (std::size_t i = kNumLines - 1; i > 0; --i) {
            state = state * 6364136223846793005ULL + 1442695040888963407ULL;
            std::swap(next[i], next[(state >> 33U) % i]);
        }
        for (std::size_t i = 0; i < kNumLines; ++i) words_[i * kWordsPerLine] = next[i];
    }

    std::uint64_t* words_;
};

struct Times {
    double integer = std::numeric_limits<double>::infinity();
    double memory = std::numeric_limits<double>::infinity();
};

template <typename Work>
double seconds(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    sink = work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::vector<int> usable_cores() {
    cpu_set_t set;
    CPU_ZERO(&set);
    std::vector<int> cores;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return {0};
    for (int core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &set)) cores.push_back(core);
    return cores;
}

void pin_to(int core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(core), &set);
    sched_setaffinity(0, sizeof set, &set);  // without it the score is merely less stable
}

// One thread per core. Each run starts on all cores at the same time and ends with the slowest.
Times measure(const std::vector<int>& cores) {
    std::vector<Times> of_core(cores.size());
    Times least;
    std::barrier together(static_cast<std::ptrdiff_t>(cores.size()));
    const auto run = [&](std::size_t i) {
        pin_to(cores[i]);
        Memory memory;
        for (int k = 0; k < kNumRuns; ++k) {
            together.arrive_and_wait();
            of_core[i].integer = seconds(integer_kernel);
            together.arrive_and_wait();
            of_core[i].memory = seconds([&] { return memory.kernel(); });
            together.arrive_and_wait();
            if (i != 0) continue;
            Times slowest{0.0, 0.0};
            for (const Times& times : of_core) {
                slowest.integer = std::max(slowest.integer, times.integer);
                slowest.memory = std::max(slowest.memory, times.memory);
            }
            least.integer = std::min(least.integer, slowest.integer);
            least.memory = std::min(least.memory, slowest.memory);
        }
    };
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < cores.size(); ++i) threads.emplace_back(run, i);
    threads.clear();
    return least;
}

struct Score {
    double both, integer, memory;
};

Score score_of(const Times& times) {
    const double integer = 100.0 * kReferenceIntegerSeconds / times.integer;
    const double memory = 100.0 * kReferenceMemorySeconds / times.memory;
    return {std::sqrt(integer * memory), integer, memory};
}

void print_json(const char* name, const Score& score, const Times& times, const char* end) {
    std::printf(
        "  \"%s\": {\"score\": %.1f, \"integer\": %.1f, \"memory\": %.1f, \"integer_s\": %.5f, "
        "\"memory_s\": %.5f}%s\n",
        name,
        score.both,
        score.integer,
        score.memory,
        times.integer,
        times.memory,
        end);
}

void print_line(const char* name, const Score& score, const Times& times) {
    std::printf("%-10s score %6.1f   integer %6.1f (%.4f s)   memory %6.1f (%.4f s)\n",
                name,
                score.both,
                score.integer,
                times.integer,
                score.memory,
                times.memory);
}

}  // namespace

int main(int argc, char** argv) {
    const bool json = argc == 2 && std::strcmp(argv[1], "--json") == 0;
    if (argc > 1 && !json) {
        const bool help = std::strcmp(argv[1], "--help") == 0 || std::strcmp(argv[1], "-h") == 0;
        std::fprintf(
            help ? stdout : stderr,
            "usage: machine_score [--json]\n"
            "Prints how fast this machine is at two fixed kernels, on one core and on all cores at "
            "once.\n"
            "A score of 100 is 2 cores of an AMD EPYC at 2.45 GHz; see docs/measuring.md.\n");
        return help ? 0 : 2;
    }
    const std::vector<int> cores = usable_cores();
    const Times one = measure({cores.front()});
    const Times all = measure(cores);
    if (json) {
        std::printf("{\n  \"cores\": %zu,\n", cores.size());
        print_json("one_core", score_of(one), one, ",");
        print_json("all_cores", score_of(all), all, "");
        std::printf("}\n");
    } else {
        print_line("one core", score_of(one), one);
        print_line("all cores", score_of(all), all);
    }
    return 0;
}
