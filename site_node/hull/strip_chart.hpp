#pragma once

#include "site_node/hull/cones.hpp"
#include "site_node/hull/exact_predicates.hpp"
#include "site_node/hull/pencils.hpp"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace atrium::hull {

/// The lines in which all other cones cut one strip, in the chart of the strip.
///
/// Chart: phi in [0, 1] from the strip's first ray to its second, u = 1 / depth [1/m]. In these
/// coordinates other strips cut it in straight lines. An *event* is a ray of another camera that
/// pierces the strip; there the line of one segment ends and the line of the next segment begins. A
/// *piece* is a line between two events.
///
/// Only pieces that can bound a face are built. A first pass over the ends of all pieces finds, for
/// each camera, the ranges of u in which it may see somebody, and intersects these ranges. All
/// faces lie between the limits of the result. A second pass builds the pieces that reach between
/// the limits.
///
/// Reuse one object; it allocates only while it grows. Not thread-safe.
class StripChart {
public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    static constexpr std::uint32_t kInfinityStrip = kNoStrip - 1;

    /// A visible piece: neither wholly above the limits nor wholly below them.
    struct Piece {
        double at_from = 0.0;  // u = at_from + phi * slope
        double slope = 0.0;
        double error = 0.0;  // bound of the error of u at a given phi
        std::uint32_t strip = 0;
        std::uint32_t start_event = kNone;  // kNone: the strip's first ray
        std::uint32_t end_event = kNone;    // kNone: its second ray
        std::uint8_t view = 0;
    };
    /// An event in which a visible piece ends or begins.
    struct Event {
        double phi = 0.0;
        double phi_error = 0.0;
        std::uint32_t ray = 0;
        std::array<std::uint32_t, 3> arriving{};  // visible pieces
        std::array<std::uint32_t, 3> leaving{};
        std::uint8_t view = 0;
        std::uint8_t num_arriving = 0;
        std::uint8_t num_leaving = 0;
        bool is_wholly_visible = true;
        bool is_above_faces = false;  // only if not wholly visible: above all faces (true) or below
    };
    /// An interval of u. Of the limits: all faces have low <= u <= high.
    struct Range {
        double low = 0.0;
        double high = 0.0;
    };
    /// A place at which lines are compared: an event, or one of the two rays of the strip.
    struct Place {
        double phi = 0.0;
        double phi_error = 0.0;
        std::uint32_t event = kNone;
    };
    static constexpr Place kStart{0.0, 0.0, kNone};
    static constexpr Place kEnd{1.0, 0.0, kNone};
    Place place(std::uint32_t event) const {
        return {events_[event].phi, events_[event].phi_error, event};
    }

    /// Starts at `strip` and finds all lines at its first ray. `max_steps` limits `num_steps`.
    /// `cones` and `pencils` must outlive the calls below.
    void start(const Cones& cones,
               const Pencils& pencils,
               std::uint32_t strip,
               std::uint64_t max_steps);
    /// Continues with `strip`, which begins on the ray where the last one ended.
    void go_on(std::uint32_t strip);

    /// Collects pieces and events of the strip. Returns false if the pencils contradict each other.
    /// If `num_steps` exceeds the limit, the collection is incomplete and must not be used.
    bool collect();

    /// Returns whether the strip may have faces. If false, no pieces and events are prepared.
    bool may_have_faces() const { return limits_.low <= limits_.high; }
    const Range& limits() const { return limits_; }
    /// Returns the visible pieces on the strip's first ray, in no order.
    std::span<const std::uint32_t> visible_at_start() const {
        return {visible_at_start_.data(), num_visible_at_start_};
    }
    /// Returns the visible events in their order along the strip.
    std::span<const std::uint32_t> order() const { return {order_.data(), num_events_}; }
    const Piece& piece(std::uint32_t p) const { return pieces_[p]; }
    const Event& event(std::uint32_t e) const { return events_[e]; }
    /// Returns the verdict above the uppermost visible piece: the one at the camera, with all
    /// hidden pieces above the limits crossed.
    const Verdict& verdict_above() const { return verdict_above_; }
    Verdict toggles(std::uint32_t piece) const {
        return pieces_[piece].strip == kInfinityStrip
                   ? infinity_toggles_
                   : cones_->toggles[pieces_[piece].strip].of(pieces_[piece].view);
    }

