#include "tools/demo/result_folder.hpp"

#include "core/base/write_check.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

namespace atrium::demo {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> unusable(const fs::path& output, const std::string& why) {
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("output: cannot write to the folder '{}': {}; choose another "
                                  "one with --output",
                                  output.string(),
                                  why));
}

}  // namespace

Expected<ResultFolder> ResultFolder::create(const fs::path& output) {
    std::error_code failure;
    fs::create_directories(output, failure);
    if (failure) return unusable(output, failure.message());
    Descriptor lock(open((output / ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644));
    if (lock.get() < 0) return unusable(output, std::strerror(errno));
    if (flock(lock.get(), LOCK_EX | LOCK_NB) != 0)
        return unusable(output, "another demo is writing there");
    ResultFolder folder(output, std::move(lock));
    fs::remove_all(folder.running(), failure);  // of a demo that was killed
    if (!failure) fs::create_directory(folder.running(), failure);
    if (failure) return unusable(output, failure.message());
    if (auto written = probe_file(folder.running() / "probe"); !written)
        return unusable(output, written.error().message);
    return folder;
}

Expected<void> ResultFolder::keep() const {
    std::error_code failure;
    for (fs::directory_iterator file(running(), failure), end; !failure && file != end;
         file.increment(failure)) {
        fs::rename(file->path(), output_ / file->path().filename(), failure);
        if (failure) return unusable(output_, failure.message());
    }
    fs::remove_all(running(), failure);
    return {};
}

void ResultFolder::set_aside() const {
    std::error_code ignored;
    if (!fs::exists(running(), ignored)) return;
    fs::remove_all(failed(), ignored);
    fs::rename(running(), failed(), ignored);
}

}  // namespace atrium::demo
