#include "site_node/record/file_calls.hpp"

#include <limits>
#include <system_error>

namespace atrium::record {

FileCalls system_calls() {
    return {[](int file, const iovec* parts, int num_parts) {
                return ::writev(file, parts, num_parts);
            },
            [](const std::filesystem::path& folder) {
                std::error_code failure;
                const auto space = std::filesystem::space(folder, failure);
                return failure ? std::numeric_limits<std::uint64_t>::max()
                               : static_cast<std::uint64_t>(space.available);
            }};
}

}  // namespace atrium::record
