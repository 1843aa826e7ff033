#pragma once

#include "core/codec/edgebreaker.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::codec {

/// The topology of a mesh as coded in a stream.
struct CodedTopology {
    std::uint32_t num_vertices = 0;
    std::uint32_t num_triangles = 0;
    std::uint32_t num_symbols = 0;
    std::uint32_t num_splits = 0;               // symbols that are S
    std::span<const std::uint8_t> symbol_bits;  // one bit for C, three for the others
    std::span<const HandleEvent> handles;       // in the order of their symbols
};

/// Rebuilds the triangles of a closed surface from edgebreaker symbols, in reverse order. It glues
/// each triangle to the boundary of the existing ones, as in Isenburg, Snoeyink, "Spirale Reversi:
/// Reverse Decoding of the Edgebreaker Encoding", 2001. Vertices and triangles get the same numbers
/// as from Draco's decoder.
///
/// A corner is 3 * triangle + its position in the triangle. It also denotes the edge opposite to
/// it, from the next corner to the previous one.
class EdgebreakerTopology {
public:
    using Corner = std::uint32_t;

    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    static Corner next(Corner c) { return c + 1 - 3 * static_cast<Corner>(c % 3 == 2); }
    static Corner previous(Corner c) { return c - 1 + 3 * static_cast<Corner>(c % 3 == 0); }

    /// Fills `triangles`. False, with undefined `triangles`, unless the symbols make a closed
    /// surface with exactly the counts in `coded`. Safe for untrusted input: time and memory are
    /// proportional to the number of symbol bytes.
    bool build(const CodedTopology& coded, std::vector<std::array<std::uint32_t, 3>>& triangles);

    /// Per corner: the corner opposite to the same edge in the neighbour triangle.
    std::span<const Corner> opposites() const { return opposite_; }

private:
    /// The boundary edge to which the next triangle is glued.
    struct Gate {
        Corner corner = kNone;
        std::uint32_t from = kNone;
        std::uint32_t to = kNone;
    };

    /// The boundary edge that ends at a vertex.
    struct EdgeInto {
        Corner corner = kNone;
        std::uint32_t from = kNone;
    };

    bool glue_triangles(const CodedTopology& coded);
    Gate glue_split(Corner first, const Gate& gate, Corner other_corner);
    bool note_handles(const CodedTopology& coded, Corner first);
    bool close_components(const CodedTopology& coded);
    void remove_merged_vertices();
    Gate gate_at(Corner corner) const {
        return {corner, corners_[next(corner)], corners_[previous(corner)]};
    }
    void glue(Corner a, Corner b) {
        opposite_[a] = b;
        opposite_[b] = a;
    }

    std::span<std::uint32_t> corners_;   // per corner: its vertex
    std::vector<Corner> opposite_;       // per corner; kNone on the boundary
    std::vector<EdgeInto> into_;         // per vertex; corner kNone after a merge
    std::vector<Corner> waiting_;        // stack of the gates below the current one
    std::vector<Corner> split_gates_;    // per symbol: the other gate of a handle
    std::size_t num_handles_ = 0;        // not yet reached
    std::vector<std::uint32_t> merged_;  // vertices merged into another
    std::uint32_t num_vertices_ = 0;     // including the merged ones
    std::uint32_t num_ends_ = 0;         // E symbols
};

}  // namespace atrium::codec
