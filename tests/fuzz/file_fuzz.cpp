#include "tests/fuzz/file_check.hpp"

#include <cstdio>
#include <cstdlib>

// One program for each kind of file: ATRIUM_FILE_CHECK is its check.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    bool was_accepted = false;
    const std::string wrong = atrium::test::ATRIUM_FILE_CHECK({data, size}, was_accepted);
    if (!wrong.empty()) {
        std::fprintf(stderr, "file_fuzz: %s\n", wrong.c_str());
        std::abort();
    }
    return 0;
}
