#pragma once

#include "core/base/expected.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

/// The bytes between a site and a segmentation worker (docs/segmentation_worker.md). All numbers
/// are little-endian. The worker is not trusted: everything that it sends is checked here, and the
/// site reads no size, offset or number from the shared memory.
namespace atrium::segmentation_worker {

inline constexpr std::uint32_t kVersion = 1;

/// Places of one camera's pictures in the shared memory, in bytes from its start. Rows have no
/// padding; each place begins at a page.
struct Layout {
    std::uint32_t width = 0;  // [px], even
    std::uint32_t height = 0;
    std::uint64_t background_offset = 0;  // packed BGR
    std::uint64_t picture_offset = 0;     // packed BGR
    std::uint64_t last_mask_offset = 0;   // 0 or 255 per pixel
    std::uint64_t alpha_offset = 0;       // one byte per pixel, written by the worker
    std::uint64_t num_bytes = 0;

    std::size_t num_pixels() const { return std::size_t{width} * height; }
};
Layout layout_of(int width, int height);

inline constexpr std::size_t kHeaderBytes = 136;
/// Returns the header of the shared memory. Cuts the camera's name at 63 bytes.
std::array<std::uint8_t, kHeaderBytes> encode_header(const Layout& layout,
                                                     std::uint32_t deadline_us,
                                                     std::string_view camera);

/// What a site sends: `kHello` once, with the descriptor of the shared memory; then `kPicture` for
/// each picture, one at a time.
struct SiteMessage {
    enum class Kind : std::uint32_t { kHello = 1, kPicture = 2 };
    Kind kind = Kind::kHello;
    std::uint64_t number = 0;             // of the picture, rising
    std::int64_t capture_time_ns = 0;     // of the picture, on the site's clock
    std::uint32_t background_number = 0;  // grows when the background changes
};
inline constexpr std::size_t kSiteMessageBytes = 32;
std::array<std::uint8_t, kSiteMessageBytes> encode(const SiteMessage& message);

/// What a worker sends: `kReady` once it can take pictures; then for each picture `kAlpha` when its
/// alpha is complete, or `kNone` if it has no answer.
struct WorkerMessage {
    enum class Kind : std::uint32_t { kReady = 1, kAlpha = 2, kNone = 3 };
    Kind kind = Kind::kReady;
    std::uint64_t number = 0;  // of the picture
    std::uint32_t width = 0;   // of the alpha [px]
    std::uint32_t height = 0;
};
inline constexpr std::size_t kWorkerMessageBytes = 24;

/// Decodes a message of a worker. Errors (kInvalidData): another size, kind or version.
Expected<WorkerMessage> decode(std::span<const std::uint8_t> bytes);

/// Checks that a message may come now. `is_ready`: the worker has said so. `asked`: the picture
/// without an answer, if there is one. Errors: kInvalidData.
Expected<void> check(const WorkerMessage& message,
                     const Layout& layout,
                     bool is_ready,
                     std::optional<std::uint64_t> asked);

}  // namespace atrium::segmentation_worker
