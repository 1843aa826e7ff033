#pragma once

#include "core/codec/edgebreaker.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::codec {

/// What a stream says about the topology of its mesh.
struct CodedTopology {
    std::uint32_t num_vertices = 0;
    std::uint32_t num_triangles = 0;
    std::uint32_t num_symbols = 0;
    std::uint32_t num_splits = 0;               // symbols that are S
    std::span<const std::uint8_t> symbol_bits;  // one bit for C, three for the others
    std::span<const HandleEvent> handles;       // in the order of their symbols
};

/// Rebuilds the triangles of a closed surface from the symbols of edgebreaker, in their reverse
/// order: each triangle is glued onto the boundary of what is there, as in Isenburg, Snoeyink,
/// "Spirale Reversi: Reverse Decoding of the Edgebreaker Encoding", 2001. Vertices and triangles
/// get the numbers that Draco's decoder gives them.
///
/// A corner is 3 * triangle + its place in the triangle. It stands for the edge opposite to it
/// too, which goes from the next corner to the previous one.
class EdgebreakerTopology {
public:
    using Corner = std::uint32_t;

    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    static Corner next(Corner c) { return c + 1 - 3 * static_cast<Corner>(c % 3 == 2); }
    static Corner previous(Corner c) { return c - 1 + 3 * static_cast<Corner>(c % 3 == 0); }

    /// Fills `triangles`. False, with anything in them, unless the symbols are of a closed surface
    /// with the numbers that `coded` states, and each is needed and present. Takes time and memory
    /// in proportion to the bytes of the symbols.
    bool build(const CodedTopology& coded, std::vector<std::array<std::uint32_t, 3>>& triangles);

    /// Per corner: the one on the other side of its edge.
    std::span<const Corner> opposites() const { return opposite_; }

private:
    /// Where the next triangle is glued on: a boundary edge, from one vertex to another.
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

    std::span<std::uint32_t> corners_;   // their vertices
    std::vector<Corner> opposite_;       // kNone on the boundary
    std::vector<EdgeInto> into_;         // per vertex; without a corner once it was merged
    std::vector<Corner> waiting_;        // gates that the current one was put before
    std::vector<Corner> split_gates_;    // per symbol: the other gate of a handle
    std::size_t num_handles_ = 0;        // that are yet to come
    std::vector<std::uint32_t> merged_;  // vertices that became part of another
    std::uint32_t num_vertices_ = 0;     // with those
    std::uint32_t num_ends_ = 0;         // symbols that are E
};

}  // namespace atrium::codec
