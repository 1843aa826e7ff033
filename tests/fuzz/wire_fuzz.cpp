#include "tests/fuzz/wire_check.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

// One program for each topic: ATRIUM_WIRE_TOPIC is its name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const atrium::test::WireCheck& topic = *std::ranges::find(
        atrium::test::wire_checks(), ATRIUM_WIRE_TOPIC, &atrium::test::WireCheck::topic);
    bool was_accepted = false;
    const std::string wrong = topic.check({data, size}, was_accepted);
    if (!wrong.empty()) {
        std::fprintf(stderr, "wire_fuzz: %s\n", wrong.c_str());
        std::abort();
    }
    return 0;
}
