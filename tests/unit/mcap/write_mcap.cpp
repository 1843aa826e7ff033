#include "tests/unit/mcap/mcap_samples.hpp"

#include <cstdio>

// Writes a file of random messages, and prints them as tests/support/mcap/read_mcap.py does; with a
// second file, cuts the first off in the middle, repairs it, and prints what is left.
int main(int argc, char** argv) {
    using namespace atrium::mcap;
    using namespace atrium::mcap::testing;
    if (argc != 3) {
        std::fprintf(stderr, "usage: write_mcap FILE.mcap whole|repaired\n");
        return 2;
    }
    const std::filesystem::path path(argv[1]);
    SampleFile sample = write_sample_file(path, 9, 60);
    if (std::string_view(argv[2]) == "repaired") {
        std::filesystem::resize_file(path, std::filesystem::file_size(path) * 2 / 3);
        if (!repair(path)) return 1;
        const auto file = File::open(path);
        if (!file) return 1;
        sample.messages = messages_in(*file);
    }
    for (const OwnMessage& message : sample.messages) {
        std::printf(
            "{\"topic\": \"%s\", \"channel\": %d, \"sequence\": %u, \"log_time\": %lld, "
            "\"publish_time\": %lld, \"size\": %zu, \"crc\": %u}\n",
            message.channel == 0 ? "a" : "b",
            message.channel,
            message.sequence,
            static_cast<long long>(message.log_ns),
            static_cast<long long>(message.publish_ns),
            message.data.size(),
            crc32(message.data));
    }
    return 0;
}
