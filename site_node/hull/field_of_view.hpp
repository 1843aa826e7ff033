#pragma once

#include "site_node/hull/outlines.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// The two areas beside a segment, left | right. Left is where `orient_by_nesting` puts the
/// foreground.
enum class SegmentKind : std::uint8_t {
    kSilhouette,  // foreground | background, inside of the field
    kOutside,     // unknown, beyond the field | background
    kUnseen,      // foreground | unknown
};

/// The picture plane of one camera, divided into foreground, background and unknown.
///
/// All segments of a chain have the same kind. Chains meet only at their ends. Where a contour
/// leaves the field, one chain of each kind end in one point.
struct LabelledOutlines {
    static constexpr std::uint32_t kNoLoop = 0xffffffff;

    struct Segment {
        std::uint32_t from;  // from, to: indices into `points`
        std::uint32_t to;
        SegmentKind kind;
        std::uint32_t foreground_loop;  // kNoLoop if kOutside
        std::uint32_t background_loop;  // kNoLoop if kUnseen
    };
    std::vector<Eigen::Vector2d> points;  // [px], no duplicates
    std::vector<Segment> segments;        // within a chain each starts where the previous one ends
    /// One past the last segment of each chain. A chain is closed if its last segment ends where
    /// its first one starts.
    std::vector<std::uint32_t> chain_ends;
    /// The segments form loops around the cells, each from `to` of one segment to `from` of the
    /// next. Foreground loops consist of kSilhouette and kUnseen segments, background loops of
    /// kSilhouette and kOutside.
    std::uint32_t num_foreground_loops = 0;
    std::uint32_t num_background_loops = 0;

    void clear() {
        points.clear();
        segments.clear();
        chain_ends.clear();
        num_foreground_loops = 0;
        num_background_loops = 0;
    }
    std::size_t num_chains() const { return chain_ends.size(); }
    std::uint32_t begin_of(std::size_t chain) const {
        return chain == 0 ? 0 : chain_ends[chain - 1];
    }
};

struct FieldScratch {
    struct Crossing {                // of a contour with the field's border
        Eigen::Vector2d at;          // [px]
        std::uint32_t contour_edge;  // edges are named by their first points
        std::uint32_t field_edge;
        double along_contour;  // 0..1 along `contour_edge`
        double along_border;
        bool enters;            // the contour enters the field here
        std::uint32_t partner;  // other end of the arc inside the field
        std::uint32_t before;   // neighbours along the border, counter-clockwise
        std::uint32_t after;
        std::uint32_t point;            // index into the output points
        std::uint32_t foreground_loop;  // of the arc; set at its entering end
        std::uint32_t background_loop;
    };
    std::vector<Eigen::Vector2d> field;  // counter-clockwise from its lowest point
    std::vector<Crossing> crossings;     // contour by contour, in their direction
    std::vector<std::uint32_t> crossing_ends;
    std::vector<std::uint8_t> starts_inside;  // one per contour
    std::vector<std::uint32_t> around;        // crossings along the border
    std::vector<std::uint32_t> open;
};

/// Returns whether `field` [px] is a simple polygon of finite points that does not touch itself and
/// has an area above 1 px2.
bool is_usable_field(std::span<const Eigen::Vector2d> field);

/// Clips `outlines` at the border of `field` (after Weiler and Atherton 1977), and labels both
/// sides of all segments.
///
/// `outlines` are simple and oriented by `orient_by_nesting` [px]; `field` is a usable field [px]
/// of any orientation and start. Silhouette chains come first, in the order of the contours, then
/// the pieces of the border, counter-clockwise from its lowest point. Without `keep_unseen`, chains
/// of kind kUnseen are left out; the numbers of the loops do not change. Does not allocate once
/// `scratch` and `out` are large enough.
///
/// Returns false, with `out` empty, if contours and field contradict each other. This takes
/// contacts that no jitter has separated.
bool cut_by_field(const Outlines& outlines,
                  std::span<const Eigen::Vector2d> field,
                  bool keep_unseen,
                  FieldScratch& scratch,
                  LabelledOutlines& out);

/// Labels the outlines of a view without a field: each contour becomes one closed kSilhouette
/// chain, with its index as the number of its foreground and background loop.
void label_without_field(const Outlines& outlines, LabelledOutlines& out);

}  // namespace atrium::hull
