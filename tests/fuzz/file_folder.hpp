#pragma once

#include <stdlib.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace atrium::test {

/// A folder in memory for the one file under test. It vanishes with the process, unless the process
/// aborts.
class Folder {
public:
    Folder() {
        std::string name = "/dev/shm/atrium-fuzz-XXXXXX";
        if (::mkdtemp(name.data()) == nullptr) {
            std::perror(name.c_str());
            std::abort();
        }
        path_ = name;
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const char* name, std::span<const std::uint8_t> bytes) const {
        std::ofstream stream(path_ / name, std::ios::binary);
        stream.write(reinterpret_cast<const char*>(bytes.data()),
                     static_cast<std::streamsize>(bytes.size()));
        if (!stream.flush()) std::abort();
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

inline const Folder& folder() {
    static const Folder instance;
    return instance;
}

}  // namespace atrium::test
