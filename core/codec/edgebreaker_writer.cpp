#include "core/codec/edgebreaker_writer.hpp"

#include <draco/attributes/geometry_attribute.h>
#include <draco/compression/bit_coders/rans_bit_encoder.h>
#include <draco/compression/config/compression_shared.h>
#include <draco/compression/entropy/rans_symbol_encoder.h>
#include <draco/compression/entropy/shannon_entropy.h>
#include <draco/compression/entropy/symbol_encoding.h>
#include <draco/core/encoder_buffer.h>
#include <draco/core/varint_encoding.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace atrium::codec {

namespace {

void write_header(draco::EncoderBuffer& out) {
    out.Encode("DRACO", 5);
    for (const std::uint8_t byte :
         {draco::kDracoMeshBitstreamVersionMajor, draco::kDracoMeshBitstreamVersionMinor})
        out.Encode(byte);
    out.Encode(static_cast<std::uint8_t>(draco::TRIANGULAR_MESH));
    out.Encode(static_cast<std::uint8_t>(draco::MESH_EDGEBREAKER_ENCODING));
    out.Encode(std::uint16_t{0});  // flags: no metadata
    out.Encode(static_cast<std::uint8_t>(draco::MESH_EDGEBREAKER_STANDARD_ENCODING));
}

/// Describes one attribute of three quantised floats that uses the connectivity of the mesh.
void write_attribute_header(draco::EncoderBuffer& out) {
    out.Encode(std::uint8_t{1});  // number of attribute decoders
    out.Encode(std::int8_t{-1});  // uses the connectivity of the mesh
    out.Encode(static_cast<std::uint8_t>(draco::MESH_VERTEX_ATTRIBUTE));
    out.Encode(static_cast<std::uint8_t>(draco::MESH_TRAVERSAL_DEPTH_FIRST));
    draco::EncodeVarint(std::uint32_t{1}, &out);  // number of attributes
    out.Encode(static_cast<std::uint8_t>(draco::GeometryAttribute::POSITION));
    out.Encode(static_cast<std::uint8_t>(draco::DT_FLOAT32));
    out.Encode(std::uint8_t{3});                  // components
    out.Encode(std::uint8_t{0});                  // not normalised
    draco::EncodeVarint(std::uint32_t{0}, &out);  // unique id
    out.Encode(static_cast<std::uint8_t>(draco::SEQUENTIAL_ATTRIBUTE_ENCODER_QUANTIZATION));
}

void write_handles(const std::vector<HandleEvent>& handles, draco::EncoderBuffer& out) {
    const auto num_handles = static_cast<std::uint32_t>(handles.size());
    draco::EncodeVarint(num_handles, &out);
    if (num_handles == 0) return;
    std::uint32_t last_symbol = 0;
    for (const HandleEvent& handle : handles) {
        draco::EncodeVarint(handle.symbol - last_symbol, &out);
        draco::EncodeVarint(handle.symbol - handle.split_symbol, &out);
        last_symbol = handle.symbol;
    }
    out.StartBitEncoding(num_handles, false);
    for (const HandleEvent& handle : handles)
        out.EncodeLeastSignificantBits32(1, handle.on_right ? 1 : 0);
    out.EndBitEncoding();
}

/// Writes bits, the lowest bit of each byte first.
class BitPacker {
public:
    explicit BitPacker(std::vector<std::uint8_t>& bytes) : bytes_(bytes) { bytes_.clear(); }

    void put(std::uint32_t value, int num_bits) {
        pending_ |= static_cast<std::uint64_t>(value) << num_pending_;
        num_pending_ += num_bits;
        for (; num_pending_ >= 8; num_pending_ -= 8) {
            bytes_.push_back(static_cast<std::uint8_t>(pending_));
            pending_ >>= 8U;
        }
    }

    void finish() {
        if (num_pending_ > 0) bytes_.push_back(static_cast<std::uint8_t>(pending_));
    }

private:
    std::vector<std::uint8_t>& bytes_;
    std::uint64_t pending_ = 0;
    int num_pending_ = 0;
};

constexpr std::size_t kMaxTagBits = 32;

// True if Draco would code three values with a common length tag, not each by itself. Compares
// Draco's estimates of both sizes.
bool has_draco_tag(const std::vector<std::uint32_t>& values,
                   const std::vector<std::uint32_t>& lengths,
                   std::uint32_t max_value) {
    constexpr int kMaxBitsWithoutTag = 18;
    if (max_value >> kMaxBitsWithoutTag != 0) return true;
    std::int64_t num_value_bits = 0;
    for (const std::uint32_t length : lengths) num_value_bits += 3 * std::int64_t{length};
    int num_lengths = 0;
    const std::int64_t num_tag_bits = draco::ComputeShannonEntropy(
        lengths.data(), static_cast<int>(lengths.size()), kMaxTagBits, &num_lengths);
    int num_different = 0;
    const std::int64_t num_bits = draco::ComputeShannonEntropy(values.data(),
                                                               static_cast<int>(values.size()),
                                                               static_cast<int>(max_value),
                                                               &num_different);
    return num_tag_bits + draco::ApproximateRAnsFrequencyTableBits(num_lengths, num_lengths) +
               num_value_bits <
           num_bits +
               draco::ApproximateRAnsFrequencyTableBits(static_cast<int>(max_value), num_different);
}

}  // namespace

