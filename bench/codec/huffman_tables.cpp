// Generates core/codec/huffman_tables.hpp: the best code for the textures of the scenes of
// codec_table, with a word for every symbol of baseline JPEG. usage: huffman_tables >
// core/codec/huffman_tables.hpp

#include "bench/codec/codec_frames.hpp"
#include "core/codec/jpeg_writer.hpp"

#include <fmt/format.h>

// jpeglib.h needs what stdio.h declares
#include <jpeglib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <queue>
#include <utility>

namespace atrium::bench {
namespace {

// by symbol; 256: the word of ones, which stays unused
using Counts = std::array<std::uint64_t, 257>;

/// The counts of one kind of component.
struct Statistics {
    Counts dc{};
    Counts ac{};
};

int category(int value) { return std::bit_width(static_cast<unsigned>(std::abs(value))); }

void count_block(const JCOEF* block, int& last_dc, Statistics& out) {
    static constexpr std::array<int, 64> kZigzag{
        0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,  12, 19, 26, 33, 40, 48,
        41, 34, 27, 20, 13, 6,  7,  14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23,
        30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};
    ++out.dc[static_cast<std::size_t>(category(block[0] - last_dc))];
    last_dc = block[0];
    int zeros = 0;
    for (std::size_t k = 1; k < 64; ++k) {
        const int value = block[kZigzag[k]];
        if (value == 0) {
            ++zeros;
            continue;
        }
        for (; zeros > 15; zeros -= 16) ++out.ac[0xF0];
        ++out.ac[static_cast<std::size_t>(zeros << 4 | category(value))];
        zeros = 0;
    }
    if (zeros > 0) ++out.ac[0];
}

void count_picture(std::span<const std::uint8_t> bytes, std::array<Statistics, 2>& out) {
    jpeg_decompress_struct jpeg;
    jpeg_error_mgr errors;
    jpeg.err = jpeg_std_error(&errors);  // an error ends the program
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
    jpeg_read_header(&jpeg, TRUE);
    jvirt_barray_ptr* coefficients = jpeg_read_coefficients(&jpeg);
    for (int c = 0; c < jpeg.num_components; ++c) {
        const jpeg_component_info& info = jpeg.comp_info[c];
        int last_dc = 0;
        for (JDIMENSION row = 0; row < info.height_in_blocks; ++row) {
            const JBLOCKARRAY blocks = jpeg.mem->access_virt_barray(
                reinterpret_cast<j_common_ptr>(&jpeg), coefficients[c], row, 1, FALSE);
            for (JDIMENSION column = 0; column < info.width_in_blocks; ++column)
                count_block(blocks[0][column], last_dc, out[c == 0 ? 0 : 1]);
        }
    }
    jpeg_finish_decompress(&jpeg);
    jpeg_destroy_decompress(&jpeg);
}

// Word length of each symbol with a count; 0 for the others.
std::array<int, 257> word_lengths(const Counts& counts) {
    struct Node {
        std::uint64_t count;
        std::vector<std::size_t> symbols;
        bool operator<(const Node& other) const { return count > other.count; }
    };
    std::priority_queue<Node> nodes;
    for (std::size_t s = 0; s < counts.size(); ++s) {
        if (counts[s] > 0) nodes.push({counts[s], {s}});
    }
    std::array<int, 257> lengths{};
    while (nodes.size() > 1) {
        Node a = nodes.top();
        nodes.pop();
        const Node b = nodes.top();
        nodes.pop();
        a.count += b.count;
        a.symbols.insert(a.symbols.end(), b.symbols.begin(), b.symbols.end());
        for (const std::size_t s : a.symbols) ++lengths[s];
        nodes.push(std::move(a));
    }
    return lengths;
}

void print_table(const char* name, Counts counts) {
    // JPEG allows no word of more than 16 bits
    auto lengths = word_lengths(counts);
    while (*std::max_element(lengths.begin(), lengths.end()) > 16) {
        for (auto& count : counts) count = (count + 1) / 2;
        lengths = word_lengths(counts);
    }
    // the last of the longest words is the word of ones
    lengths[256] = *std::max_element(lengths.begin(), lengths.end());
    std::vector<std::size_t> symbols;
    for (std::size_t s = 0; s < 256; ++s) {
        if (lengths[s] > 0) symbols.push_back(s);
    }
    std::stable_sort(symbols.begin(), symbols.end(), [&](std::size_t a, std::size_t b) {
        return lengths[a] < lengths[b];
    });
    std::array<int, 17> number{};
    for (const std::size_t s : symbols) ++number[static_cast<std::size_t>(lengths[s])];
    fmt::print("inline constexpr HuffmanTable {}{{{{{}}},\n{{{}}}}};\n",
               name,
               fmt::join(number, ","),
               fmt::join(symbols, ","));
}

void add_every_symbol(Statistics& statistics) {
    for (std::size_t size = 0; size <= 11; ++size) ++statistics.dc[size];
    ++statistics.ac[0];
    ++statistics.ac[0xF0];
    for (std::size_t run = 0; run <= 15; ++run) {
        for (std::size_t size = 1; size <= 10; ++size) ++statistics.ac[run << 4 | size];
    }
    ++statistics.dc[256];
    ++statistics.ac[256];
}

int run() {
    std::array<Statistics, 2> statistics;
    auto scenes = simulated_frames(3);
    auto ring = recorded_frames(ATRIUM_SOURCE_DIR "/../shared/data/recordings/ring20", 8);
    if (!scenes || !ring) return 1;
    scenes->push_back(std::move(ring->front()));
    codec::JpegWriter writer;
    for (const CodecFrame& frame : *scenes) {
        for (const CodecView& view : frame.views) {
            const auto bytes = writer.write(view.crop.y, view.crop.u, view.crop.v, 86);
            if (!bytes) return 1;
            count_picture(*bytes, statistics);
        }
    }
    for (Statistics& s : statistics) add_every_symbol(s);
    fmt::print(
        "// Generated by bench/codec/huffman_tables, formatted by clang-format.\n#pragma once\n\n"
        "#include <array>\n#include <cstdint>\n\nnamespace atrium::codec {{\n\n"
        "struct HuffmanTable {{\n    std::array<std::uint8_t, 17> number;  // of words of so many "
        "bits\n    std::array<std::uint8_t, 256> symbols;  // of the words in their "
        "order\n}};\n\n");
    print_table("kLumaDc", statistics[0].dc);
    print_table("kLumaAc", statistics[0].ac);
    print_table("kChromaDc", statistics[1].dc);
    print_table("kChromaAc", statistics[1].ac);
    fmt::print("\n}}  // namespace atrium::codec\n");
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main() { return atrium::bench::run(); }
