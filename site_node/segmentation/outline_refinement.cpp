#include "site_node/segmentation/outline_refinement.hpp"

#include "site_node/segmentation/pixel_test.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

namespace atrium::segmentation {
namespace {

using TileSums = OutlineRefinement::TileSums;

constexpr int kTile = 4;    // [px]
constexpr int kMargin = 4;  // around people [px]: a row of tiles
constexpr int kPixels = kTile * kTile;
constexpr int kFewestBlocks = 2;  // inside, around a tile, by weight
// Weights of the tiles around one.
constexpr std::array<std::int32_t, 3> kWeights{1, 4, 1};
// Colours are in halves of a grey level.
constexpr int kGainShift = 13;  // from a level times a gain
constexpr int kLeastSquare =
    4 * OutlineRefinement::kLeastContrast * OutlineRefinement::kLeastContrast;
// Of the room beside people, in 1/256.
constexpr int kDarkest = 128;
constexpr int kBrightest = 294;
constexpr int kSteadyLuma = 32;  // added to both sums

struct Scene {
    const image::YuvView& picture;
    const BackgroundModel& model;
    std::int32_t inverse_gain;
    bool is_mosaic;
    const BitRows& core;
    const BitRows& near;  // people, two pixels wider
};

// The two colours between which the pixels of a tile decide.
struct Colours {
    std::array<std::int32_t, kPixels> person;  // luma
    std::int32_t person_u;
    std::int32_t person_v;
    std::int32_t light;  // of the room, in 1/256
};

#define ATRIUM_INLINE inline __attribute__((always_inline))

constexpr unsigned kBlock = 0x33;  // the first 2x2 block of a tile's bits
constexpr std::array<int, 4> kBlockAt{0, 2, 8, 10};

// The outside is sampled: one block of four.
ATRIUM_INLINE void sum_up(const Scene& scene, int tile_x, int tile_y, TileSums& tile) {
    auto& sums = tile.sums;
    sums.fill(0);
    tile.row = tile_y;
    const BackgroundModel& model = scene.model;
    const int width = model.width();
    const int x = tile_x * kTile;
    const int y = tile_y * kTile;
    const auto samples_at = [&](int column, int line) {
        return scene.picture.y.row(line) + column;
    };
    if ((scene.near.tile<2>(y, x) & kBlock) == 0) {
        const std::uint8_t* const top = samples_at(x, y);
        const std::uint8_t* const bottom = samples_at(x, y + 1);
        const std::uint16_t* const means =
            model.luma.data() + static_cast<std::ptrdiff_t>(y) * width + x;
        sums[TileSums::kPictureLuma] = top[0] + top[1] + bottom[0] + bottom[1];
        sums[TileSums::kRoomLuma] = means[0] + means[1] + means[width] + means[width + 1];
    }
    const unsigned core = scene.core.tile<4>(y, x);
    if (core == 0) return;
    for (std::size_t block = 0; block < kBlockAt.size(); ++block) {
        if ((core >> kBlockAt[block] & kBlock) != kBlock) continue;
        const int column = x + 2 * static_cast<int>(block % 2);
        const int line = y + 2 * static_cast<int>(block / 2);
        if (column >= width || line >= model.height()) continue;
        const std::uint8_t* const top = samples_at(column, line);
        const std::uint8_t* const bottom = samples_at(column, line + 1);
        ++sums[TileSums::kNumInside];
        sums[TileSums::kLuma] += top[0];
        sums[TileSums::kLuma + 1] += top[1];
        sums[TileSums::kLuma + 2] += bottom[0];
        sums[TileSums::kLuma + 3] += bottom[1];
        sums[TileSums::kU] += scene.picture.u.at(column / 2, line / 2) - 128;
        sums[TileSums::kV] += scene.picture.v.at(column / 2, line / 2) - 128;
    }
}

// False if too little of the person is beside the tile.
ATRIUM_INLINE bool find_colours(const Scene& scene,
                                const std::array<std::int32_t, TileSums::kEnd>& sums,
                                Colours& colours) {
    const std::int32_t num = sums[TileSums::kNumInside];
    if (num < kFewestBlocks) return false;
    // in floating point, which rounds alike with all instruction sets: divisions are slow
    const float scale =
        static_cast<float>(scene.inverse_gain) / static_cast<float>((1 << kGainShift) * num);
    const auto mean = [&](std::int32_t sum) {
        return static_cast<std::int32_t>(static_cast<float>(sum) * scale);
    };
    const std::int32_t* const luma = &sums[TileSums::kLuma];
    std::array<std::int32_t, 4> person;
    if (scene.is_mosaic) {
        for (std::size_t i = 0; i < person.size(); ++i) person[i] = mean(luma[i]);
    } else {
        person.fill(mean(luma[0] + luma[1] + luma[2] + luma[3]) / 4);
    }
    for (std::size_t i = 0; i < kPixels; ++i)
        colours.person[i] = person[2 * (i / kTile % 2) + i % 2];
    colours.person_u = mean(sums[TileSums::kU]);
    colours.person_v = mean(sums[TileSums::kV]);
    const std::int32_t picture =
        (sums[TileSums::kPictureLuma] >> 4) * scene.inverse_gain / (kUnitGain >> 4) + kSteadyLuma;
    const std::int32_t room = (sums[TileSums::kRoomLuma] >> 8) + kSteadyLuma;
    colours.light = std::clamp(picture * 256 / room, kDarkest, kBrightest);
    return true;
}

using Pixels = std::array<std::int32_t, kPixels>;

// Values of a tile's four blocks and the twelve around them, to values of its pixels. A pixel is a
// quarter of a block off the centre of its own.
ATRIUM_INLINE Pixels interpolated(const Pixels& blocks) {
    Pixels columns;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const std::size_t own = 1 + i % kTile / 2;
        const std::size_t beside = i % 2 == 0 ? own - 1 : own + 1;
        const std::size_t row = i / kTile * kTile;
        columns[i] = 3 * blocks[row + own] + blocks[row + beside];
    }
    Pixels pixels;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const std::size_t own = 1 + i / kTile / 2;
        const std::size_t over = i / kTile % 2 == 0 ? own - 1 : own + 1;
        pixels[i] = (3 * columns[own * kTile + i % kTile] + columns[over * kTile + i % kTile]) >> 4;
    }
    return pixels;
}

