#include "core/codec/edgebreaker.hpp"

namespace atrium::codec {

namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

}  // namespace

// Records a handle for the next symbol, if `neighbour` has symbol S.
void EdgebreakerOrder::note_handle(Gate neighbour, bool on_right) {
    const std::uint32_t split = split_of_[Surface::triangle(neighbour)];
    if (split == kNone) return;
    handles.push_back({static_cast<std::uint32_t>(symbols.size()), split, on_right});
}

bool EdgebreakerOrder::find(Surface& surface) {
    symbols.clear();
    gates.clear();
    starts.clear();
    handles.clear();
    num_splits = 0;
    const auto num_triangles = static_cast<std::uint32_t>(surface.mesh.num_triangles());
    split_of_.assign(num_triangles, kNone);
    const auto visit = [&](Gate gate, Symbol symbol) {
        if (symbol == Symbol::kR || symbol == Symbol::kE) note_handle(surface.right(gate), true);
        if (symbol == Symbol::kL || symbol == Symbol::kE) note_handle(surface.left(gate), false);
        if (symbol == Symbol::kS) {
            split_of_[Surface::triangle(gate)] = static_cast<std::uint32_t>(symbols.size());
            ++num_splits;
        }
        symbols.push_back(symbol);
        gates.push_back(gate);
    };
    for (std::uint32_t triangle = 0; triangle < num_triangles; ++triangle) {
        const Gate last = 3 * triangle + 2;
        if (surface.has_seen_triangle(last)) continue;
        surface.seen_triangles[triangle] = 1;
        for (Gate side = 3 * triangle; side <= last; ++side)
            surface.seen_vertices[surface.mesh.from(side)] = 1;
        starts.push_back(last);
        const std::size_t num_before = symbols.size();
        traverse(surface, surface.mesh.twin(last), visit);
        if (symbols.size() == num_before + 1) return false;
    }
    return true;
}

}  // namespace atrium::codec
