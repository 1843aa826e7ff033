#include "site_node/capture/raw_file.hpp"

#include "core/base/descriptor.hpp"
#include "core/base/readable.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

// All numbers are little-endian.
static_assert(std::endian::native == std::endian::little);

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFileMagic = "ATRIUMRP";
constexpr std::string_view kRecordMagic = "PICTURE\n";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kFileHeadBytes = 48;
constexpr std::size_t kMaxCodecBytes = 1U << 16;
constexpr std::uint64_t kMaxNumber = 10'000'000;

template <typename T>
void put(std::uint8_t* at, T value) {
    std::memcpy(at, &value, sizeof value);
}

template <typename T>
T get(const std::uint8_t* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

bool has_magic(const std::uint8_t* at, std::string_view magic) {
    return std::memcmp(at, magic.data(), magic.size()) == 0;
}

// Fewer bytes than asked for at the end of the file, or if it cannot be read.
std::size_t read_at(int file, std::uint64_t offset, std::span<std::uint8_t> out) {
    std::size_t done = 0;
    while (done < out.size()) {
        const ssize_t got =
            pread(file, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

}  // namespace

std::uint64_t sum_of(std::span<const std::uint8_t> bytes) {
    constexpr std::uint64_t kPrime = 0x9e3779b97f4a7c15ULL;
    std::array<std::uint64_t, 4> lanes{1, 2, 3, 4};  // independent, so that they run side by side
    const std::size_t whole = bytes.size() / 32 * 32;
    const auto mix = [](std::uint64_t sum, std::uint64_t value) {
        return std::rotl((sum ^ value) * kPrime, 29);
    };
    for (std::size_t i = 0; i < whole; i += 32) {
        for (std::size_t lane = 0; lane < 4; ++lane)
            lanes[lane] = mix(lanes[lane], get<std::uint64_t>(bytes.data() + i + 8 * lane));
    }
    std::uint64_t sum = bytes.size();
    for (const std::uint64_t lane : lanes) sum = mix(sum, lane);
    for (const std::uint8_t byte : bytes.subspan(whole)) sum = mix(sum, byte);
    return sum;
}

std::vector<std::uint8_t> to_bytes(const RawFileHead& head) {
    std::vector<std::uint8_t> bytes(kFileHeadBytes + head.codec_data.size());
    std::ranges::copy(kFileMagic, bytes.begin());
    put(&bytes[8], kVersion);
    put(&bytes[12], static_cast<std::uint32_t>(head.layout.format));
    put(&bytes[16], static_cast<std::uint32_t>(head.layout.width));
    put(&bytes[20], static_cast<std::uint32_t>(head.layout.height));
    put(&bytes[24], static_cast<std::uint32_t>(head.codec));
    put(&bytes[28], static_cast<std::uint32_t>(head.codec_data.size()));
    put(&bytes[32], sum_of(head.codec_data));
    put(&bytes[40], sum_of({bytes.data(), 40}));
    std::ranges::copy(head.codec_data, bytes.begin() + kFileHeadBytes);
    return bytes;
}

std::array<std::uint8_t, kRawRecordHeadBytes> to_bytes(const RawRecordHead& head) {
    std::array<std::uint8_t, kRawRecordHeadBytes> bytes{};
    std::ranges::copy(kRecordMagic, bytes.begin());
    put(&bytes[8], static_cast<std::uint32_t>(head.number));
    put(&bytes[12], head.num_bytes);
    put(&bytes[16], head.capture_time.ns);
    put(&bytes[24], head.sum);
    put(&bytes[32], sum_of({bytes.data(), 32}));
    return bytes;
}

struct RawFile::Impl {
    struct Entry {
        std::uint64_t offset = 0;  // of the picture's bytes
        RawRecordHead head;
    };

    fs::path path;
    Descriptor file{-1};
    std::uint64_t num_bytes = 0;
    RawFileHead head;
    std::map<std::size_t, Entry> entries;  // by number
    std::string damage;
    std::optional<SheetDecoder> decoder;
    std::vector<std::uint8_t> coded, sheet;

    Error invalid(const std::string& what) const {
        return {ErrorKind::kInvalidData, fmt::format("{}: {}", path.string(), what)};
    }

    Expected<std::uint64_t> read_head() {
        std::array<std::uint8_t, kFileHeadBytes> bytes{};
        if (read_at(file.get(), 0, bytes) < bytes.size())
            return tl::unexpected(invalid("the file ends before its first picture"));
        if (!has_magic(bytes.data(), kFileMagic))
            return tl::unexpected(invalid("no file of raw pictures"));
        if (const auto version = get<std::uint32_t>(&bytes[8]); version != kVersion) {
            return tl::unexpected(invalid(fmt::format(
                "version {} of raw pictures; this program reads version {}", version, kVersion)));
        }
        const auto damaged = [&] { return tl::unexpected(invalid("the head is damaged")); };
        if (get<std::uint64_t>(&bytes[40]) != sum_of({bytes.data(), 40})) return damaged();
        const auto format = get<std::uint32_t>(&bytes[12]);
        const auto width = get<std::uint32_t>(&bytes[16]);
        const auto height = get<std::uint32_t>(&bytes[20]);
        const auto codec = get<std::uint32_t>(&bytes[24]);
        const auto num_codec_bytes = get<std::uint32_t>(&bytes[28]);
        if (format > static_cast<std::uint32_t>(image::PixelFormat::kYuyv) ||
            width > kMaxRawSize_px || height > kMaxRawSize_px ||
            codec > static_cast<std::uint32_t>(RawCodec::kHuffYuv) ||
            num_codec_bytes > kMaxCodecBytes)
            return damaged();
        head.layout = {static_cast<image::PixelFormat>(format),
                       static_cast<int>(width),
                       static_cast<int>(height)};
        head.codec = static_cast<RawCodec>(codec);
        if (!is_valid(head.layout)) return damaged();
        head.codec_data.resize(num_codec_bytes);
        if (read_at(file.get(), kFileHeadBytes, head.codec_data) < num_codec_bytes ||
            sum_of(head.codec_data) != get<std::uint64_t>(&bytes[32]))
            return damaged();
        return kFileHeadBytes + num_codec_bytes;
    }

    std::string cut_off() const {
        return fmt::format(
            "the file ends in the middle of a picture, after {} whole ones: the recording was cut "
            "off, or the file is truncated",
            entries.size());
    }

    // Stops at the first record that is none: what follows cannot be found reliably.
    void find_pictures(std::uint64_t at) {
        std::array<std::uint8_t, kRawRecordHeadBytes> bytes{};
        const std::size_t packed = packed_bytes(head.layout);
        while (at < num_bytes) {
            if (num_bytes - at < bytes.size()) {
                damage = cut_off();
                return;
            }
            const bool is_read = read_at(file.get(), at, bytes) == bytes.size();
            RawRecordHead record{get<std::uint32_t>(&bytes[8]),
                                 {get<std::int64_t>(&bytes[16])},
                                 get<std::uint32_t>(&bytes[12]),
                                 get<std::uint64_t>(&bytes[24])};
            const bool is_next = entries.empty() || record.number > entries.rbegin()->first;
            if (!is_read || !has_magic(bytes.data(), kRecordMagic) ||
                get<std::uint64_t>(&bytes[32]) != sum_of({bytes.data(), 32}) || !is_next ||
                record.number >= kMaxNumber || record.num_bytes > packed) {
                damage = fmt::format("the file is damaged after {} pictures", entries.size());
                return;
            }
            at += bytes.size();
            if (num_bytes - at < record.num_bytes) {
                damage = cut_off();
                return;
            }
            entries.emplace_hint(entries.end(), record.number, Entry{at, record});
            at += record.num_bytes;
        }
    }

    Expected<void> decode(std::vector<std::uint8_t>& packed) {
        if (!decoder) {
            auto opened = SheetDecoder::open(head.codec, sheet_size(head.layout), head.codec_data);
            if (!opened) return tl::unexpected(opened.error());
            decoder.emplace(std::move(*opened));
        }
        sheet.resize(packed.size());
        if (auto decoded = decoder->decode(coded, sheet); !decoded) return decoded;
        from_sheet(head.layout, sheet, packed);
        return {};
    }
};

RawFile::RawFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RawFile::RawFile(RawFile&&) noexcept = default;
RawFile& RawFile::operator=(RawFile&&) noexcept = default;
RawFile::~RawFile() = default;

Expected<RawFile> RawFile::open(const fs::path& file) {
    if (auto readable = check_readable(file); !readable) return tl::unexpected(readable.error());
    auto impl = std::make_unique<Impl>();
    impl->path = file;
    impl->file = Descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat about {};
    if (impl->file.get() < 0 || fstat(impl->file.get(), &about) != 0) {
        const std::error_code reason(errno, std::generic_category());
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: cannot open: {}", file.string(), reason.message()));
    }
    impl->num_bytes = static_cast<std::uint64_t>(about.st_size);
    const auto first = impl->read_head();
    if (!first) return tl::unexpected(first.error());
    // from head to head: reading ahead would read the whole file
    posix_fadvise(impl->file.get(), 0, 0, POSIX_FADV_RANDOM);
    impl->find_pictures(*first);
    posix_fadvise(impl->file.get(), 0, 0, POSIX_FADV_SEQUENTIAL);
    return RawFile(std::move(impl));
}

const fs::path& RawFile::path() const { return impl_->path; }
const RawFileHead& RawFile::head() const { return impl_->head; }
const std::string& RawFile::damage() const { return impl_->damage; }
std::size_t RawFile::num_stored() const { return impl_->entries.size(); }

std::size_t RawFile::num_pictures() const {
    return impl_->entries.empty() ? 0 : impl_->entries.rbegin()->first + 1;
}

std::optional<Timestamp> RawFile::capture_time(std::size_t number) const {
    const auto found = impl_->entries.find(number);
    if (found == impl_->entries.end()) return std::nullopt;
    return found->second.head.capture_time;
}

Expected<image::RawImage> RawFile::read(std::size_t number) {
    const auto found = impl_->entries.find(number);
    if (found == impl_->entries.end()) {
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: has no picture {}", impl_->path.string(), number));
    }
    const Impl::Entry& entry = found->second;
    const RawLayout& layout = impl_->head.layout;
    std::vector<std::uint8_t> packed(packed_bytes(layout));
    // a picture that does not become smaller is stored as it is
    const bool is_packed =
        impl_->head.codec == RawCodec::kRaw || entry.head.num_bytes == packed.size();
    std::vector<std::uint8_t>& stored = is_packed ? packed : impl_->coded;
    const auto damaged = [&](const std::string& reason) {
        return tl::unexpected(
            impl_->invalid(fmt::format("picture {} is damaged: {}", number, reason)));
    };
    if (is_packed && entry.head.num_bytes != packed.size()) return damaged("of another size");
    stored.resize(entry.head.num_bytes);
    if (read_at(impl_->file.get(), entry.offset, stored) < stored.size())
        return damaged("it cannot be read from the disk");
    if (sum_of(stored) != entry.head.sum) return damaged("its sum is wrong");
    if (!is_packed) {
        if (auto decoded = impl_->decode(packed); !decoded) return damaged(decoded.error().message);
    }
    return unpack(layout, std::move(packed));
}

}  // namespace atrium::capture