bool EdgebreakerWriter::quantise(const geometry::TriangleMesh& mesh, int position_bits) {
    floats_.resize(mesh.vertices.size());
    Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::infinity());
    Eigen::Array3f high = -low;
    for (std::size_t i = 0; i < floats_.size(); ++i) {
        floats_[i] = mesh.vertices[i].cast<float>();
        low = low.min(floats_[i].array());
        high = high.max(floats_[i].array());
    }
    range_m_ = (high - low).maxCoeff();
    if (range_m_ == 0.0F) range_m_ = 1.0F;
    const float steps_per_m = static_cast<float>((1 << position_bits) - 1) / range_m_;
    if (!std::isfinite(range_m_) || !std::isfinite(steps_per_m)) return false;
    origin_m_ = {low.x(), low.y(), low.z()};
    positions_.resize(floats_.size());
    lowest_ = std::numeric_limits<std::int32_t>::max();
    highest_ = 0;
    for (std::size_t i = 0; i < floats_.size(); ++i) {
        // no value is negative: the cast rounds down
        const Eigen::Array3i steps =
            ((floats_[i].array() - low) * steps_per_m + 0.5F).cast<std::int32_t>();
        positions_[i] = {steps.x(), steps.y(), steps.z()};
        lowest_ = std::min(lowest_, steps.minCoeff());
        highest_ = std::max(highest_, steps.maxCoeff());
    }
    return true;
}

// Residuals wrap around the interval of all coordinates, which halves their range.
void EdgebreakerWriter::add_residual(const Position& position, const Position& prediction) {
    const std::int32_t num_values = highest_ - lowest_ + 1;
    const std::int32_t most = (num_values - 1) / 2;
    const std::int32_t least = -(num_values / 2);
    for (std::size_t i = 0; i < 3; ++i) {
        std::int32_t residual = position[i] - std::clamp(prediction[i], lowest_, highest_);
        if (residual < least) residual += num_values;
        if (residual > most) residual -= num_values;
        const auto bits = static_cast<std::uint32_t>(residual);
        residuals_.push_back(residual < 0 ? ~(bits << 1U) : bits << 1U);
    }
}

// The fourth point of the parallelogram with the triangle before the gate; the last position if
// that triangle's vertices were not all visited.
EdgebreakerWriter::Position EdgebreakerWriter::predict(Gate gate) const {
    const std::uint32_t a = surface_.mesh.from(gate);
    const std::uint32_t b = surface_.mesh.to(gate);
    const std::uint32_t behind = surface_.ahead(surface_.mesh.twin(gate));
    for (const std::uint32_t vertex : {a, b, behind}) {
        if (surface_.seen_vertices[vertex] == 0)
            return residuals_.empty() ? Position{} : positions_[last_vertex_];
    }
    Position prediction;
    for (std::size_t i = 0; i < 3; ++i)
        prediction[i] = positions_[a][i] + positions_[b][i] - positions_[behind][i];
    return prediction;
}

// The decoder rebuilds the triangles in reverse order, then traverses them again for the positions.
void EdgebreakerWriter::find_residuals() {
    residuals_.clear();
    surface_.clear_visited(positions_.size());
    const auto add_vertex_ahead = [&](Gate gate) {
        const std::uint32_t vertex = surface_.ahead(gate);
        add_residual(positions_[vertex], predict(gate));
        last_vertex_ = vertex;
    };
    const auto start = [&](Gate gate) {
        if (surface_.has_seen_triangle(gate)) return;
        for (const Gate side : {surface_.mesh.next(gate), surface_.mesh.previous(gate)}) {
            add_vertex_ahead(side);
            surface_.seen_vertices[surface_.ahead(side)] = 1;
        }
        traverse(surface_, gate, [&](Gate reached, Symbol symbol) {
            if (symbol == Symbol::kC) add_vertex_ahead(reached);
        });
    };
    std::for_each(order_.gates.rbegin(), order_.gates.rend(), start);
}

