#include "core/codec/edgebreaker_reader.hpp"

#include "core/codec/bit_window.hpp"

#include <draco/attributes/geometry_attribute.h>
#include <draco/compression/bit_coders/rans_bit_decoder.h>
#include <draco/compression/config/compression_shared.h>
#include <draco/compression/entropy/rans_symbol_decoder.h>
#include <draco/compression/entropy/symbol_decoding.h>
#include <draco/core/decoder_buffer.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace atrium::codec {

namespace {

using Corner = EdgebreakerTopology::Corner;

// Coordinates and residuals up to these bounds are added as floats without rounding.
constexpr std::int32_t kMaxCoordinate = (1 << 21) - 1;
constexpr std::uint32_t kMaxResidualBits = 22;  // including the sign

std::span<const std::uint8_t> rest_of(const draco::DecoderBuffer& in) {
    return {reinterpret_cast<const std::uint8_t*>(in.data_head()),
            static_cast<std::size_t>(in.remaining_size())};
}

template <std::size_t N>
bool skip(draco::DecoderBuffer& in, const std::array<std::uint8_t, N>& expected) {
    std::array<std::uint8_t, N> found;
    return in.Decode(found.data(), N) && found == expected;
}

// "DRACO", version 2.2, triangular mesh, edgebreaker, no flags (no metadata), standard symbols
constexpr std::array<std::uint8_t, 12> kStart{'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0, 0};

// Description of the attribute and its coding, as EdgebreakerWriter writes it.
constexpr std::array<std::uint8_t, 14> kAttribute{
    1,     // number of attribute decoders
    0xff,  // uses the connectivity of the mesh
    draco::MESH_VERTEX_ATTRIBUTE,
    draco::MESH_TRAVERSAL_DEPTH_FIRST,
    1,  // number of attributes
    draco::GeometryAttribute::POSITION,
    draco::DT_FLOAT32,
    3,  // components
    0,  // not normalised
    0,  // unique id
    draco::SEQUENTIAL_ATTRIBUTE_ENCODER_QUANTIZATION,
    draco::MESH_PREDICTION_PARALLELOGRAM,
    draco::PREDICTION_TRANSFORM_WRAP,
    1,  // residuals are coded
};

using Symbols = std::array<std::uint32_t, 4>;  // the last element is 0

// The sign is in the lowest bit.
Eigen::Array4f residual_of(const Symbols& symbols) {
    Eigen::Array4f residual;
    for (std::size_t i = 0; i < symbols.size(); ++i) {
        const std::uint32_t sign = 0U - (symbols[i] & 1U);
        residual[static_cast<Eigen::Index>(i)] =
            static_cast<float>(static_cast<std::int32_t>((symbols[i] >> 1U) ^ sign));
    }
    return residual;
}

}  // namespace

bool EdgebreakerReader::read_handles(draco::DecoderBuffer& in) {
    std::uint32_t num_handles = 0;
    if (!draco::DecodeVarint(&num_handles, &in)) return false;
    handles_.clear();
    if (num_handles == 0) return true;
    // a handle takes at least two bytes
    if (num_handles > rest_of(in).size() / 2) return false;
    handles_.resize(num_handles);
    std::uint32_t last_symbol = 0;
    for (HandleEvent& handle : handles_) {
        std::uint32_t from_last = 0;
        std::uint32_t to_split = 0;
        if (!draco::DecodeVarint(&from_last, &in) || !draco::DecodeVarint(&to_split, &in) ||
            from_last >= coded_.num_symbols - last_symbol)
            return false;
        handle.symbol = last_symbol + from_last;
        if (to_split > handle.symbol) return false;
        handle.split_symbol = handle.symbol - to_split;
        last_symbol = handle.symbol;
    }
    const std::size_t num_bytes = (handles_.size() + 7) / 8;
    const auto sides = rest_of(in);
    if (num_bytes > sides.size()) return false;
    for (std::size_t i = 0; i < handles_.size(); ++i)
        handles_[i].on_right = (sides[i / 8] >> (i % 8) & 1U) != 0;
    in.Advance(static_cast<std::int64_t>(num_bytes));
    return true;
}

bool EdgebreakerReader::read_topology(draco::DecoderBuffer& in,
                                      const MeshLimits& limits,
                                      geometry::TriangleMesh& out) {
    coded_ = {};
    std::uint64_t num_bytes = 0;
    if (!draco::DecodeVarint(&coded_.num_vertices, &in) ||
        !draco::DecodeVarint(&coded_.num_triangles, &in) ||
        coded_.num_vertices > limits.max_vertices || coded_.num_triangles > limits.max_triangles ||
        !skip<1>(in, {0}) ||  // number of attributes with separate connectivity
        !draco::DecodeVarint(&coded_.num_symbols, &in) ||
        !draco::DecodeVarint(&coded_.num_splits, &in) || !read_handles(in) ||
        !draco::DecodeVarint(&num_bytes, &in) || num_bytes > rest_of(in).size())
        return false;
    coded_.handles = handles_;
    coded_.symbol_bits = rest_of(in).first(num_bytes);
    in.Advance(static_cast<std::int64_t>(num_bytes));
    if (!topology_.build(coded_, out.triangles)) return false;
    draco::RAnsBitDecoder starts;
    if (!starts.StartDecoding(&in)) return false;
    for (std::uint32_t i = coded_.num_symbols; i < coded_.num_triangles; ++i) {
        if (!starts.DecodeNextBit()) return false;  // the component has a boundary
    }
    return skip(in, kAttribute);
}

bool EdgebreakerReader::read_tagged_residuals(draco::DecoderBuffer& in) {
    draco::RAnsSymbolDecoder<5> tags;
    if (!tags.Create(&in) || !tags.StartDecoding(&in) || tags.num_symbols() == 0) return false;
    const auto bytes = rest_of(in);
    const BitWindow bits(bytes);
    std::size_t position = 0;
    for (Position& residual : residuals_) {
        const std::uint32_t num_bits = tags.DecodeSymbol();
        if (num_bits > kMaxResidualBits) return false;
        const std::uint64_t mask = (std::uint64_t{1} << num_bits) - 1;
        const auto take = [&](std::uint64_t& window) {
            const auto symbol = static_cast<std::uint32_t>(window & mask);
            window >>= num_bits;
            return symbol;
        };
        std::uint64_t window = bits.at(position);
        Symbols symbols{take(window), take(window), 0, 0};
        if (3 * num_bits > BitWindow::kNumBits) window = bits.at(position + 2 * num_bits);
        symbols[2] = take(window);
        position += 3 * num_bits;
        residual = residual_of(symbols);
    }
    if (position > bits.num_bits()) return false;
    in.Advance(static_cast<std::int64_t>((position + 7) / 8));
    return true;
}

bool EdgebreakerReader::read_untagged_residuals(draco::DecoderBuffer& in) {
    untagged_.resize(3 * residuals_.size());
    if (!draco::DecodeSymbols(
            static_cast<std::uint32_t>(untagged_.size()), 3, &in, untagged_.data()))
        return false;
    if (std::ranges::max(untagged_) >> kMaxResidualBits != 0) return false;
    for (std::size_t i = 0; i < residuals_.size(); ++i)
        residuals_[i] =
            residual_of({untagged_[3 * i], untagged_[3 * i + 1], untagged_[3 * i + 2], 0});
    return true;
}

bool EdgebreakerReader::read_residuals(draco::DecoderBuffer& in) {
    std::uint8_t kind = 0;
    if (!in.Peek(&kind)) return false;
    residuals_.resize(coded_.num_vertices);
    if (kind != draco::SYMBOL_CODING_TAGGED) return read_untagged_residuals(in);
    in.Advance(1);
    return read_tagged_residuals(in);
}

// Visits the triangles in the order of `traverse`. A new vertex is predicted from the triangle
// before the gate; the first vertices of a component are predicted from the last vertex.
bool EdgebreakerReader::read_positions(draco::DecoderBuffer& in,
                                       std::span<const std::uint32_t> corners) {
    if (!in.Decode(&lowest_) || !in.Decode(&highest_) || lowest_ < 0 || lowest_ > highest_ ||
        highest_ > kMaxCoordinate)
        return false;
    const auto lowest = static_cast<float>(lowest_);
    const auto highest = static_cast<float>(highest_);
    const Position low(lowest, lowest, lowest, 0.0F);
    const Position high(highest, highest, highest, 0.0F);
    const Position num_values(
        highest - lowest + 1.0F, highest - lowest + 1.0F, highest - lowest + 1.0F, 0.0F);
    positions_.resize(coded_.num_vertices);
    seen_vertices_.assign(coded_.num_vertices, 0);
    seen_triangles_.assign(coded_.num_triangles, 0);
    // local copies, for the compiler to keep in registers
    const std::span<const Corner> opposite = topology_.opposites();
    const std::span<Position> positions = positions_;
    const std::span<std::uint8_t> seen_vertices = seen_vertices_;
    const std::span<std::uint8_t> seen_triangles = seen_triangles_;
    const Position* residual = residuals_.data();
    const Position* const end = residual + residuals_.size();
    Position last = Position::Zero();
    Position least = low;
    Position most = high;
    const auto add = [&](std::uint32_t vertex, const Position& prediction) {
        // positions wrap around the interval of all coordinates
        Position position = prediction.max(low).min(high) + *residual++;
        position -= num_values * (position - high).max(0.0F).min(1.0F);
        position += num_values * (low - position).max(0.0F).min(1.0F);
        least = least.min(position);
        most = most.max(position);
        positions[vertex] = position;
        last = position;
        seen_vertices[vertex] = 1;
    };
    const auto add_first = [&](Corner corner) {
        const std::uint32_t vertex = corners[corner];
        if (seen_vertices[vertex] != 0) return false;
        const std::uint32_t a = corners[EdgebreakerTopology::next(corner)];
        const std::uint32_t b = corners[EdgebreakerTopology::previous(corner)];
        const std::uint32_t behind = corners[opposite[corner]];
        const bool is_known =
            seen_vertices[a] != 0 && seen_vertices[b] != 0 && seen_vertices[behind] != 0;
        add(vertex, is_known ? Position(positions[a] + positions[b] - positions[behind]) : last);
        return true;
    };
    for (Corner first = 0; first < corners.size() && residual != end; first += 3) {
        if (seen_triangles[first / 3] != 0) continue;
        add_first(first + 1);
        add_first(first + 2);
        stack_.assign(1, first);
        if (add_first(first)) {
            seen_triangles[first / 3] = 1;
            stack_.assign(1, opposite[first + 1]);
        }
        while (!stack_.empty()) {
            Corner corner = stack_.back();
            stack_.pop_back();
            if (seen_triangles[corner / 3] != 0) continue;
            std::uint32_t a = corners[EdgebreakerTopology::next(corner)];
            std::uint32_t b = corners[EdgebreakerTopology::previous(corner)];
            std::uint32_t behind = corners[opposite[corner]];
            for (;;) {
                seen_triangles[corner / 3] = 1;
                const std::uint32_t vertex = corners[corner];
                const Corner right = opposite[EdgebreakerTopology::next(corner)];
                if (seen_vertices[vertex] == 0) {
                    add(vertex, positions[a] + positions[b] - positions[behind]);
                    behind = a;
                    a = vertex;
                    corner = right;
                    continue;
                }
                const Corner left = opposite[EdgebreakerTopology::previous(corner)];
                const bool has_seen_right = seen_triangles[right / 3] != 0;
                const bool has_seen_left = seen_triangles[left / 3] != 0;
                if (has_seen_right) {
                    if (has_seen_left) break;
                    behind = b;
                    b = vertex;
                    corner = left;
                } else {
                    if (!has_seen_left) stack_.push_back(left);
                    behind = a;
                    a = vertex;
                    corner = right;
                }
            }
        }
    }
    return residual == end && (least == low).all() && (most == high).all();
}

bool EdgebreakerReader::read_vertices(draco::DecoderBuffer& in,
                                      double max_coordinate_m,
                                      std::vector<Eigen::Vector3d>& vertices) const {
    std::array<float, 3> origin_m;
    float range_m = 0.0F;
    std::uint8_t position_bits = 0;
    constexpr int kMostPositionBits = 30;  // Draco's limit
    if (!in.Decode(origin_m.data(), sizeof origin_m) || !in.Decode(&range_m) ||
        !in.Decode(&position_bits) || position_bits < 1 || position_bits > kMostPositionBits ||
        in.remaining_size() != 0)
        return false;
    const float step_m = range_m / static_cast<float>((1 << position_bits) - 1);
    const auto max_m =
        static_cast<float>(std::min<double>(max_coordinate_m, std::numeric_limits<float>::max()));
    for (const float coordinate_m : origin_m) {
        for (const std::int32_t end : {lowest_, highest_}) {
            // NaN fails this condition as well
            if (!(std::abs(static_cast<float>(end) * step_m + coordinate_m) <= max_m)) return false;
        }
    }
    const Position origin(origin_m[0], origin_m[1], origin_m[2], 0.0F);
    vertices.resize(positions_.size());
    for (std::size_t i = 0; i < vertices.size(); ++i)
        vertices[i] = (positions_[i] * step_m + origin).head<3>().cast<double>();
    return true;
}

bool EdgebreakerReader::read(std::span<const std::uint8_t> bytes,
                             const MeshLimits& limits,
                             geometry::TriangleMesh& out) {
    draco::DecoderBuffer in;
    in.Init(
        reinterpret_cast<const char*>(bytes.data()), bytes.size(), DRACO_BITSTREAM_VERSION(2, 2));
    if (!skip(in, kStart) || !read_topology(in, limits, out) || !read_residuals(in)) return false;
    const std::span<const std::uint32_t> corners(out.triangles.front().data(),
                                                 3 * out.triangles.size());
    return read_positions(in, corners) && read_vertices(in, limits.max_coordinate_m, out.vertices);
}

}  // namespace atrium::codec
