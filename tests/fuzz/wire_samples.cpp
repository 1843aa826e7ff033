#include "tests/fuzz/wire_check.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

// Writes accepted inputs of each topic as a start for the fuzzers: wire_samples FOLDER creates
// FOLDER/wire_TOPIC/sample_0 and so on. They follow idl/, which stored files would not.
int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: wire_samples FOLDER\n");
        return 2;
    }
    for (const atrium::test::WireCheck& topic : atrium::test::wire_checks()) {
        const auto folder = std::filesystem::path(argv[1]) / ("wire_" + std::string(topic.topic));
        std::filesystem::create_directories(folder);
        int number = 0;
        for (const atrium::test::Bytes& bytes : topic.samples()) {
            std::ofstream stream(folder / ("sample_" + std::to_string(number++)), std::ios::binary);
            stream.write(reinterpret_cast<const char*>(bytes.data()),
                         static_cast<std::streamsize>(bytes.size()));
            if (!stream.flush()) return 1;
        }
    }
    return 0;
}
