#include "core/codec/edgebreaker_topology.hpp"

#include "core/codec/bit_window.hpp"

namespace atrium::codec {

// Glues a triangle between the gate and another one (of a handle, or the last waiting): two
// boundaries become one, or one becomes two. Merges the vertices where both gates meet; the other
// gate's vertex remains.
EdgebreakerTopology::Gate EdgebreakerTopology::glue_split(Corner first,
                                                          const Gate& gate,
                                                          Corner other_corner) {
    if (other_corner == kNone) {
        if (waiting_.empty()) return {};
        other_corner = waiting_.back();
        waiting_.pop_back();
    }
    if (opposite_[other_corner] != kNone) return {};
    const Gate other = gate_at(other_corner);
    const std::uint32_t kept = other.to;
    const std::uint32_t gone = gate.from;
    // not a closed surface: a triangle or an edge would have the same vertex twice
    if (kept == gone || kept == gate.to || other.from == gate.to || into_[gone].from == kept)
        return {};
    corners_[first] = kept;
    corners_[first + 1] = other.from;
    corners_[first + 2] = gate.to;
    opposite_[first] = kNone;
    glue(first + 1, gate.corner);
    glue(first + 2, other.corner);
    // renumber the corners around the vertex, from the gate to the incoming boundary edge
    Corner corner = next(gate.corner);
    corners_[corner] = kept;
    for (Corner behind = opposite_[next(corner)]; behind != kNone;) {
        corner = next(behind);
        corners_[corner] = kept;
        behind = opposite_[next(corner)];
    }
    into_[kept] = into_[gone];
    into_[gone] = {};
    merged_.push_back(gone);
    into_[gate.to] = {first, other.from};
    return {first, other.from, gate.to};
}

// Stores the gates of the new triangle's handles, whose split symbols follow later. False if a
// handle has no such triangle.
bool EdgebreakerTopology::note_handles(const CodedTopology& coded, Corner first) {
    const std::uint32_t number = coded.num_symbols - 1 - first / 3;
    for (; num_handles_ > 0; --num_handles_) {
        const HandleEvent& handle = coded.handles[num_handles_ - 1];
        if (handle.symbol != number) return handle.symbol < number;
        split_gates_[coded.num_symbols - 1 - handle.split_symbol] =
            handle.on_right ? first + 1 : first + 2;
    }
    return true;
}

bool EdgebreakerTopology::glue_triangles(const CodedTopology& coded) {
    constexpr std::size_t kBitsPerSymbol = 3;
    const BitWindow bits(coded.symbol_bits);
    const std::uint32_t max_vertices = coded.num_vertices + coded.num_splits;
    // local copies, for the compiler to keep in registers
    const std::span<std::uint32_t> corners = corners_;
    const std::span<Corner> opposite = opposite_;
    const std::span<EdgeInto> into = into_;
    const auto join = [&](Corner a, Corner b) {
        opposite[a] = b;
        opposite[b] = a;
    };
    Gate gate;
    std::uint32_t num_vertices = 0;
    std::size_t position = 0;  // of the window [bits]
    std::size_t num_taken = 0;
    std::uint64_t window = bits.at(position);
    // the first symbol has to create the first vertices
    if ((window & 7U) != static_cast<std::uint64_t>(Symbol::kE)) return false;
    for (Corner first = 0; first < 3 * coded.num_symbols; first += 3) {
        if (num_taken > BitWindow::kNumBits - kBitsPerSymbol) {
            position += num_taken;
            window = bits.at(position);
            num_taken = 0;
        }
        const std::uint64_t code = window & 7U;
        if ((code & 1U) == 0) {  // C: closes the gap between the gate and the edge before it
            window >>= 1U;
            num_taken += 1;
            const EdgeInto before = into[gate.from];
            if (before.from == gate.to) return false;
            corners[first] = gate.from;
            corners[first + 1] = before.from;
            corners[first + 2] = gate.to;
            opposite[first] = kNone;
            join(first + 1, gate.corner);
            join(first + 2, before.corner);
            into[gate.to] = {first, before.from};
            gate = {first, before.from, gate.to};
            continue;
        }
        window >>= kBitsPerSymbol;
        num_taken += kBitsPerSymbol;
        const auto kind = static_cast<Symbol>(code);
        if (kind == Symbol::kS) {
            gate = glue_split(first, gate, split_gates_.empty() ? kNone : split_gates_[first / 3]);
            if (gate.corner == kNone) return false;
            continue;
        }
        const std::uint32_t vertex = num_vertices;
        if (kind == Symbol::kE) {  // starts a separate boundary
            if (max_vertices - vertex < 3) return false;
            num_vertices += 3;
            ++num_ends_;
            if (first > 0) waiting_.push_back(gate.corner);
            for (std::uint32_t k = 0; k < 3; ++k) {
                corners[first + k] = vertex + k;
                opposite[first + k] = kNone;
            }
            into[vertex] = {first + 1, vertex + 2};
            into[vertex + 1] = {first + 2, vertex};
            into[vertex + 2] = {first, vertex + 1};
            gate = {first, vertex + 1, vertex + 2};
        } else {  // L or R: a new vertex in front of the gate
            if (vertex == max_vertices) return false;
            ++num_vertices;
            const bool is_right = kind == Symbol::kR;
            const Corner at_from = first + static_cast<Corner>(is_right);
            const Corner at_to = first + 2 - 2 * static_cast<Corner>(is_right);
            const Corner at_new = at_from + 1;
            corners[at_from] = gate.from;
            corners[at_to] = gate.to;
            corners[at_new] = vertex;
            opposite[at_from] = kNone;
            opposite[at_to] = kNone;
            join(at_new, gate.corner);
            into[vertex] = {at_to, gate.from};
            into[gate.to] = {at_from, vertex};
            gate = {first, is_right ? gate.from : vertex, is_right ? vertex : gate.to};
        }
        if (num_handles_ > 0 && !note_handles(coded, first)) return false;
    }
    num_vertices_ = num_vertices;
    waiting_.push_back(gate.corner);
    return num_handles_ == 0 && position + num_taken <= bits.num_bits();
}

// Adds the triangles without a symbol: each fills the last boundary of a component.
bool EdgebreakerTopology::close_components(const CodedTopology& coded) {
    if (num_vertices_ - merged_.size() != coded.num_vertices) return false;
    if (waiting_.size() != coded.num_triangles - coded.num_symbols) return false;
    // number of boundary edges: E adds three, L and R one; C and S remove one
    const std::uint64_t num_edges =
        2 * std::uint64_t{num_vertices_} - coded.num_symbols - 2 * std::uint64_t{num_ends_};
    if (num_edges != 3 * waiting_.size()) return false;
    for (Corner first = 3 * coded.num_symbols; !waiting_.empty(); first += 3) {
        const Gate gate = gate_at(waiting_.back());
        waiting_.pop_back();
        if (opposite_[gate.corner] != kNone) return false;
        const EdgeInto before = into_[gate.from];
        const EdgeInto after = into_[before.from];
        if (before.from == gate.to || after.from != gate.to) return false;
        corners_[first] = before.from;
        corners_[first + 1] = gate.to;
        corners_[first + 2] = gate.from;
        glue(first, gate.corner);
        glue(first + 1, before.corner);
        glue(first + 2, after.corner);
    }
    return true;
}

// Gives the free numbers of merged vertices to the last vertices, in Draco's order.
void EdgebreakerTopology::remove_merged_vertices() {
    for (const std::uint32_t free : merged_) {
        while (into_[num_vertices_ - 1].corner == kNone) --num_vertices_;
        const std::uint32_t last = num_vertices_ - 1;
        if (last < free) continue;
        const Corner begin = previous(into_[last].corner);
        Corner corner = begin;
        do {
            corners_[corner] = free;
            corner = next(opposite_[next(corner)]);
        } while (corner != begin);
        into_[free] = into_[last];
        into_[last] = {};
    }
}

bool EdgebreakerTopology::build(const CodedTopology& coded,
                                std::vector<std::array<std::uint32_t, 3>>& triangles) {
    constexpr std::uint32_t kMaxTriangles = kNone / 3;
    const std::uint64_t num_vertices = coded.num_vertices;
    const std::uint64_t num_triangles = coded.num_triangles;
    // A component has at least four triangles, one of them without a symbol. Each edge needs its
    // own pair of vertices. Each symbol takes at least one bit.
    if (num_triangles > kMaxTriangles || coded.num_symbols == 0 ||
        num_triangles <= coded.num_symbols ||
        num_triangles - coded.num_symbols > coded.num_symbols / 3 ||
        coded.num_symbols > 8 * coded.symbol_bits.size() || coded.num_splits > coded.num_symbols ||
        num_vertices == 0 || num_vertices > 3 * num_triangles ||
        num_vertices * (num_vertices - 1) / 2 < 3 * num_triangles / 2 ||
        coded.handles.size() > coded.num_symbols)
        return false;
    triangles.resize(num_triangles);
    corners_ = {triangles.front().data(), 3 * num_triangles};
    opposite_.resize(3 * num_triangles);
    into_.resize(coded.num_vertices + coded.num_splits);
    waiting_.clear();
    merged_.clear();
    num_vertices_ = 0;
    num_ends_ = 0;
    num_handles_ = coded.handles.size();
    split_gates_.clear();
    if (num_handles_ > 0) split_gates_.assign(coded.num_symbols, kNone);
    for (const HandleEvent& handle : coded.handles) {
        if (handle.symbol >= coded.num_symbols || handle.split_symbol > handle.symbol) return false;
    }
    if (!glue_triangles(coded) || !close_components(coded)) return false;
    remove_merged_vertices();
    return true;
}

}  // namespace atrium::codec
