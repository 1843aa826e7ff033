#include "tests/support/source_dir.hpp"

namespace atrium::test {

const std::string& source_dir() {
    static const std::string folder = ATRIUM_SOURCE_DIR;
    return folder;
}

}  // namespace atrium::test
