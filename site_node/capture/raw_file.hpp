#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "site_node/capture/raw_codec.hpp"
#include "site_node/capture/raw_sheet.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The file frames.raw of a recording: the pictures of one camera, byte for byte as it delivered
/// them (docs/recording_rooms.md, "frames.raw").
namespace atrium::capture {

/// What the head of a file says of all its pictures.
struct RawFileHead {
    RawLayout layout;
    RawCodec codec = RawCodec::kRaw;
    std::vector<std::uint8_t> codec_data;  // of the codec, for its decoder
};

/// The bytes with which a file begins.
std::vector<std::uint8_t> to_bytes(const RawFileHead& head);

/// What stands before the bytes of a picture.
struct RawRecordHead {
    std::uint64_t number = 0;  // of the instant; grows, and lacks the numbers of lost pictures
    Timestamp capture_time;
    std::uint32_t num_bytes = 0;  // of the picture, as stored
    std::uint64_t sum = 0;        // sum_of these bytes
};
inline constexpr std::size_t kRawRecordHeadBytes = 40;
std::array<std::uint8_t, kRawRecordHeadBytes> to_bytes(const RawRecordHead& head);

/// Detects damage by chance. Not collision-resistant.
std::uint64_t sum_of(std::span<const std::uint8_t> bytes);

/// Reads a frames.raw, also one that was cut off or is still written. The bytes may be hostile. Not
/// thread-safe.
class RawFile {
public:
    /// Finds all whole pictures. Errors name the file: kNotFound, kConfiguration (it cannot be
    /// read), kInvalidData (it is no such file, or of a later version).
    static Expected<RawFile> open(const std::filesystem::path& file);
    RawFile(RawFile&&) noexcept;
    RawFile& operator=(RawFile&&) noexcept;
    ~RawFile();

    const std::filesystem::path& path() const;
    const RawFileHead& head() const;
    /// Highest number of a picture + 1; 0: there is none.
    std::size_t num_pictures() const;
    /// How many there are: fewer if numbers are missing.
    std::size_t num_stored() const;
    /// nullopt if there is no picture of this number.
    std::optional<Timestamp> capture_time(std::size_t number) const;
    /// That the file ends in the middle of a picture, or is damaged from a picture on; else empty.
    const std::string& damage() const;

    /// Errors: kNotFound if the number is missing, kInvalidData if its bytes are damaged.
    Expected<image::RawImage> read(std::size_t number);

private:
    struct Impl;
    explicit RawFile(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::capture