// Loads the values at x to x + 3 of a row; beyond its ends the nearest one.
template <typename Value>
ATRIUM_INLINE void load_four(const Value* row, int x, int width, Value* out) {
    if (x >= 0 && x + kTile <= width) {
        std::memcpy(out, row + x, kTile * sizeof(Value));
        return;
    }
    for (int k = 0; k < kTile; ++k) out[k] = row[std::clamp(x + k, 0, width - 1)];
}

// How far the pixels of a tile are from either colour.
struct Distances {
    Pixels to_person;
    Pixels to_room;
};

// Distances of chroma, of the blocks of a tile and those around it.
struct ChromaDistances {
    Distances u;
    Distances v;
};

ATRIUM_INLINE ChromaDistances chroma_distances(const Scene& scene,
                                               int tile_x,
                                               int tile_y,
                                               const Colours& colours) {
    const BackgroundModel& model = scene.model;
    const int columns = model.width() / 2;
    const int rows = model.height() / 2;
    std::array<std::uint8_t, kPixels> u, v;
    std::array<std::int16_t, kPixels> room_u, room_v;
    for (int i = 0; i < kTile; ++i) {
        const int y = std::clamp(tile_y * 2 + i - 1, 0, rows - 1);
        const int x = tile_x * 2 - 1;
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y) * columns;
        const auto at = static_cast<std::size_t>(i * kTile);
        load_four(scene.picture.u.row(y), x, columns, &u[at]);
        load_four(scene.picture.v.row(y), x, columns, &v[at]);
        load_four(model.u.data() + first, x, columns, &room_u[at]);
        load_four(model.v.data() + first, x, columns, &room_v[at]);
    }
    ChromaDistances distances;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const std::int32_t now_u = (u[i] - 128) * scene.inverse_gain >> kGainShift;
        const std::int32_t now_v = (v[i] - 128) * scene.inverse_gain >> kGainShift;
        distances.u.to_person[i] = now_u - colours.person_u;
        distances.v.to_person[i] = now_v - colours.person_v;
        distances.u.to_room[i] = now_u - (room_u[i] * colours.light >> 14);
        distances.v.to_room[i] = now_v - (room_v[i] * colours.light >> 14);
    }
    return distances;
}

