#include "site_node/hull/face_triangulator.hpp"

#include <cmath>

namespace atrium::hull {
namespace {

// > 0 if a -> b -> c turns left in the chart
double turn(const FaceTriangulator::Corner& a,
            const FaceTriangulator::Corner& b,
            const FaceTriangulator::Corner& c) {
    if (std::isinf(a.u)) return c.phi - b.phi;  // a is at infinity, straight above b
    return (b.phi - a.phi) * (c.u - b.u) - (b.u - a.u) * (c.phi - b.phi);
}

}  // namespace

void FaceTriangulator::reset(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    nodes_.clear();
    regions_.clear();
    triangles_ = &triangles;
}

std::int32_t FaceTriangulator::push(const Corner& v, std::int32_t older) {
    nodes_.push_back({v, older});
    return static_cast<std::int32_t>(nodes_.size()) - 1;
}

void FaceTriangulator::emit(Side side, std::uint32_t older, std::uint32_t newer, std::uint32_t v) {
    if (side == Side::kTop) {
        triangles_->push_back({older, newer, v});
    } else {
        triangles_->push_back({newer, older, v});
    }
}

void FaceTriangulator::fan(const Chain& chain, const Corner& v) {
    for (std::int32_t n = chain.head; nodes_[static_cast<std::size_t>(n)].older >= 0;) {
        const Node& newer = nodes_[static_cast<std::size_t>(n)];
        const Node& older = nodes_[static_cast<std::size_t>(newer.older)];
        emit(chain.side, older.corner.vertex, newer.corner.vertex, v.vertex);
        n = newer.older;
    }
}

void FaceTriangulator::extend(Chain& chain, const Corner& v, Side side) {
    if (nodes_[static_cast<std::size_t>(chain.head)].older < 0) {
        chain = {push(v, chain.head), side};
        return;
    }
    if (side != chain.side) {
        fan(chain, v);
        // the newest vertex stays open: its diagonal to v bounds the rest
        const std::int32_t kept = push(nodes_[static_cast<std::size_t>(chain.head)].corner, -1);
        chain = {push(v, kept), side};
        return;
    }
    for (;;) {
        const Node& newer = nodes_[static_cast<std::size_t>(chain.head)];
        if (newer.older < 0) break;
        const Node& older = nodes_[static_cast<std::size_t>(newer.older)];
        const double left = turn(older.corner, newer.corner, v);
        if (!(side == Side::kTop ? left < 0.0 : left > 0.0)) break;
        emit(side, older.corner.vertex, newer.corner.vertex, v.vertex);
        chain.head = newer.older;
    }
    chain.head = push(v, chain.head);
}

FaceTriangulator::RegionId FaceTriangulator::open(const Corner& v) {
    regions_.push_back({{push(v, -1), Side::kTop}, {}, false});
    return static_cast<RegionId>(regions_.size()) - 1;
}

FaceTriangulator::RegionId FaceTriangulator::open(const Corner& top, const Corner& bottom) {
    regions_.push_back({{push(bottom, push(top, -1)), Side::kBottom}, {}, false});
    return static_cast<RegionId>(regions_.size()) - 1;
}

void FaceTriangulator::add(RegionId id, const Corner& v, Side side) {
    Region& region = regions_[static_cast<std::size_t>(id)];
    if (region.has_lower) {
        // the diagonal from the merge vertex to v completes the part on v's side
        region.has_lower = false;
        if (side == Side::kTop) {
            fan(region.chain, v);
            region.chain = region.lower;
        } else {
            fan(region.lower, v);
        }
    }
    extend(region.chain, v, side);
}

FaceTriangulator::RegionId FaceTriangulator::split(RegionId id, const Corner& v) {
    Region& region = regions_[static_cast<std::size_t>(id)];
    Chain lower;
    if (region.has_lower) {
        lower = region.lower;
        extend(lower, v, Side::kTop);
        extend(region.chain, v, Side::kBottom);
        region.has_lower = false;
    } else {
        // the newest vertex is the rightmost one, so no boundary lies between it and v
        const Chain old = region.chain;
        const Corner newest = nodes_[static_cast<std::size_t>(old.head)].corner;
        if (old.side == Side::kTop) {
            region.chain = {push(v, push(newest, -1)), Side::kBottom};
            lower = old;
            extend(lower, v, Side::kTop);
        } else {
            lower = {push(v, push(newest, -1)), Side::kTop};
            extend(region.chain, v, Side::kBottom);
        }
    }
    regions_.push_back({lower, {}, false});
    return static_cast<RegionId>(regions_.size()) - 1;
}

void FaceTriangulator::merge(RegionId upper, RegionId lower, const Corner& v) {
    add(upper, v, Side::kBottom);
    add(lower, v, Side::kTop);
    Region& both = regions_[static_cast<std::size_t>(upper)];
    both.lower = regions_[static_cast<std::size_t>(lower)].chain;
    both.has_lower = true;
}

void FaceTriangulator::close(RegionId id, const Corner& v) {
    const Region& region = regions_[static_cast<std::size_t>(id)];
    fan(region.chain, v);
    if (region.has_lower) fan(region.lower, v);
}

}  // namespace atrium::hull
