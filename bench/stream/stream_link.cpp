// A run over a simulated link that becomes narrow and wide again, as numbers for stream_figures.sh.
#include "bench/usage.hpp"
#include "tests/support/network/simulated_stream.hpp"

#include <cstdio>

namespace {

constexpr double kSeconds = 100.0;

double link_bit_per_s(double time_s) {
    if (time_s < 10.0) return 50e6;
    if (time_s < 40.0) return 20e6;
    if (time_s < 70.0) return 5e6;
    return 50e6;
}

}  // namespace

// One line per half second: time [s], link, wanted, carried [Mbit/s], largest and median age [ms].
// Then one line per step of the level: "step", time [s], quality, divisor, send every.
int main(int argc, char** argv) {
    using namespace atrium::test;
    atrium::bench::words_or_usage(
        argc,
        argv,
        {0},
        "usage: stream_link\n"
        "A line per half second: time [s], link, wanted, carried [Mbit/s], largest and median age\n"
        "[ms]; then one per step: time [s], quality, divisor, send every.\n");
    SimulatedLink link;
    link.bit_per_s = link_bit_per_s;
    link.jitter_ms = 5.0;
    link.loss = 0.005;
    const StreamRecord record = simulate({}, {link}, kSeconds);
    constexpr double kStep_s = 0.5;
    for (const CapSample& sample : record.caps) {
        static double next_s = 0.0;
        if (sample.time_s < next_s) continue;
        next_s += kStep_s;
        const double from_s = sample.time_s;
        std::printf("%.2f %.2f %.2f %.2f %.1f %.1f\n",
                    from_s,
                    1e-6 * link_bit_per_s(from_s),
                    1e-6 * sample.wanted_bit_per_s,
                    1e-6 * carried_bit_per_s(record.viewers[0], from_s, from_s + kStep_s),
                    max_age_ms(record.viewers[0], from_s, from_s + kStep_s),
                    median_age_ms(record.viewers[0], from_s, from_s + kStep_s));
    }
    for (const Step& step : record.steps) {
        const auto& level = record.ladder[step.to];
        std::printf("step %.2f %d %d %d\n",
                    step.time_s,
                    level.jpeg_quality,
                    level.colour_divisor,
                    level.send_every);
    }
}
