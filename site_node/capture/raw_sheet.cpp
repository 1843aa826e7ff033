#include "site_node/capture/raw_sheet.hpp"

#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>

namespace atrium::capture {
namespace {

using image::PixelFormat;

std::size_t as_size(int value) { return static_cast<std::size_t>(value); }

// Separates bytes that repeat every `kStep`: all first ones, then all second ones, ...
template <std::size_t kStep>
void separate(const std::uint8_t* __restrict in, std::size_t num, std::uint8_t* __restrict out) {
    for (std::size_t first = 0; first < kStep; ++first) {
        const std::size_t count = num > first ? (num - first + kStep - 1) / kStep : 0;
        for (std::size_t i = 0; i < count; ++i) out[i] = in[kStep * i + first];
        out += count;
    }
}

template <std::size_t kStep>
void join(const std::uint8_t* __restrict in, std::size_t num, std::uint8_t* __restrict out) {
    for (std::size_t first = 0; first < kStep; ++first) {
        const std::size_t count = num > first ? (num - first + kStep - 1) / kStep : 0;
        for (std::size_t i = 0; i < count; ++i) out[kStep * i + first] = in[i];
        in += count;
    }
}

// 4:2:2, four bytes of two pixels: luma of the whole row, then u, then v.
void separate_422(const std::uint8_t* __restrict in,
                  std::size_t num,
                  std::size_t luma,
                  std::uint8_t* __restrict out) {
    const std::size_t quarter = num / 4;
    for (std::size_t i = 0; i < 2 * quarter; ++i) out[i] = in[2 * i + luma];
    for (std::size_t i = 0; i < quarter; ++i) out[2 * quarter + i] = in[4 * i + 1 - luma];
    for (std::size_t i = 0; i < quarter; ++i) out[3 * quarter + i] = in[4 * i + 3 - luma];
}

void join_422(const std::uint8_t* __restrict in,
              std::size_t num,
              std::size_t luma,
              std::uint8_t* __restrict out) {
    const std::size_t quarter = num / 4;
    for (std::size_t i = 0; i < 2 * quarter; ++i) out[2 * i + luma] = in[i];
    for (std::size_t i = 0; i < quarter; ++i) out[4 * i + 1 - luma] = in[2 * quarter + i];
    for (std::size_t i = 0; i < quarter; ++i) out[4 * i + 3 - luma] = in[3 * quarter + i];
}

bool is_packed_colour(PixelFormat format) {
    return format == PixelFormat::kRgb || format == PixelFormat::kBgr;
}

bool is_422(PixelFormat format) {
    return format == PixelFormat::kUyvy || format == PixelFormat::kYuyv;
}

// Calls `visit(offset in the packed bytes, offset in the sheet)` for each row of a mosaic or of
// chroma.
template <typename Visit>
void visit_rows(const RawLayout& layout, Visit visit) {
    const bool is_mosaic = image::mosaic_of(layout.format) != image::Mosaic::kNone;
    const std::size_t row = image::row_bytes(layout.format, layout.width);
    const std::size_t num = as_size(layout.height);
    for (std::size_t y = 0; y < num; ++y) {
        const std::size_t in_sheet = is_mosaic ? (y % 2 == 0 ? y / 2 : (num + 1) / 2 + y / 2) : y;
        visit(y * row, in_sheet * row);
    }
}

// Planes of 4:2:0: u and v lie beside each other in the sheet, below the luma.
template <typename Visit>
void visit_chroma_rows(const RawLayout& layout, Visit visit) {
    const std::size_t luma = as_size(layout.width) * as_size(layout.height);
    const std::size_t row = as_size(layout.width) / 2;
    const std::size_t num = as_size(layout.height) / 2;
    for (std::size_t y = 0; y < num; ++y) {
        visit(luma + y * row, luma + 2 * y * row, row);
        visit(luma + (num + y) * row, luma + (2 * y + 1) * row, row);
    }
}

}  // namespace

bool is_valid(const RawLayout& layout) {
    const auto fits = [](int value) { return value >= 2 && value <= kMaxRawSize_px; };
    if (layout.format > PixelFormat::kYuyv || !fits(layout.width) || !fits(layout.height))
        return false;
    const bool is_even = layout.width % 2 == 0 && layout.height % 2 == 0;
    return layout.format != PixelFormat::kYuv420 || is_even;
}

RawLayout layout_of(const image::RawImage& picture) {
    return {picture.format, picture.width, picture.height};
}

std::size_t packed_bytes(const RawLayout& layout) {
    const std::size_t first =
        image::row_bytes(layout.format, layout.width) * as_size(layout.height);
    return layout.format == PixelFormat::kYuv420 ? first / 2 * 3 : first;
}

void pack(const image::RawImage& picture, std::vector<std::uint8_t>& out) {
    assert(!picture.empty());
    const RawLayout layout = layout_of(picture);
    out.resize(packed_bytes(layout));
    std::uint8_t* to = out.data();
    const auto copy = [&](const image::RawImage::RawPlane& plane, std::size_t row, int num_rows) {
        if (plane.stride_bytes == row) {
            to = std::copy_n(plane.data, row * as_size(num_rows), to);
            return;
        }
        for (int y = 0; y < num_rows; ++y)
            to = std::copy_n(plane.data + as_size(y) * plane.stride_bytes, row, to);
    };
    copy(picture.planes[0], image::row_bytes(layout.format, layout.width), layout.height);
    if (layout.format != PixelFormat::kYuv420) return;
    copy(picture.planes[1], as_size(layout.width) / 2, layout.height / 2);
    copy(picture.planes[2], as_size(layout.width) / 2, layout.height / 2);
}

image::RawImage unpack(const RawLayout& layout, std::vector<std::uint8_t> bytes) {
    assert(bytes.size() == packed_bytes(layout));
    auto memory = std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes));
    image::RawImage picture;
    picture.format = layout.format;
    picture.width = layout.width;
    picture.height = layout.height;
    picture.planes[0] = {memory->data(), image::row_bytes(layout.format, layout.width)};
    if (layout.format == PixelFormat::kYuv420) {
        const std::size_t half = as_size(layout.width) / 2;
        const std::uint8_t* const u =
            memory->data() + as_size(layout.width) * as_size(layout.height);
        picture.planes[1] = {u, half};
        picture.planes[2] = {u + half * (as_size(layout.height) / 2), half};
    }
    picture.owner = std::move(memory);
    return picture;
}

