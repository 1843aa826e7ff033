#include "site_node/texture/outline_chroma.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <optional>

namespace atrium::texture {
namespace {

// Squared distances in (U, V).
constexpr int kLeastSaturation = 16 * 16;  // of the background from grey
constexpr int kLeastContrast = 20 * 20;    // between person and background

// Pixels from the outline at which the person's own chroma is looked for, and the background's. The
// first pixel outside may still be mixed.
constexpr int kFirstInside = 1;
constexpr int kLastInside = 3;
constexpr int kOutside = 2;

struct Chroma {
    int u = 0;
    int v = 0;

    Chroma operator-(const Chroma& other) const { return {u - other.u, v - other.v}; }
    int dot(const Chroma& other) const { return u * other.u + v * other.v; }
};

constexpr Chroma kGrey{128, 128};

struct Direction {
    int x = 0;
    int y = 0;
};

std::uint64_t eight_of(const std::uint8_t* mask) {
    std::uint64_t word = 0;
    std::memcpy(&word, mask, sizeof word);
    return word;
}

class OutlineChroma {
public:
    OutlineChroma(const image::YuvView& frame, int divisor, codec::TextureCrop& crop)
        : frame_(frame), divisor_(divisor), crop_(crop) {}

    // Not the pixels at the border of the crop: where a person leaves the picture is no outline.
    void clean_row(int y) {
        const std::uint8_t* const row = crop_.mask.row(y);
        const std::uint8_t* const above = crop_.mask.row(y - 1);
        const std::uint8_t* const below = crop_.mask.row(y + 1);
        const int end = crop_.width() - 1;
        int x = 1;
        for (; x + 8 <= end; x += 8) {
            const std::uint64_t here = eight_of(row + x);
            if (here == 0) continue;
            const std::uint64_t around = eight_of(row + x - 1) & eight_of(row + x + 1) &
                                         eight_of(above + x) & eight_of(below + x);
            for (std::uint64_t outline = here & ~around; outline != 0;) {
                const int byte = std::countr_zero(outline) / 8;
                clean(x + byte, y);
                outline &= ~(std::uint64_t{0xff} << (8 * byte));
            }
        }
        for (; x < end; ++x) {
            if (row[x] != 0 && is_outline(x, y)) clean(x, y);
        }
    }

private:
    bool is_within(int x, int y) const {
        return x >= 1 && y >= 1 && x < crop_.width() - 1 && y < crop_.height() - 1;
    }
    bool is_outline(int x, int y) const {
        return (crop_.mask.at(x - 1, y) & crop_.mask.at(x + 1, y) & crop_.mask.at(x, y - 1) &
                crop_.mask.at(x, y + 1)) == 0;
    }

    // Towards the person; (0, 0) if both sides of a thin part look alike.
    Direction inwards(int x, int y) const {
        const auto at = [&](int dx, int dy) { return crop_.mask.at(x + dx, y + dy) & 1; };
        const int corners_right = at(1, -1) + at(1, 1);
        const int corners_left = at(-1, -1) + at(-1, 1);
        const int corners_below = at(-1, 1) + at(1, 1);
        const int corners_above = at(-1, -1) + at(1, -1);
        const int across = corners_right + 2 * at(1, 0) - corners_left - 2 * at(-1, 0);
        const int down = corners_below + 2 * at(0, 1) - corners_above - 2 * at(0, -1);
        const auto step = [](int along, int other) {
            if (along == 0 || 2 * std::abs(along) < std::abs(other)) return 0;
            return along > 0 ? 1 : -1;
        };
        return {step(across, down), step(down, across)};
    }

    std::optional<Chroma> background(int x, int y) const {
        if (!is_within(x, y) || crop_.mask.at(x, y) != 0) return std::nullopt;
        const int u = (crop_.crop_px.x + divisor_ * x) / 2;
        const int v = (crop_.crop_px.y + divisor_ * y) / 2;
        return Chroma{frame_.u.at(u, v), frame_.v.at(u, v)};
    }

    // The nearest chroma that the outline does not touch.
    std::optional<Chroma> inside(int x, int y, const Direction& in) const {
        for (int steps = kFirstInside; steps <= kLastInside; ++steps) {
            const int ix = x + steps * in.x;
            const int iy = y + steps * in.y;
            if (!is_within(ix, iy) || crop_.mask.at(ix, iy) == 0) return std::nullopt;
            if (!is_outline(ix, iy)) return Chroma{crop_.u.at(ix, iy), crop_.v.at(ix, iy)};
        }
        return std::nullopt;
    }

    void clean(int x, int y) {
        const Direction in = inwards(x, y);
        const auto outer = background(x - kOutside * in.x, y - kOutside * in.y);
        if (!outer) return;
        const Chroma colour = *outer - kGrey;
        if (colour.dot(colour) < kLeastSaturation) return;
        const auto inner = inside(x, y, in);
        if (!inner) return;
        const Chroma contrast = *inner - *outer;
        const int square = contrast.dot(contrast);
        if (square < kLeastContrast) return;
        const Chroma here{crop_.u.at(x, y), crop_.v.at(x, y)};
        // the background's share, in units of 1/256
        const int along = std::max((here - *outer).dot(contrast), 0);
        const int share = 256 - (along * 256 + square / 2) / square;
        if (share <= 0) return;
        const auto add = [share](std::uint8_t& value, int difference) {
            value = static_cast<std::uint8_t>(
                std::clamp(value + (share * difference + 128) / 256, 0, 255));
        };
        add(crop_.u.row(y)[x], contrast.u);
        add(crop_.v.row(y)[x], contrast.v);
    }

    const image::YuvView& frame_;
    int divisor_;
    codec::TextureCrop& crop_;
};

}  // namespace

void clean_outline_chroma(const image::YuvView& frame, int divisor, codec::TextureCrop& crop) {
    OutlineChroma outline(frame, divisor, crop);
    for (int y = 1; y + 1 < crop.height(); ++y) outline.clean_row(y);
}

}  // namespace atrium::texture
