#include "core/codec/mask_codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>

namespace atrium::codec {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 5;

/// The columns at which one row changes; at most one per pixel.
struct Changes {
    std::array<std::uint16_t, kMaxTextureSide> column;
    std::size_t size = 0;
};

class BitWriter {
public:
    explicit BitWriter(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

    void put(std::uint32_t value, int num_bits) {
        pending_ = pending_ << num_bits | value;
        num_pending_ += num_bits;
        while (num_pending_ >= 8) {
            num_pending_ -= 8;
            bytes_.push_back(static_cast<std::uint8_t>(pending_ >> num_pending_));
        }
    }

    void put_unsigned(std::uint32_t value) {
        const int num_bits = std::bit_width(value + 1);
        put(0, num_bits - 1);
        put(value + 1, num_bits);
    }

    void put_signed(int value) {
        put_unsigned(value > 0 ? 2U * static_cast<std::uint32_t>(value) - 1U
                               : 2U * static_cast<std::uint32_t>(-value));
    }

    void finish() {
        if (num_pending_ > 0) put(0, 8 - num_pending_);
    }

private:
    std::vector<std::uint8_t>& bytes_;
    std::uint64_t pending_ = 0;
    int num_pending_ = 0;
};

/// Reads bits. A read past the end returns zeros and sets `failed`.
class BitReader {
public:
    explicit BitReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    bool failed() const { return failed_; }

    std::uint32_t bit() {
        if (position_ >= bytes_.size() * 8) {
            failed_ = true;
            return 0;
        }
        const std::uint32_t value = bytes_[position_ / 8] >> (7 - position_ % 8) & 1U;
        ++position_;
        return value;
    }

    std::uint32_t get_unsigned() {
        constexpr int kMaxZeros = 14;  // no valid number is larger than twice the largest side
        int zeros = 0;
        while (bit() == 0) {
            if (failed_ || ++zeros > kMaxZeros) {
                failed_ = true;
                return 0;
            }
        }
        std::uint32_t value = 1;
        for (int i = 0; i < zeros; ++i) value = value << 1 | bit();
        return value - 1;
    }

    int get_signed() {
        const auto code = static_cast<int>(get_unsigned());
        return code % 2 != 0 ? (code + 1) / 2 : -(code / 2);
    }

    // True if only zero bits of the current byte are left.
    bool at_end() {
        if ((position_ + 7) / 8 != bytes_.size()) return false;
        while (position_ % 8 != 0) {
            if (bit() != 0) return false;
        }
        return !failed_;
    }

private:
    std::span<const std::uint8_t> bytes_;
    std::size_t position_ = 0;
    bool failed_ = false;
};

void find_changes(const std::uint8_t* row, int width, Changes& out) {
    constexpr int kStep = 8;
    out.size = 0;
    std::uint64_t before = 0;  // the pixel on the left
    int x = 0;
    for (; x + kStep <= width; x += kStep) {
        std::uint64_t word = 0;
        std::memcpy(&word, row + x, sizeof word);
        std::uint64_t changes = (word ^ (word << 8 | before)) & 0x0101010101010101;
        for (; changes != 0; changes &= changes - 1) {
            const int byte = std::countr_zero(changes) / 8;
            out.column[out.size++] = static_cast<std::uint16_t>(x + byte);
        }
        before = word >> 56;
    }
    for (; x < width; ++x) {
        if (row[x] == before) continue;
        before = row[x];
        out.column[out.size++] = static_cast<std::uint16_t>(x);
    }
}

void put_row(const Changes& here, const Changes& above, BitWriter& bits) {
    if (here.size == above.size) {
        bits.put(1, 1);
        for (std::size_t k = 0; k < here.size; ++k)
            bits.put_signed(here.column[k] - above.column[k]);
        return;
    }
    bits.put(0, 1);
    bits.put_unsigned(static_cast<std::uint32_t>(here.size));
    int next = 0;
    for (std::size_t k = 0; k < here.size; ++k) {
        bits.put_unsigned(static_cast<std::uint32_t>(here.column[k] - next));
        next = here.column[k] + 1;
    }
}

// Returns false if the bits are not a row of `width` pixels.
bool get_row(BitReader& bits, int width, const Changes& above, Changes& here) {
    const bool same_number = bits.bit() != 0;
    const std::size_t size = same_number ? above.size : bits.get_unsigned();
    if (bits.failed() || size > static_cast<std::size_t>(width)) return false;
    here.size = size;
    int next = 0;
    for (std::size_t k = 0; k < size; ++k) {
        const int column = same_number ? above.column[k] + bits.get_signed()
                                       : next + static_cast<int>(bits.get_unsigned());
        if (bits.failed() || column < next || column >= width) return false;
        here.column[k] = static_cast<std::uint16_t>(column);
        next = column + 1;
    }
    return true;
}

void paint_row(const Changes& changes, int width, std::uint8_t* row) {
    int x = 0;
    std::uint8_t value = 0;
    for (std::size_t k = 0; k < changes.size; ++k) {
        std::fill(row + x, row + changes.column[k], value);
        x = changes.column[k];
        value = static_cast<std::uint8_t>(~value);
    }
    std::fill(row + x, row + width, value);
}

}  // namespace

void encode_mask(const image::Mask& mask, std::vector<std::uint8_t>& out) {
    assert(is_texture_size(mask.width, mask.height));
    out.clear();
    out.push_back(kVersion);
    for (const int side : {mask.width, mask.height}) {
        out.push_back(static_cast<std::uint8_t>(side & 255));
        out.push_back(static_cast<std::uint8_t>(side >> 8));
    }
    BitWriter bits(out);
    std::array<Changes, 2> rows;
    for (int y = 0; y < mask.height; ++y) {
        Changes& here = rows[static_cast<std::size_t>(y % 2)];
        find_changes(mask.row(y), mask.width, here);
        put_row(here, rows[static_cast<std::size_t>((y + 1) % 2)], bits);
    }
    bits.finish();
}

Expected<void> decode_mask(std::span<const std::uint8_t> bytes, image::Mask& out) {
    if (bytes.size() < kHeaderBytes || bytes[0] != kVersion) {
        return make_error(ErrorKind::kInvalidData,
                          "coded mask: no header of version " + std::to_string(kVersion));
    }
    const int width = bytes[1] | bytes[2] << 8;
    const int height = bytes[3] | bytes[4] << 8;
    if (!is_texture_size(width, height)) {
        return make_error(ErrorKind::kInvalidData,
                          "coded mask: " + std::to_string(width) + "x" + std::to_string(height) +
                              " pixels, empty or too large");
    }
    // a row takes at least one bit: a few bytes cannot claim a large picture
    if ((bytes.size() - kHeaderBytes) * 8 < static_cast<std::size_t>(height)) {
        return make_error(ErrorKind::kInvalidData, "coded mask: truncated");
    }
    out.width = width;
    out.height = height;
    out.data.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    BitReader bits(bytes.subspan(kHeaderBytes));
    std::array<Changes, 2> rows;
    for (int y = 0; y < height; ++y) {
        Changes& here = rows[static_cast<std::size_t>(y % 2)];
        if (!get_row(bits, width, rows[static_cast<std::size_t>((y + 1) % 2)], here)) {
            return make_error(ErrorKind::kInvalidData,
                              "coded mask: damaged in row " + std::to_string(y));
        }
        paint_row(here, width, out.row(y));
    }
    if (!bits.at_end())
        return make_error(ErrorKind::kInvalidData, "coded mask: has data after its last row");
    return {};
}

}  // namespace atrium::codec