    double u(std::uint32_t piece, double phi) const {
        return pieces_[piece].at_from + phi * pieces_[piece].slope;
    }
    /// Returns a bound on the rounding error of u(l) - u(r).
    double error(std::uint32_t l, std::uint32_t r, const Place& at) const {
        const Piece& a = pieces_[l];
        const Piece& b = pieces_[r];
        return a.error + b.error + std::abs(a.slope - b.slope) * at.phi_error;
    }
    // Exact predicates: a filter with exact fallback. Equality means that the input is not in
    // general position, and sets `is_degenerate`.
    bool is_above(std::uint32_t upper, std::uint32_t lower, const Place& at) {
        const double difference = u(upper, at.phi) - u(lower, at.phi);
        if (is_certain(difference, error(upper, lower, at))) return difference > 0.0;
        return is_exactly_above(upper, lower, at);
    }
    bool is_steeper(std::uint32_t l, std::uint32_t r);
    bool crosses_before(std::uint32_t l1, std::uint32_t l2, std::uint32_t r1, std::uint32_t r2);
    bool is_degenerate() const { return is_degenerate_; }

    /// Chart coordinates, with a relative error of some 1e-10.
    struct Point {
        double phi = 0.0;
        double u = 0.0;
    };
    /// Returns the crossing of two pieces, with phi known to be in [min_phi, max_phi].
    Point crossing(std::uint32_t l, std::uint32_t r, double min_phi, double max_phi) const;
    /// Returns the point of `piece` at `at`.
    Point point(std::uint32_t piece, const Place& at) const;
    Eigen::Vector3d position(const Point& p) const;  // grid frame [m]

    /// Returns the number of pieces, events and comparisons so far, which `HullOptions::max_steps`
    /// limits. Above the limit `collect` gives up.
    std::uint64_t num_steps() const { return num_steps_; }

private:
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();

    struct Value {
        double u = 0.0;
        double error = 0.0;
    };
    /// Bounds of u, stored as (low, -high): one minimum extends both.
    using Bounds = Eigen::Array2d;
    static double low(const Bounds& bounds) { return bounds.x(); }
    static double high(const Bounds& bounds) { return -bounds.y(); }

    /// A place where pieces end: on the strip's first ray, in an event, or on its second ray.
    struct Node {
        Bounds bounds;
        double value = 0.0;  // on a ray: u; in an event: w_to, see `bound_events`
        double error = 0.0;  // on a ray: error of u; in an event: 1 / (w_from + w_to)
    };
    struct Active {     // a line at the current place
        Bounds bounds;  // of u along its chain, since the strip's first ray
        std::uint32_t strip = 0;
        std::uint32_t from = 0;  // node where its span began
    };
    struct Span {  // a piece that may be built
        std::uint32_t strip = 0;
        std::uint32_t from = 0;  // nodes
        std::uint32_t to = 0;
    };
    /// The lines of one camera. Its nodes are numbered in this order: those on the first ray; those
    /// in events, by position in the `PencilSide::sorted` of the camera; those on the second ray.
    struct Bundle {
        const PencilSide* own = nullptr;
        const PencilSide* other = nullptr;
        std::uint32_t view = 0;
        std::uint32_t first_ray = 0;  // of the camera
        std::uint32_t first_strip = 0;
        std::uint32_t num_rays = 0;
        std::vector<Active> active;
        std::vector<Node> nodes;  // only grows; those of the current strip begin at `first`
        std::vector<Span> spans;  // only grows
        std::uint32_t room_for_nodes = 0;  // sizes of `nodes` and `spans`
        std::uint32_t room_for_spans = 0;
        std::uint32_t first = 0;         // index in `nodes`
        std::uint32_t num_at_start = 0;  // nodes
        std::uint32_t num_events = 0;
        std::uint32_t num_spans = 0;
        std::uint32_t position = 0;  // least position of the events; positions may wrap around to 0
        bool is_rising = true;       // the strip meets its events by rising position
        bool has_only_chains = true;  // each line continues from the first ray to the second
        Bounds at_ray;                // bounds of the active lines on the current ray
        Bounds bounds;                // bounds of all nodes
        Node* strip_nodes() { return nodes.data() + first; }
        const Node* strip_nodes() const { return nodes.data() + first; }
        std::uint32_t first_end() const { return num_at_start + num_events; }
    };
    struct NodeUse {
        std::uint32_t event = 0;     // index in `events_`, if a visible piece ends or begins there
        std::uint32_t num_seen = 0;  // visible pieces
    };
    struct Entry {  // an event during sorting
        double phi = 0.0;
        double phi_error = 0.0;
        std::uint32_t event = 0;
        std::uint32_t view = 0;
    };