void EdgebreakerWriter::write_symbols(draco::EncoderBuffer& out) {
    BitPacker packer(bits_);
    for (auto symbol = order_.symbols.rbegin(); symbol != order_.symbols.rend(); ++symbol)
        packer.put(static_cast<std::uint32_t>(*symbol), *symbol == Symbol::kC ? 1 : 3);
    packer.finish();
    draco::EncodeVarint(static_cast<std::uint64_t>(bits_.size()), &out);
    out.Encode(bits_.data(), bits_.size());
    draco::RAnsBitEncoder starts;
    starts.StartEncoding();
    for (std::size_t i = 0; i < order_.starts.size(); ++i) starts.EncodeBit(true);  // closed
    starts.EndEncoding(&out);
}

void EdgebreakerWriter::write_connectivity(draco::EncoderBuffer& out) {
    draco::EncodeVarint(static_cast<std::uint32_t>(positions_.size()), &out);
    draco::EncodeVarint(static_cast<std::uint32_t>(surface_.mesh.num_triangles()), &out);
    out.Encode(std::uint8_t{0});  // number of attributes with separate connectivity
    draco::EncodeVarint(static_cast<std::uint32_t>(order_.symbols.size()), &out);
    draco::EncodeVarint(order_.num_splits, &out);
    write_handles(order_.handles, out);
    write_symbols(out);
}

// Writes the tags from the last to the first, then the values in order. Same bytes as
// draco::EncodeSymbols, which writes the values bit by bit.
bool EdgebreakerWriter::write_tagged_residuals(draco::EncoderBuffer& out) {
    out.Encode(static_cast<std::uint8_t>(draco::SYMBOL_CODING_TAGGED));
    std::array<std::uint64_t, kMaxTagBits> frequencies{};
    for (const std::uint32_t length : lengths_) ++frequencies[length];
    draco::RAnsSymbolEncoder<5> tags;
    if (!tags.Create(frequencies.data(), static_cast<int>(frequencies.size()), &out)) return false;
    tags.StartEncoding(&out);
    std::for_each(lengths_.rbegin(), lengths_.rend(), [&](std::uint32_t length) {
        tags.EncodeSymbol(length);
    });
    tags.EndEncoding(&out);
    BitPacker packer(bits_);
    for (std::size_t i = 0; i < residuals_.size(); ++i)
        packer.put(residuals_[i], static_cast<int>(lengths_[i / 3]));
    packer.finish();
    out.Encode(bits_.data(), bits_.size());
    return true;
}

bool EdgebreakerWriter::write_residuals(int speed, draco::EncoderBuffer& out) {
    lengths_.clear();
    std::uint32_t max_value = 0;
    for (std::size_t i = 0; i < residuals_.size(); i += 3) {
        const std::uint32_t largest =
            std::max(std::max(residuals_[i], residuals_[i + 1]), residuals_[i + 2]);
        max_value = std::max(max_value, largest);
        lengths_.push_back(static_cast<std::uint32_t>(std::bit_width(std::max(largest, 1U))));
    }
    if (max_value >> (kMaxTagBits - 1) == 0 && has_draco_tag(residuals_, lengths_, max_value))
        return write_tagged_residuals(out);
    draco::Options options;
    draco::SetSymbolEncodingCompressionLevel(&options, 10 - speed);
    return draco::EncodeSymbols(
        residuals_.data(), static_cast<int>(residuals_.size()), 3, &options, &out);
}

bool EdgebreakerWriter::write_positions(int position_bits, int speed, draco::EncoderBuffer& out) {
    out.Encode(static_cast<std::int8_t>(draco::MESH_PREDICTION_PARALLELOGRAM));
    out.Encode(static_cast<std::int8_t>(draco::PREDICTION_TRANSFORM_WRAP));
    out.Encode(std::uint8_t{1});  // residuals are coded
    if (!write_residuals(speed, out)) return false;
    out.Encode(lowest_);
    out.Encode(highest_);
    for (const float coordinate_m : origin_m_) out.Encode(coordinate_m);
    out.Encode(range_m_);
    out.Encode(static_cast<std::uint8_t>(position_bits));
    return true;
}

bool EdgebreakerWriter::write(const geometry::TriangleMesh& mesh,
                              int position_bits,
                              int speed,
                              draco::EncoderBuffer& out) {
    if (!surface_.mesh.assign(mesh) || !quantise(mesh, position_bits)) return false;
    surface_.clear_visited(positions_.size());
    if (!order_.find(surface_)) return false;
    find_residuals();
    const std::size_t size_before = out.size();
    write_header(out);
    write_connectivity(out);
    write_attribute_header(out);
    if (write_positions(position_bits, speed, out)) return true;
    out.Resize(static_cast<std::int64_t>(size_before));
    return false;
}

}  // namespace atrium::codec
