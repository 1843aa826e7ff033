#include "core/base/text_file.hpp"

#include "core/base/descriptor.hpp"
#include "core/base/looked_up.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace atrium {

Expected<std::string> read_text_file(const std::filesystem::path& file, std::size_t max_bytes) {
    const auto unreadable = [&](int error) {
        return make_error(ErrorKind::kNotFound,
                          file.string() + ": cannot be read: " + std::strerror(error) +
                              (error == ENOENT ? looked_up_from(file) : std::string()));
    };
    const Descriptor opened(open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (opened.get() < 0) return unreadable(errno);
    std::string text;
    std::array<char, 65536> part;
    for (;;) {
        const ssize_t num_bytes = read(opened.get(), part.data(), part.size());
        if (num_bytes < 0 && errno == EINTR) continue;
        if (num_bytes < 0) return unreadable(errno);
        if (num_bytes == 0) return text;
        text.append(part.data(), static_cast<std::size_t>(num_bytes));
        if (text.size() > max_bytes) {
            return make_error(ErrorKind::kConfiguration,
                              file.string() + ": is larger than " +
                                  std::to_string(max_bytes >> 20U) +
                                  " MiB, the limit for a text file; is it the right file?");
        }
    }
}

}  // namespace atrium
