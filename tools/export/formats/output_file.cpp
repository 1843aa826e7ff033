#include "tools/export/formats/output_file.hpp"

#include "core/base/write_check.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

namespace atrium::exporting {
namespace {

std::filesystem::path part_of(const std::filesystem::path& file) { return file.string() + ".part"; }

}  // namespace

OutputFile::OutputFile(std::filesystem::path file, Descriptor descriptor)
    : file_(std::move(file)), descriptor_(std::move(descriptor)) {}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : file_(std::exchange(other.file_, {})),
      descriptor_(std::move(other.descriptor_)),
      num_bytes_(other.num_bytes_) {}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
    if (this != &other) {
        discard();
        file_ = std::exchange(other.file_, {});
        descriptor_ = Descriptor(-1);
        std::swap(descriptor_, other.descriptor_);
        num_bytes_ = other.num_bytes_;
    }
    return *this;
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::discard() {
    if (!file_.empty()) unlink(part_of(file_).c_str());
    file_.clear();
}

Expected<OutputFile> OutputFile::create(const std::filesystem::path& file) {
    Descriptor descriptor(
        open(part_of(file).c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644));
    if (descriptor.get() < 0) return tl::unexpected(cannot_write(file, "create", errno));
    return OutputFile(file, std::move(descriptor));
}

Expected<void> OutputFile::write(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_.get(), bytes.data(), bytes.size());
        if (written < 0) {
            if (errno == EINTR) continue;
            return tl::unexpected(cannot_write(file_, "write", errno));
        }
        bytes = bytes.subspan(static_cast<std::size_t>(written));
        num_bytes_ += static_cast<std::uint64_t>(written);
    }
    return {};
}

Expected<void> OutputFile::write(std::string_view text) {
    return write(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

Expected<void> OutputFile::commit() {
    // some file systems report only here that the disk was full
    if (fsync(descriptor_.get()) != 0 && errno != EINVAL)
        return tl::unexpected(cannot_write(file_, "write", errno));
    descriptor_ = Descriptor(-1);
    if (std::rename(part_of(file_).c_str(), file_.c_str()) != 0)
        return tl::unexpected(cannot_write(file_, "create", errno));
    file_.clear();
    return {};
}

Expected<void> write_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
    auto out = OutputFile::create(file);
    if (!out) return tl::unexpected(out.error());
    if (auto done = out->write(bytes); !done) return done;
    return out->commit();
}

}  // namespace atrium::exporting
