#pragma once

#include "core/geometry/closed_mesh.hpp"

#include <cstdint>
#include <vector>

namespace atrium::codec {

/// The edge through which the traversal enters a triangle, as an edge of that triangle.
using Gate = geometry::ClosedMesh::Edge;

/// Relation of an entered triangle to the visited ones: its vertex ahead is new (C), or the
/// triangle on its left (L), on its right (R), on both sides (E, end) or on neither (S, split) was
/// visited. The values are Draco's bit patterns: one bit for C, three for the others.
enum class Symbol : std::uint8_t { kC = 0, kS = 1, kL = 3, kR = 5, kE = 7 };

/// A closed mesh and the vertices and triangles that a traversal has visited.
struct Surface {
    geometry::ClosedMesh mesh;
    std::vector<std::uint8_t> seen_vertices;
    std::vector<std::uint8_t> seen_triangles;
    std::vector<Gate> stack;

    static std::uint32_t triangle(Gate gate) { return geometry::ClosedMesh::triangle_of(gate); }
    bool has_seen_triangle(Gate gate) const { return seen_triangles[triangle(gate)] != 0; }
    /// The vertex opposite to the gate.
    std::uint32_t ahead(Gate gate) const { return mesh.from(mesh.previous(gate)); }
    /// Gates into the two neighbours behind the entered triangle; right and left as seen from
    /// outside in the direction of entry.
    Gate right(Gate gate) const { return mesh.twin(mesh.next(gate)); }
    Gate left(Gate gate) const { return mesh.twin(mesh.previous(gate)); }

    void clear_visited(std::size_t num_vertices) {
        seen_vertices.assign(num_vertices, 0);
        seen_triangles.assign(mesh.num_triangles(), 0);
    }
};

/// Visits the triangle of `gate` and all triangles reachable from it, right neighbours first. Calls
/// `visit(gate, symbol)` for each triangle after it is marked.
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

/// Records that a triangle has met one with symbol S from the other side: the surface has a handle
/// there.
struct HandleEvent {
    std::uint32_t symbol = 0;        // symbol number of the meeting triangle
    std::uint32_t split_symbol = 0;  // symbol number of the S; smaller
    bool on_right = false;
};

/// Orders the triangles of a mesh as edgebreaker does: Rossignac, "Edgebreaker: Connectivity
/// Compression for Triangle Meshes", 1999. Handles are recorded as in Draco's streams, on both of
/// their sides.
struct EdgebreakerOrder {
    std::vector<Symbol> symbols;
    std::vector<Gate> gates;   // one per symbol
    std::vector<Gate> starts;  // one per component, whose first triangle has no symbol
    std::vector<HandleEvent> handles;
    std::uint32_t num_splits = 0;

    /// Finds the order of a surface without visited parts. False if a component is two triangles
    /// back to back: Draco reads them as two triangles with boundaries.
    bool find(Surface& surface);

private:
    void note_handle(Gate neighbour, bool on_right);

    std::vector<std::uint32_t> split_of_;  // per triangle: its symbol number, if the symbol is S
};

}  // namespace atrium::codec
