#include "core/codec/jpeg_writer.hpp"

#include "core/codec/huffman_tables.hpp"

// jpeglib.h needs what stdio.h declares
#include <jpeglib.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <string>

namespace atrium::codec {
namespace {

constexpr int kBlock = DCTSIZE;

/// The library reports errors by longjmp: no object with a destructor may live in between.
struct ErrorManager {
    jpeg_error_mgr base;
    std::jmp_buf where;
    std::array<char, JMSG_LENGTH_MAX> message{};
};

[[noreturn]] void leave(j_common_ptr info) {
    auto* errors = reinterpret_cast<ErrorManager*>(info->err);
    info->err->format_message(info, errors->message.data());
    std::longjmp(errors->where, 1);
}

void ignore_message(j_common_ptr) {}

void use(const HuffmanTable& table, JHUFF_TBL& out) {
    std::copy(table.number.begin(), table.number.end(), out.bits);
    std::copy(table.symbols.begin(), table.symbols.end(), out.huffval);
    out.sent_table = FALSE;
}

int padded(int size) { return (size + kBlock - 1) / kBlock * kBlock; }

}  // namespace

int quantisation_step(int quality) {
    assert(quality >= 1 && quality <= 100);
    constexpr double kStepAt50 = 48.0;
    const double scale = quality < 50 ? 50.0 / quality : 2.0 - 0.02 * quality;
    return std::clamp(static_cast<int>(std::lround(kStepAt50 * scale)), 1, 255);
}

struct JpegWriter::State {
    jpeg_compress_struct jpeg{};
    ErrorManager errors;
    bool is_ready = false;
    std::vector<unsigned char> out;    // holds the worst case; the result is much smaller
    std::vector<unsigned char> strip;  // eight rows per plane, padded to blocks, plus one block
    std::array<std::array<JSAMPROW, kBlock>, 3> rows{};

    State() {
        jpeg.err = jpeg_std_error(&errors.base);
        errors.base.error_exit = leave;
        errors.base.output_message = ignore_message;
        if (setjmp(errors.where) != 0) return;
        jpeg_create_compress(&jpeg);
        is_ready = true;
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (is_ready) jpeg_destroy_compress(&jpeg);
    }

    void reserve(int width, int height) {
        // a coefficient takes at most 26 bits, and each byte may need a stuffed one
        constexpr std::size_t kHeaderBytes = 4096;
        const std::size_t samples =
            3 * static_cast<std::size_t>(padded(width)) * static_cast<std::size_t>(padded(height));
        out.resize(std::max(out.size(), 7 * samples + kHeaderBytes));
        strip.resize(static_cast<std::size_t>(3 * kBlock * padded(width) + kBlock));
        for (std::size_t p = 0; p < 3; ++p) {
            for (std::size_t y = 0; y < kBlock; ++y)
                rows[p][y] =
                    strip.data() + (p * kBlock + y) * static_cast<std::size_t>(padded(width));
        }
    }

    void fill_strip(const std::array<const image::Plane*, 3>& planes, int first_row) {
        for (std::size_t p = 0; p < 3; ++p) {
            const image::Plane& plane = *planes[p];
            for (int y = 0; y < kBlock; ++y) {
                const std::uint8_t* from = plane.row(std::min(first_row + y, plane.height - 1));
                unsigned char* to = rows[p][static_cast<std::size_t>(y)];
                std::copy_n(from, plane.width, to);
                // always a whole block: the next row overwrites the excess
                std::memset(to + plane.width, from[plane.width - 1], kBlock);
            }
        }
    }

    void start(int width, int height, int quality) {
        jpeg.image_width = static_cast<JDIMENSION>(width);
        jpeg.image_height = static_cast<JDIMENSION>(height);
        jpeg.input_components = 3;
        jpeg.in_color_space = JCS_YCbCr;
        jpeg_set_defaults(&jpeg);
        std::array<unsigned, DCTSIZE2> steps;
        steps.fill(static_cast<unsigned>(quantisation_step(quality)));
        jpeg_add_quant_table(&jpeg, 0, steps.data(), 100, TRUE);
        for (int p = 0; p < 3; ++p) {
            jpeg.comp_info[p].h_samp_factor = jpeg.comp_info[p].v_samp_factor = 1;
            jpeg.comp_info[p].quant_tbl_no = 0;
        }
        jpeg.raw_data_in = TRUE;
        use(kLumaDc, *jpeg.dc_huff_tbl_ptrs[0]);
        use(kLumaAc, *jpeg.ac_huff_tbl_ptrs[0]);
        use(kChromaDc, *jpeg.dc_huff_tbl_ptrs[1]);
        use(kChromaAc, *jpeg.ac_huff_tbl_ptrs[1]);
        jpeg.dct_method = JDCT_ISLOW;
        jpeg_start_compress(&jpeg, TRUE);
    }
};

JpegWriter::JpegWriter() : state_(std::make_unique<State>()) {}
JpegWriter::~JpegWriter() = default;

Expected<std::span<const std::uint8_t>> JpegWriter::write(const image::Plane& y,
                                                          const image::Plane& u,
                                                          const image::Plane& v,
                                                          int quality) {
    State& state = *state_;
    assert(y.width > 0 && y.height > 0 && y.data.size() == u.data.size() &&
           y.data.size() == v.data.size());
    if (!state.is_ready) return make_error(ErrorKind::kInternal, "JPEG encoder: cannot be created");
    state.reserve(y.width, y.height);
    unsigned char* buffer = state.out.data();
    unsigned long size = state.out.size();
    const std::array<const image::Plane*, 3> planes{&y, &u, &v};
    std::array<JSAMPARRAY, 3> rows{
        state.rows[0].data(), state.rows[1].data(), state.rows[2].data()};
    if (setjmp(state.errors.where) != 0) {
        jpeg_abort_compress(&state.jpeg);
        return make_error(ErrorKind::kInternal,
                          std::string("JPEG encoder: ") + state.errors.message.data());
    }
    // the buffer holds the worst case: the library never replaces it
    jpeg_mem_dest(&state.jpeg, &buffer, &size);
    state.start(y.width, y.height, quality);
    for (int first_row = 0; first_row < y.height; first_row += kBlock) {
        state.fill_strip(planes, first_row);
        jpeg_write_raw_data(&state.jpeg, rows.data(), kBlock);
    }
    jpeg_finish_compress(&state.jpeg);
    return std::span<const std::uint8_t>(state.out.data(), size);
}

}  // namespace atrium::codec
