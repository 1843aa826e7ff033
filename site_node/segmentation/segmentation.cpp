#include "site_node/segmentation/segmentation.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

namespace atrium::segmentation {
namespace {

// Size of a cell. All stages work on one row of cells before the next row, to find it in the cache.
constexpr int kCellWidth = kTestCell;
constexpr int kCellHeight = 16;
// Rows kept before the majority: the cell row being cleaned, the one below, and room for the last
// row above.
constexpr int kRawRows = 3 * kCellHeight;

int num_cells(int size, int cell_size) { return (size + cell_size - 1) / cell_size; }

// Pictures are in no cache, and their rows are too short for the hardware prefetcher.
void fetch_row(const std::uint8_t* row, int num_bytes) {
    constexpr int kCacheLine = 64;
    for (int x = 0; x < num_bytes; x += kCacheLine) __builtin_prefetch(row + x);
}

void fetch_rows(const image::YuvView& picture, int y) {
    if (y + 2 > picture.height()) return;
    fetch_row(picture.y.row(y), picture.width());
    fetch_row(picture.y.row(y + 1), picture.width());
    fetch_row(picture.u.row(y / 2), picture.width() / 2);
    fetch_row(picture.v.row(y / 2), picture.width() / 2);
}

}  // namespace

Segmenter::Segmenter(BackgroundStatistics room,
                     const SegmentationOptions& options,
                     const SegmentationAreas& areas)
    : options_(options), model_(make_model(std::move(room), options)) {
    if (!areas.everywhere()) areas_ = rasterise(areas, model_.width(), model_.height());
    const auto width = static_cast<std::size_t>(model_.width());
    const auto columns = static_cast<std::size_t>(num_cells(model_.width(), kCellWidth));
    raw_.resize(kRawRows * width);
    near_people_.resize(columns);
    has_people_.resize(columns * static_cast<std::size_t>(num_cells(model_.height(), kCellHeight)));
}

Expected<void> Segmenter::segment(const image::YuvView& frame, image::Mask& out) {
    image::WorkingPicture made(frame);
    std::swap(whole_.mask, out);
    whole_.forget();
    auto segmented = segment(made, whole_);
    std::swap(whole_.mask, out);
    return segmented;
}

Expected<void> Segmenter::segment(image::WorkingPicture& picture,
                                  image::SparseMask& out,
                                  const GiveWay& give_way) {
    const image::YuvView& frame = picture.view();
    const BackgroundStatistics& room = model_.room;
    if (frame.width() != room.width || frame.height() != room.height ||
        frame.u.width != room.width / 2 || frame.u.height != room.height / 2 ||
        frame.v.width != frame.u.width || frame.v.height != frame.u.height) {
        return make_error(ErrorKind::kInvalidData,
                          "picture of " + std::to_string(frame.width()) + "x" +
                              std::to_string(frame.height()) +
                              " px, but the empty room was learned at " +
                              std::to_string(room.width) + "x" + std::to_string(room.height));
    }
    if (frame.mosaic != room.mosaic) {
        return make_error(ErrorKind::kInvalidData,
                          "the empty room was learned from pictures with another colour mosaic");
    }
    if (out.mask.width != room.width || out.mask.height != room.height) {
        out.mask = image::Mask(room.width, room.height);
        out.forget();
    }
    test_and_clean(picture, out, give_way);
    light_.follow(picture, out, options_, model_);
    return {};
}

std::uint8_t* Segmenter::raw_row(int y) {
    return raw_.data() + static_cast<std::ptrdiff_t>(y % kRawRows) * model_.width();
}

// Tests two rows of each four and finds the cells with foreground there.
void Segmenter::test_first_rows(image::WorkingPicture& picture,
                                int cell_row,
                                std::int16_t inverse_gain) {
    const InstructionSet instructions = best_instruction_set();
    const int width = model_.width();
    const int begin = cell_row * kCellHeight;
    const int end = std::min(begin + kCellHeight, model_.height());
    const std::size_t columns = near_people_.size();
    std::uint8_t* const has = has_people_.data() + static_cast<std::size_t>(cell_row) * columns;
    std::fill_n(has, columns, std::uint8_t{0});
    for (int y = begin; y < end; y += 4) {
        const image::PixelRect rows{0, y, width, 2};
        picture.make(rows);
        fetch_rows(picture.view(), y + 4);
        test_part(picture.view(),
                  model_,
                  inverse_gain,
                  instructions,
                  rows,
                  {raw_row(y), raw_row(y + 1), has});
    }
}

// Tests the other two rows of each four, in cells with foreground and their neighbours.
void Segmenter::test_remaining_rows(image::WorkingPicture& picture,
                                    int cell_row,
                                    std::int16_t inverse_gain) {
    const InstructionSet instructions = best_instruction_set();
    const int width = model_.width();
    const auto columns = static_cast<int>(near_people_.size());
    const int cell_rows = num_cells(model_.height(), kCellHeight);
    std::fill(near_people_.begin(), near_people_.end(), std::uint8_t{0});
    for (int row = std::max(cell_row - 1, 0); row <= std::min(cell_row + 1, cell_rows - 1); ++row) {
        const std::uint8_t* const has =
            has_people_.data() + static_cast<std::ptrdiff_t>(row) * columns;
        for (int cell = 0; cell < columns; ++cell) {
            if (has[cell] == 0) continue;
            for (int near = std::max(cell - 1, 0); near <= std::min(cell + 1, columns - 1); ++near)
                near_people_[static_cast<std::size_t>(near)] = 1;
        }
    }
    const int begin = cell_row * kCellHeight;
    const int end = std::min(begin + kCellHeight, model_.height());
    for (int y = begin + 2; y < end; y += 4) {
        std::memset(raw_row(y), 0, static_cast<std::size_t>(width));
        std::memset(raw_row(y + 1), 0, static_cast<std::size_t>(width));
    }
    for (int cell = 0; cell < columns;) {
        if (near_people_[static_cast<std::size_t>(cell)] == 0) {
            ++cell;
            continue;
        }
        const int first = cell;
        while (cell < columns && near_people_[static_cast<std::size_t>(cell)] != 0) ++cell;
        const int right = std::min(cell * kCellWidth, width);
        const int left = first * kCellWidth;
        for (int y = begin + 2; y < end; y += 4) {
            const image::PixelRect part{left, y, right - left, 2};
            picture.make(part);
            test_part(picture.view(),
                      model_,
                      inverse_gain,
                      instructions,
                      part,
                      {raw_row(y), raw_row(y + 1)});
        }
    }
}

// Returns the columns outside of which these rows are background after the majority.
image::PixelSpan Segmenter::active_columns(int cell_row) const {
    const auto columns = static_cast<int>(near_people_.size());
    const int cell_rows = num_cells(model_.height(), kCellHeight);
    int first = columns;
    int last = -1;
    for (int row = std::max(cell_row - 1, 0); row <= std::min(cell_row + 1, cell_rows - 1); ++row) {
        const std::uint8_t* const has =
            has_people_.data() + static_cast<std::ptrdiff_t>(row) * columns;
        for (int cell = 0; cell < columns; ++cell) {
            if (has[cell] == 0) continue;
            first = std::min(first, cell);
            last = std::max(last, cell);
        }
    }
    if (last < 0) return {0, 0};
    // tested cells extend one beyond those with foreground, and their majority one pixel more
    const int end = std::min((last + 3) * kCellWidth, model_.width());
    const int begin = std::max(first - 2, 0) * kCellWidth;
    return {std::min(begin, std::max(end - kCellWidth, 0)), end};
}

void Segmenter::clean_row(int y, const image::PixelSpan& columns, image::SparseMask& out) {
    std::uint8_t* const row = out.mask.row(y);
    image::PixelSpan& span = out.rows[static_cast<std::size_t>(y)];
    // clears the old foreground that is not overwritten below
    std::fill(row + span.begin,
              row + std::max(span.begin, std::min(span.end, columns.begin)),
              std::uint8_t{0});
    std::fill(row + std::min(span.end, std::max(span.begin, columns.end)),
              row + span.end,
              std::uint8_t{0});
    span = columns;
    if (columns.begin == columns.end) return add_runs(row, model_.width(), columns, clean_);
    majority_3x3({raw_row(std::max(y - 1, 0)) + columns.begin,
                  raw_row(y) + columns.begin,
                  raw_row(std::min(y + 1, model_.height() - 1)) + columns.begin,
                  columns.end - columns.begin},
                 best_instruction_set(),
                 clean_,
                 row + columns.begin);
    if (!areas_.data.empty()) {
        const std::uint8_t* area = areas_.row(y);
        for (int x = columns.begin; x < columns.end; ++x) row[x] &= area[x];
    }
    add_runs(row, model_.width(), columns, clean_);
}

void Segmenter::test_and_clean(image::WorkingPicture& picture,
                               image::SparseMask& out,
                               const GiveWay& give_way) {
    const std::int16_t inverse_gain = light_.inverse_gain(picture, model_, options_);
    inverse_gain_ = inverse_gain;
    const int height = model_.height();
    const int cell_rows = num_cells(height, kCellHeight);
    start_runs(clean_);
    test_first_rows(picture, 0, inverse_gain);
    for (int cell_row = 0; cell_row < cell_rows; ++cell_row) {
        if (cell_row + 1 < cell_rows) test_first_rows(picture, cell_row + 1, inverse_gain);
        test_remaining_rows(picture, cell_row, inverse_gain);
        const image::PixelSpan columns = active_columns(cell_row);
        const int end = std::min((cell_row + 1) * kCellHeight, height);
        for (int y = cell_row * kCellHeight; y < end; ++y) clean_row(y, columns, out);
        give_way();
    }
    remove_small_runs(out, options_.min_area_px, options_.max_hole_px, clean_);
    if (options_.refine_outline) outline_.refine(picture.view(), model_, inverse_gain, areas_, out);
}

}  // namespace atrium::segmentation
