#pragma once

#include "core/geometry/closed_mesh.hpp"

#include <cstdint>
#include <vector>

namespace atrium::codec {

/// The edge through which a triangle is entered, as an edge of that triangle.
using Gate = geometry::ClosedMesh::Edge;

/// How a triangle that is entered lies to what was visited before: its vertex ahead is new (C), or
/// else the triangle on its left (L), on its right (R), on both sides (E, end) or on none (S,
/// split) was visited. The values are Draco's patterns of bits: one bit for C, three for the
/// others.
enum class Symbol : std::uint8_t { kC = 0, kS = 1, kL = 3, kR = 5, kE = 7 };

/// A closed mesh while its triangles are visited one after the other.
struct Surface {
    geometry::ClosedMesh mesh;
    std::vector<std::uint8_t> seen_vertices;
    std::vector<std::uint8_t> seen_triangles;
    std::vector<Gate> stack;

    static std::uint32_t triangle(Gate gate) { return geometry::ClosedMesh::triangle_of(gate); }
    bool has_seen_triangle(Gate gate) const { return seen_triangles[triangle(gate)] != 0; }
    /// The vertex opposite to the gate.
    std::uint32_t ahead(Gate gate) const { return mesh.from(mesh.previous(gate)); }
    /// The gates into the two triangles behind a triangle, seen from outside on the way in.
    Gate right(Gate gate) const { return mesh.twin(mesh.next(gate)); }
    Gate left(Gate gate) const { return mesh.twin(mesh.previous(gate)); }

    void forget(std::size_t num_vertices) {
        seen_vertices.assign(num_vertices, 0);
        seen_triangles.assign(mesh.num_triangles(), 0);
    }
};

/// Enters the triangle of `gate` and all that can be reached from there, those on the right first.
/// Calls `visit(gate, symbol)` for each after it was marked.
template <typename Visit>
void traverse(Surface& surface, Gate gate, Visit&& visit) {
    surface.stack.assign(1, gate);
    while (!surface.stack.empty()) {
        gate = surface.stack.back();
        if (surface.has_seen_triangle(gate)) {
            surface.stack.pop_back();
            continue;
        }
        for (bool goes_on = true; goes_on;) {
            surface.seen_triangles[Surface::triangle(gate)] = 1;
            const Gate right = surface.right(gate);
            std::uint8_t& seen_ahead = surface.seen_vertices[surface.ahead(gate)];
            if (seen_ahead == 0) {
                seen_ahead = 1;
                visit(gate, Symbol::kC);
                gate = right;
                continue;
            }
            const Gate left = surface.left(gate);
            const bool seen_right = surface.has_seen_triangle(right);
            goes_on = seen_right != surface.has_seen_triangle(left);
            if (goes_on) {
                visit(gate, seen_right ? Symbol::kR : Symbol::kL);
                gate = seen_right ? left : right;
            } else if (seen_right) {
                visit(gate, Symbol::kE);
                surface.stack.pop_back();
            } else {
                visit(gate, Symbol::kS);
                surface.stack.back() = left;
                surface.stack.push_back(right);
            }
        }
    }
}

/// A triangle that met one with symbol S from the other side: the surface has a handle there.
struct HandleEvent {
    std::uint32_t symbol = 0;        // number of the symbol of the triangle that noticed
    std::uint32_t split_symbol = 0;  // number of that S, which is smaller
    bool on_right = false;
};

/// The triangles of a mesh in the order of edgebreaker: Rossignac, "Edgebreaker: Connectivity
/// Compression for Triangle Meshes", 1999; for handles as Draco's streams have it, where each is
/// noted on both of its sides.
struct EdgebreakerOrder {
    std::vector<Symbol> symbols;
    std::vector<Gate> gates;   // one per symbol
    std::vector<Gate> starts;  // one per component, whose first triangle has no symbol
    std::vector<HandleEvent> handles;
    std::uint32_t num_splits = 0;

    /// Of a surface of which nothing has been seen. False if two triangles have the same vertices,
    /// one for each of their sides: Draco takes them for two with boundaries.
    bool find(Surface& surface);

private:
    void note_handle(Gate neighbour, bool on_right);

    std::vector<std::uint32_t> split_of_;  // by triangle: number of its symbol, if that is S
};

}  // namespace atrium::codec
