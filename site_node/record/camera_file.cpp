#include "site_node/record/camera_file.hpp"

#include "core/base/write_check.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace atrium::record {
namespace {

// The disk begins with so many bytes of a file while the next ones come. Without, the system
// collects them for seconds and then stops every writer, which a queue of a second cannot bridge.
constexpr std::uint64_t kFlushBytes = 4U << 20;

}  // namespace

CameraFile::CameraFile(std::filesystem::path file, Descriptor descriptor, const FileCalls& calls)
    : file_(std::move(file)), descriptor_(std::move(descriptor)), calls_(calls) {}

Expected<CameraFile> CameraFile::create(const std::filesystem::path& file,
                                        const capture::RawLayout& layout,
                                        capture::RawCodec codec,
                                        const FileCalls& calls) {
    Descriptor descriptor(open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0644));
    if (descriptor.get() < 0) return tl::unexpected(cannot_write(file, "create", errno));
    CameraFile created(file, std::move(descriptor), calls);
    created.layout_ = layout;
    capture::RawFileHead head{layout, codec, {}};
    if (codec != capture::RawCodec::kRaw) {
        auto encoder = capture::SheetEncoder::open(codec, capture::sheet_size(layout));
        if (!encoder) return tl::unexpected(encoder.error());
        head.codec_data = encoder->codec_data();
        created.encoder_.emplace(std::move(*encoder));
    }
    if (auto written = created.write(capture::to_bytes(head), {}); !written)
        return tl::unexpected(written.error());
    return created;
}

Expected<std::uint64_t> CameraFile::append(std::uint64_t number,
                                           Timestamp capture_time,
                                           std::span<const std::uint8_t> packed) {
    std::span<const std::uint8_t> stored = packed;
    if (encoder_) {
        sheet_.resize(packed.size());
        capture::to_sheet(layout_, packed, sheet_);
        if (auto encoded = encoder_->encode(sheet_, coded_); !encoded)
            return tl::unexpected(encoded.error());
        // readers tell by the number of bytes
        if (coded_.size() < packed.size()) stored = coded_;
    }
    const auto head = capture::to_bytes(capture::RawRecordHead{
        number, capture_time, static_cast<std::uint32_t>(stored.size()), capture::sum_of(stored)});
    if (auto written = write(head, stored); !written) return tl::unexpected(written.error());
    flush();
    return head.size() + stored.size();
}

Expected<void> CameraFile::write(std::span<const std::uint8_t> head,
                                 std::span<const std::uint8_t> body) {
    std::size_t done = 0;
    while (done < head.size() + body.size()) {
        const auto rest_of = [](std::span<const std::uint8_t> part, std::size_t from) {
            part = part.subspan(std::min(from, part.size()));
            return iovec{const_cast<std::uint8_t*>(part.data()), part.size()};  // only read
        };
        const std::array<iovec, 2> parts{
            rest_of(head, done), rest_of(body, done > head.size() ? done - head.size() : 0)};
        const ssize_t written = calls_.write(descriptor_.get(), parts.data(), parts.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            const int error = written < 0 ? errno : ENOSPC;
            // a reader would report the piece of a picture as damage
            if (ftruncate(descriptor_.get(), static_cast<off_t>(end_)) == 0)
                lseek(descriptor_.get(), static_cast<off_t>(end_), SEEK_SET);
            return tl::unexpected(cannot_write(file_, "write", error));
        }
        done += static_cast<std::size_t>(written);
    }
    end_ += done;
    return {};
}

void CameraFile::flush() {
    if (end_ - flushed_ < kFlushBytes) return;
    const int file = descriptor_.get();
    const auto begin = static_cast<off_t>(flushed_);
    const auto length = static_cast<off_t>(end_ - flushed_);
    sync_file_range(file, begin, length, SYNC_FILE_RANGE_WRITE);
    // the piece before is on the disk by now, or the disk is too slow and the queue must fill
    if (begin > 0) {
        sync_file_range(
            file,
            0,
            begin,
            SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
        posix_fadvise(file, 0, begin, POSIX_FADV_DONTNEED);
    }
    flushed_ = end_;
}

}  // namespace atrium::record
