#include "tools/keys/find_store.hpp"

#include "core/base/looked_up.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

namespace atrium::keys_tool {

namespace fs = std::filesystem;

Expected<fs::path> find_store(const fs::path& given, const fs::path& folder) {
    if (!given.empty()) return given;
    std::vector<std::string> found;
    std::error_code failure;
    fs::directory_iterator entry(folder, failure);
    for (const fs::directory_iterator end; !failure && entry != end; entry.increment(failure)) {
        std::error_code ignored;
        if (entry->path().extension() == ".keys" && entry->is_directory(ignored))
            found.push_back(entry->path().filename().string());
    }
    if (found.size() == 1) return folder == "." ? fs::path(found[0]) : folder / found[0];
    if (found.empty())
        return make_error(ErrorKind::kNotFound,
                          fmt::format("no folder *.keys is here{}; make one with `atrium keys init "
                                      "WORLD`, or give it with --keys FOLDER",
                                      looked_up_from(folder)));
    std::ranges::sort(found);
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("several folders of keys are here: {}; choose one with --keys",
                                  fmt::join(found, ", ")));
}

}  // namespace atrium::keys_tool