SheetSize sheet_size(const RawLayout& layout) {
    if (layout.format == PixelFormat::kYuv420) return {layout.width, layout.height / 2 * 3};
    if (is_packed_colour(layout.format)) return {layout.width, 3 * layout.height};
    return {static_cast<int>(image::row_bytes(layout.format, layout.width)), layout.height};
}

void to_sheet(const RawLayout& layout,
              std::span<const std::uint8_t> packed,
              std::span<std::uint8_t> sheet) {
    assert(packed.size() == packed_bytes(layout) && sheet.size() == packed.size());
    const std::size_t row = image::row_bytes(layout.format, layout.width);
    const std::size_t luma = layout.format == PixelFormat::kUyvy ? 1 : 0;
    if (is_packed_colour(layout.format)) {
        separate<3>(packed.data(), packed.size(), sheet.data());
        return;
    }
    visit_rows(layout, [&](std::size_t from, std::size_t to) {
        if (image::mosaic_of(layout.format) != image::Mosaic::kNone) {
            separate<2>(&packed[from], row, &sheet[to]);
        } else if (is_422(layout.format)) {
            separate_422(&packed[from], row, luma, &sheet[to]);
        } else {
            std::copy_n(&packed[from], row, &sheet[to]);
        }
    });
    if (layout.format != PixelFormat::kYuv420) return;
    visit_chroma_rows(layout, [&](std::size_t from, std::size_t to, std::size_t num) {
        std::copy_n(&packed[from], num, &sheet[to]);
    });
}

void from_sheet(const RawLayout& layout,
                std::span<const std::uint8_t> sheet,
                std::span<std::uint8_t> packed) {
    assert(packed.size() == packed_bytes(layout) && sheet.size() == packed.size());
    const std::size_t row = image::row_bytes(layout.format, layout.width);
    const std::size_t luma = layout.format == PixelFormat::kUyvy ? 1 : 0;
    if (is_packed_colour(layout.format)) {
        join<3>(sheet.data(), sheet.size(), packed.data());
        return;
    }
    visit_rows(layout, [&](std::size_t from, std::size_t to) {
        if (image::mosaic_of(layout.format) != image::Mosaic::kNone) {
            join<2>(&sheet[to], row, &packed[from]);
        } else if (is_422(layout.format)) {
            join_422(&sheet[to], row, luma, &packed[from]);
        } else {
            std::copy_n(&sheet[to], row, &packed[from]);
        }
    });
    if (layout.format != PixelFormat::kYuv420) return;
    visit_chroma_rows(layout, [&](std::size_t from, std::size_t to, std::size_t num) {
        std::copy_n(&sheet[to], num, &packed[from]);
    });
}

}  // namespace atrium::capture
