#include "viewer/config/user_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace atrium::viewer {

namespace fs = std::filesystem;

std::optional<fs::path> user_folder() {
    // the XDG specification ignores relative paths
    const char* state = std::getenv("XDG_STATE_HOME");
    if (state != nullptr && fs::path(state).is_absolute()) return fs::path(state) / "atrium";
    const char* home = std::getenv("HOME");
    if (home == nullptr || !fs::path(home).is_absolute()) return std::nullopt;
    return fs::path(home) / ".local/state/atrium";
}

Expected<void> replace_file(const fs::path& file, const std::string& text) {
    const auto failed = [&](const std::string& reason) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("cannot write {}: {}", file.string(), reason));
    };
    std::error_code failure;
    fs::create_directories(file.parent_path(), failure);
    if (failure) return failed(failure.message());
    fs::path next = file;
    next += fmt::format(".{}.new", ::getpid());
    {
        std::ofstream out(next, std::ios::binary | std::ios::trunc);
        out << text;
        out.close();
        if (!out) {
            const std::string reason = std::strerror(errno);
            fs::remove(next, failure);
            return failed(reason);
        }
    }
    fs::rename(next, file, failure);
    if (!failure) return {};
    std::error_code ignored;
    fs::remove(next, ignored);
    return failed(failure.message());
}

void keep_damaged(const fs::path& file) {
    fs::path kept = file;
    kept += ".damaged";
    std::error_code failure;
    fs::rename(file, kept, failure);  // if it fails, the file is replaced
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (byte < 0x20 || byte == 0x7f)
            out += fmt::format("\\u{:04x}", byte);
        else
            out += c;
    }
    return out + '"';
}

}  // namespace atrium::viewer