ATRIUM_INLINE Distances luma_distances(const Scene& scene,
                                       int tile_x,
                                       int tile_y,
                                       const Colours& colours) {
    const BackgroundModel& model = scene.model;
    std::array<std::uint8_t, kPixels> luma;
    std::array<std::uint16_t, kPixels> room;
    for (int line = 0; line < kTile; ++line) {
        const int y = std::min(tile_y * kTile + line, model.height() - 1);
        const auto at = static_cast<std::size_t>(line * kTile);
        load_four(scene.picture.y.row(y), tile_x * kTile, model.width(), &luma[at]);
        load_four(model.luma.data() + static_cast<std::ptrdiff_t>(y) * model.width(),
                  tile_x * kTile,
                  model.width(),
                  &room[at]);
    }
    Distances distances;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const std::int32_t now = luma[i] * scene.inverse_gain >> kGainShift;
        distances.to_person[i] = now - colours.person[i];
        distances.to_room[i] = now - (room[i] * colours.light >> 15);
    }
    return distances;
}

// Returns 4x4 bits per decided pixel (low half), and those that are people (high half).
ATRIUM_INLINE std::uint32_t decide(const Scene& scene,
                                   int tile_x,
                                   int tile_y,
                                   const Colours& colours) {
    const Distances y = luma_distances(scene, tile_x, tile_y, colours);
    const ChromaDistances chroma = chroma_distances(scene, tile_x, tile_y, colours);
    const Pixels person_u = interpolated(chroma.u.to_person);
    const Pixels person_v = interpolated(chroma.v.to_person);
    const Pixels room_u = interpolated(chroma.u.to_room);
    const Pixels room_v = interpolated(chroma.v.to_room);
    Pixels is_sure, is_person;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const auto sum = [](std::int32_t a, std::int32_t b, std::int32_t c) {
            return a * a + b * b + c * c;
        };
        const std::int32_t contrast_sq =
            sum(y.to_person[i] - y.to_room[i], person_u[i] - room_u[i], person_v[i] - room_v[i]);
        const std::int32_t person_sq = sum(y.to_person[i], person_u[i], person_v[i]);
        const std::int32_t room_sq = sum(y.to_room[i], room_u[i], room_v[i]);
        is_sure[i] = contrast_sq >= kLeastSquare ? 1 : 0;
        is_person[i] = scene.model.person_factor * person_sq < 8 * room_sq ? 1 : 0;
    }
    std::uint32_t decision = 0;
    for (std::size_t i = 0; i < kPixels; ++i)
        decision |= static_cast<std::uint32_t>(is_sure[i] | is_person[i] << 16) << i;
    return decision;
}

// Decides one tile; `band` has its pixels to decide, four per row.
ATRIUM_INLINE void refine_tile(const Scene& scene,
                               int tile_x,
                               int tile_y,
                               std::vector<TileSums>& tiles,
                               const BitRows& band,
                               BitRows& people) {
    const int tiles_x = (scene.model.width() + kTile - 1) / kTile;
    const int tiles_y = (scene.model.height() + kTile - 1) / kTile;
    std::array<std::int32_t, TileSums::kEnd> around{};
    const int first = std::max(tile_x - 1, 0);
    const int last = std::min(tile_x + 1, tiles_x - 1);
    for (int y = std::max(tile_y - 1, 0); y <= std::min(tile_y + 1, tiles_y - 1); ++y) {
        TileSums* const row = tiles.data() + static_cast<std::ptrdiff_t>(y % 3) * tiles_x;
        const std::int32_t of_row = kWeights[static_cast<std::size_t>(y - tile_y + 1)];
        for (int x = first; x <= last; ++x) {
            TileSums& tile = row[x];
            if (tile.row != y) sum_up(scene, x, y, tile);
            const std::int32_t weight = of_row * kWeights[static_cast<std::size_t>(x - tile_x + 1)];
            for (std::size_t i = 0; i < around.size(); ++i) around[i] += weight * tile.sums[i];
        }
    }
    Colours colours;
    if (!find_colours(scene, around, colours)) return;
    const std::uint32_t decision = decide(scene, tile_x, tile_y, colours);
    const int x = tile_x * kTile;
    const std::uint32_t decided = decision & band.tile<4>(tile_y * kTile, x);
    const std::uint32_t set = decision >> 16 & decided;
    for (int line = 0; line < kTile; ++line) {
        const int y = tile_y * kTile + line;
        if (y >= people.end_row()) break;
        const std::uint64_t of_line = decided >> (kTile * line) & 15u;
        const std::uint64_t set_of_line = set >> (kTile * line) & 15u;
        std::uint64_t& word = people.row(y)[x / 64 - people.first_word];
        word = (word & ~(of_line << (x % 64))) | set_of_line << (x % 64);
    }
}