    /// Returns 1 / depth where the plane of a strip cuts a ray of this view.
    static Value value_of(const PencilSide::Offset& offset,
                          const Eigen::Vector3d& normal,
                          const Eigen::Vector3d& ray,
                          double ray_length) {
        const double u = -normal.dot(ray) * offset.inverse;
        const double error = offset.dot_error * ray_length + std::abs(u) * offset.error;
        return {u, error * offset.certain};
    }
    Value value_at(const Bundle& bundle, std::uint32_t strip, std::uint32_t ray) const {
        return value_of(bundle.other->offset[strip - bundle.first_strip],
                        cones_->normal[strip],
                        cones_->ray[ray],
                        cones_->ray_length[ray]);
    }
    static Node node_of(const Value& value) {
        return {Bounds(value.u - value.error, -value.u - value.error), value.u, value.error};
    }
    std::span<Bundle> bundles() { return {bundles_.data(), num_bundles_}; }
    void find_active(std::uint32_t ray);

    // strip_chart_gather.cpp: where the lines of all cameras end
    bool gather();
    void find_events();
    void start_lines();
    static void make_room(Bundle& bundle, std::uint32_t num_nodes, std::uint32_t num_spans);
    void sort_lines(Bundle& bundle);
    void bound_events();
    bool pass_events();
    bool pass_event(Bundle& bundle, std::uint32_t node, std::uint32_t position);
    void end_lines();

    // strip_chart_limits.cpp: where faces can be
    void find_limits();
    void find_ranges(const Bundle& bundle);
    bool find_ranges_between_chains(const Bundle& bundle, bool carves_near);
    Range carving_range(const Bundle& bundle) const;
    void restrict_faces();

    // strip_chart_build.cpp: pieces and events between the limits
    void build();
    bool pass_chains(const Bundle& bundle);
    bool find_visible(const Bundle& bundle);
    void build_events(const Bundle& bundle);
    void build_pieces(const Bundle& bundle);
    void build_infinity();
    void order_arriving(Event& event) const;
    void sort_events();
    template <typename Before>
    void merge_events(const Before& before);
    // Which of two events comes first along the strip.
    bool is_before(const Entry& l, const Entry& r) {
        if (l.view == r.view) return l.event < r.event;
        const double difference = r.phi - l.phi;
        if (is_certain(difference, l.phi_error + r.phi_error)) return difference > 0.0;
        return is_exactly_before(l, r);
    }
    bool is_exactly_before(const Entry& l, const Entry& r);
    bool is_exactly_above(std::uint32_t upper, std::uint32_t lower, const Place& at);
    exact::Line exact_line(std::uint32_t piece) const;
    exact::Place exact_place(const Place& at) const;
    double exact_unit() const {  // of u, from the grid's units to 1 / m
        return cones_->views[view_].ray_unit / cones_->centre_unit_m;
    }

    bool carves(std::uint32_t strip) const { return all_carve_ || cones_->toggles[strip].carves(); }
    bool is_certain(double difference, double error) const {
        return std::abs(difference) > error && !cones_->only_exact;
    }

    const Cones* cones_ = nullptr;
    const Pencils* pencils_ = nullptr;
    std::uint32_t strip_ = 0;
    std::uint32_t view_ = 0;
    Cones::Strip own_;
    bool all_carve_ = true;  // every line is a border of a carved area
    Verdict verdict_at_centre_;
    Verdict verdict_above_;
    Verdict infinity_toggles_;
    Range limits_;
    double phi_error_scale_ = 0.0;
    double spread_scale_ = 0.0;  // scale of the error of u in an event
    bool is_degenerate_ = false;
    std::uint64_t num_steps_ = 0;
    std::uint64_t max_steps_ = 0;
    std::vector<Bundle> bundles_;  // of the other views; only grows
    std::size_t num_bundles_ = 0;
    std::vector<std::pair<Node, std::uint32_t>> lines_;  // with their strips, during sorting
    std::vector<std::uint32_t> place_of_;  // by strip: its index in `active`, if active
    std::vector<Range> allowed_;           // ranges in which the current camera may see somebody
    std::vector<Range> faces_;             // ranges common to all cameras so far, by falling u
    std::vector<Range> less_faces_;        // buffer for the next `faces_`
    std::vector<std::uint32_t> seen_;      // visible spans of the current bundle
    std::uint32_t num_seen_ = 0;
    std::vector<NodeUse> uses_;  // of the nodes of the current bundle
    // these only grow, too
    std::vector<Piece> pieces_;  // by view
    std::vector<Event> events_;  // by view, then along the strip
    std::vector<Entry> entries_;
    std::vector<Entry> merged_;
    std::vector<std::uint32_t> list_ends_;  // end of each camera's events in `entries_`
    std::vector<std::uint32_t> order_;
    std::vector<std::uint32_t> visible_at_start_;
    std::uint32_t num_pieces_ = 0;
    std::uint32_t num_events_ = 0;
    std::uint32_t num_visible_at_start_ = 0;
};

}  // namespace atrium::hull
