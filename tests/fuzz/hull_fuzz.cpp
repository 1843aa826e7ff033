#include "tests/fuzz/hull_check.hpp"

#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string wrong =
        atrium::test::check_hull(atrium::test::decode_hull_input({data, size}));
    if (!wrong.empty()) {
        std::fprintf(stderr, "hull_fuzz: %s\n", wrong.c_str());
        std::abort();
    }
    return 0;
}
