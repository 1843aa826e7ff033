#pragma once

#include "site_node/hull/outlines.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// What lies left and right of a segment; left as `orient_by_nesting` has the foreground left.
enum class SegmentKind : std::uint8_t {
    kSilhouette,  // foreground | background, inside of the field
    kOutside,     // unknown, beyond the field | background
    kUnseen,      // foreground | unknown
};

/// A camera's picture plane divided into foreground, background and unknown.
///
/// Chains have one kind each and meet only at their ends. Where a contour leaves the field, one
/// chain of each kind meet in one point.
struct LabelledOutlines {
    static constexpr std::uint32_t kNoLoop = 0xffffffff;

    struct Segment {
        std::uint32_t from;  // points
        std::uint32_t to;
        SegmentKind kind;
        std::uint32_t foreground_loop;  // kNoLoop for kOutside
        std::uint32_t background_loop;  // kNoLoop for kUnseen
    };
    std::vector<Eigen::Vector2d> points;  // [px], each once
    std::vector<Segment> segments;        // inside of a chain each starts where the last one ends
    /// One past the last segment of each chain; a chain is closed if that one ends where the first
    /// one starts.
    std::vector<std::uint32_t> chain_ends;
    /// Loops of segments bound the cells, from `to` to `from`: those of the foreground consist of
    /// kSilhouette and kUnseen, those of the background of kSilhouette and kOutside.
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
    struct Crossing {                // of a contour and the field's border
        Eigen::Vector2d at;          // [px]
        std::uint32_t contour_edge;  // named by their first points
        std::uint32_t field_edge;
        double along_contour;  // 0 .. 1 on its edge
        double along_border;
        bool enters;            // the field, as the contour runs
        std::uint32_t partner;  // other end of the arc inside of the field
        std::uint32_t before;   // along the border, counter-clockwise
        std::uint32_t after;
        std::uint32_t point;            // of the output
        std::uint32_t foreground_loop;  // of the arc; set where it enters
        std::uint32_t background_loop;
    };
    std::vector<Eigen::Vector2d> field;  // counter-clockwise, from its lowest point on
    std::vector<Crossing> crossings;     // contour by contour, as they run
    std::vector<std::uint32_t> crossing_ends;
    std::vector<std::uint8_t> starts_inside;  // of the contours
    std::vector<std::uint32_t> around;        // crossings along the border
    std::vector<std::uint32_t> open;
};

/// A simple polygon of finite points without contact with itself, of more than 1 px2.
bool is_usable_field(std::span<const Eigen::Vector2d> field);

/// Cuts `outlines`, simple and oriented by `orient_by_nesting`, off at the border of `field`, a
/// usable one of any orientation and start [px].
///
/// Silhouette chains come first, in the order of the contours; then the pieces of the border,
/// counter-clockwise from its lowest point. Without `keep_unseen` the chains of kind kUnseen are
/// left out, but the loops are numbered the same. False if contours and field contradict each
/// other, which takes contacts that no jitter separated; `out` is empty then. Does not allocate
/// once `scratch` and `out` are large enough.
bool cut_by_field(const Outlines& outlines,
                  std::span<const Eigen::Vector2d> field,
                  bool keep_unseen,
                  FieldScratch& scratch,
                  LabelledOutlines& out);

/// For a camera that sees everybody: each contour is one closed chain of kSilhouette and, under its
/// index, a loop of both families.
void label_without_field(const Outlines& outlines, LabelledOutlines& out);

}  // namespace atrium::hull
