#include "bench/usage.hpp"
#include "tests/integration/stream_over_link.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

// One row of the tables of docs/measurements/links.md. stream_links.sh runs all of them:
//
//   stream_links NAME INTERNAL PROFILES MBIT/S DELAY_MS JITTER_MS LOSS FRAMES
//                [MESH TEXTURE [MESSAGE FRAGMENT [TEXTURE_WRITERS]]]
//
// INTERNAL: Cyclone's elements of <Internal>. PROFILES: a file like qos/profiles.xml, or "" for the
// built-in one. 0 MBIT/S: no limit. The rest is in bytes.
int main(int argc, char** argv) {
    using namespace atrium::test;
    const std::vector<std::string> words = atrium::bench::words_or_usage(
        argc,
        argv,
        {8, 10, 12, 13},
        "usage: stream_links NAME INTERNAL PROFILES MBIT/S DELAY_MS JITTER_MS LOSS FRAMES\n"
        "                    [MESH TEXTURE [MESSAGE FRAGMENT [TEXTURE_WRITERS]]]\n"
        "INTERNAL: Cyclone's elements of <Internal>; PROFILES: a file, \"\" for the built-in one;\n"
        "0 MBIT/S: no limit; the rest in bytes. One row of docs/measurements/links.md.\n");
    auto network = ImpairedNetwork::create(2, 1);
    if (!network) {
        fmt::print(stderr, "{}\n", network.error().message);
        return 3;
    }
    const auto ms = [&](std::size_t i) {
        return std::chrono::nanoseconds(std::llround(1e6 * std::stod(words[i])));
    };
    Impairment impairment;
    impairment.rate_bit_per_s = 1e6 * std::stod(words[3]);
    impairment.delay = ms(4);
    impairment.jitter = ms(5);
    impairment.loss = std::stod(words[6]);
    for (const int host : {0, 1}) (*network)->set(host, Way::kUp, impairment);

    const auto folder = std::filesystem::temp_directory_path();
    StreamSettings settings;
    settings.num_frames = std::stoull(words[7]);
    settings.profiles_file = words[2];
    settings.network_file = folder / fmt::format("stream_links-{}.xml", getpid());
    if (words.size() >= 10) {
        settings.mesh_bytes = std::stoull(words[8]);
        settings.texture_bytes = std::stoull(words[9]);
    }
    if (words.size() == 13) settings.num_texture_writers = std::stoi(words[12]);
    std::ofstream(settings.network_file)
        << (words.size() >= 12
                ? network_xml(**network, words[1], std::stoi(words[10]), std::stoi(words[11]))
                : network_xml(**network, words[1]));
    auto stream = StreamOverLink::start(**network, settings);
    if (!stream) {
        fmt::print(stderr, "{}\n", stream.error().message);
        return 1;
    }
    const auto report = (*stream)->finish();
    std::filesystem::remove(settings.network_file);
    if (!report) {
        fmt::print(stderr, "{}\n", report.error().message);
        return 1;
    }
    fmt::print("{}\n{}\n", table_head(), table_row(words[0], *report, settings.num_frames));
    return 0;
}