ATRIUM_INLINE void refine_rows(const Scene& scene,
                               std::vector<TileSums>& tiles,
                               const BitRows& band,
                               BitRows& people) {
    for (int y = band.first_row; y < band.end_row(); y += kTile) {
        for (int w = 0; w < band.num_words; ++w) {
            std::uint64_t any = 0;
            for (int line = y; line < std::min(y + kTile, band.end_row()); ++line)
                any |= band.row(line)[w];
            while (any != 0) {
                const int four = std::countr_zero(any) / kTile;
                any &= ~(std::uint64_t{15} << (kTile * four));
                const int tile_x = (band.first_word + w) * (64 / kTile) + four;
                if (tile_x * kTile < scene.model.width())
                    refine_tile(scene, tile_x, y / kTile, tiles, band, people);
            }
        }
    }
}

void refine_baseline(const Scene& scene,
                     std::vector<TileSums>& tiles,
                     const BitRows& band,
                     BitRows& people) {
    refine_rows(scene, tiles, band, people);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void refine_avx2(const Scene& scene,
                                                 std::vector<TileSums>& tiles,
                                                 const BitRows& band,
                                                 BitRows& people) {
    refine_rows(scene, tiles, band, people);
}
#endif

#undef ATRIUM_INLINE

// Writes what differs between `before` and `after`.
void write_changes(const BitRows& before,
                   const BitRows& after,
                   const image::Mask& areas,
                   image::SparseMask& mask) {
    for (int y = after.first_row; y < after.end_row(); ++y) {
        std::uint8_t* const row = mask.mask.row(y);
        image::PixelSpan& span = mask.rows[static_cast<std::size_t>(y)];
        for (int w = 0; w < after.num_words; ++w) {
            const std::uint64_t now = after.row(y)[w];
            for (std::uint64_t changed = now ^ before.row(y)[w]; changed != 0;
                 changed &= changed - 1) {
                const int bit = std::countr_zero(changed);
                const int x = (after.first_word + w) * 64 + bit;
                if (x >= mask.mask.width) break;
                const bool is_person =
                    (now >> bit & 1) != 0 && (areas.data.empty() || areas.at(x, y) != 0);
                row[x] = is_person ? 255 : 0;
                if (span.begin == span.end) span = {x, x + 1};
                span = {std::min(span.begin, x), std::max(span.end, x + 1)};
            }
        }
    }
}

}  // namespace

void OutlineRefinement::refine(const image::YuvView& picture,
                               const BackgroundModel& model,
                               std::int16_t inverse_gain,
                               const image::Mask& areas,
                               image::SparseMask& mask,
                               [[maybe_unused]] InstructionSet instructions) {
    if (!pack(mask, kMargin, people_)) return;
    erode(people_, core_);
    erode(core_, inner_);
    dilate(people_, band_);
    dilate(band_, outer_);
    for (std::size_t i = 0; i < band_.words.size(); ++i) band_.words[i] &= ~inner_.words[i];
    inner_ = people_;
    tiles_.assign(static_cast<std::size_t>((model.width() + kTile - 1) / kTile) * 3, {});
    const Scene scene{
        picture, model, inverse_gain, picture.mosaic != image::Mosaic::kNone, core_, outer_};
    auto* refine_all = refine_baseline;
#if defined(__x86_64__)
    if (instructions == InstructionSet::kAvx2) refine_all = refine_avx2;
#endif
    refine_all(scene, tiles_, band_, inner_);
    inner_.repeat_edges();
    majority(inner_, band_, core_);
    write_changes(people_, core_, areas, mask);
}

}  // namespace atrium::segmentation
