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

/// How all other cones cut one strip.
///
/// Chart of a strip: phi in [0, 1] from its first ray to its second, u = 1 / depth, so that other
/// strips cut it in straight lines. A line is cut into *pieces* by *events*: rays of its own camera
/// that pierce this strip, where it goes on as the line of the next segment of that silhouette.
///
/// Only pieces that can bound a face are built. A first pass over the ends of all pieces finds, for
/// each camera, the ranges of u in which it may see somebody. All faces lie between the limits of
/// what these ranges have in common. A second pass builds the pieces that reach between the limits.
class StripChart {
public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    static constexpr std::uint32_t kInfinityStrip = kNoStrip - 1;

    /// A visible piece: not all of it is above the limits, nor all of it below.
    struct Piece {
        double at_from = 0.0;  // u = at_from + phi * slope
        double slope = 0.0;
        double error = 0.0;  // of u at a given phi
        std::uint32_t strip = 0;
        std::uint32_t start_event = kNone;  // none: the strip's first ray
        std::uint32_t end_event = kNone;    // none: its second
        std::uint8_t view = 0;
    };
    /// An event with a visible piece.
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
        bool is_above_faces = false;  // if it is not wholly visible: above all faces, or below
    };
    /// All faces have low <= u <= high.
    struct Range {
        double low = 0.0;
        double high = 0.0;
    };
    /// A place at which lines are compared: an event, or one of the strip's two rays.
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

    /// Goes to a strip; all lines at its first ray are looked up.
    /// `max_steps`: see num_steps.
    void start(const Cones& cones,
               const Pencils& pencils,
               std::uint32_t strip,
               std::uint64_t max_steps);
    /// Goes to the strip that begins where the last one ended.
    void go_on(std::uint32_t strip);

    /// Collects pieces and events of the strip. False: the pencils contradict each other. What
    /// there is after more than the allowed steps means nothing.
    bool collect();

    /// False: no face can be on this strip; the rest is then not prepared.
    bool may_have_faces() const { return limits_.low <= limits_.high; }
    const Range& limits() const { return limits_; }
    /// Visible pieces on the strip's first ray, in no order.
    std::span<const std::uint32_t> visible_at_start() const {
        return {visible_at_start_.data(), num_visible_at_start_};
    }
    /// Visible events along the strip.
    std::span<const std::uint32_t> order() const { return {order_.data(), num_events_}; }
    const Piece& piece(std::uint32_t p) const { return pieces_[p]; }
    const Event& event(std::uint32_t e) const { return events_[e]; }
    /// At the camera, as far as visible pieces tell: pieces above the visible ones are crossed.
    const Verdict& verdict_above() const { return verdict_above_; }
    Verdict toggles(std::uint32_t piece) const {
        return pieces_[piece].strip == kInfinityStrip
                   ? infinity_toggles_
                   : cones_->toggles[pieces_[piece].strip].of(pieces_[piece].view);
    }

    double u(std::uint32_t piece, double phi) const {
        return pieces_[piece].at_from + phi * pieces_[piece].slope;
    }
    /// What rounding may have changed in u(l) - u(r).
    double error(std::uint32_t l, std::uint32_t r, const Place& at) const {
        const Piece& a = pieces_[l];
        const Piece& b = pieces_[r];
        return a.error + b.error + std::abs(a.slope - b.slope) * at.phi_error;
    }
    // Exact decisions. Equality is not in general position, and sets `is_degenerate`.
    bool is_above(std::uint32_t upper, std::uint32_t lower, const Place& at) {
        const double difference = u(upper, at.phi) - u(lower, at.phi);
        if (is_certain(difference, error(upper, lower, at))) return difference > 0.0;
        return is_exactly_above(upper, lower, at);
    }
    bool is_steeper(std::uint32_t l, std::uint32_t r);
    bool crosses_before(std::uint32_t l1, std::uint32_t l2, std::uint32_t r1, std::uint32_t r2);
    bool is_degenerate() const { return is_degenerate_; }

    /// Chart coordinates, good to some 1e-10 relative.
    struct Point {
        double phi = 0.0;
        double u = 0.0;
    };
    Point crossing(std::uint32_t l, std::uint32_t r, double min_phi, double max_phi) const;
    Point point(std::uint32_t piece, const Place& at) const;
    Eigen::Vector3d position(const Point& p) const;  // grid frame

    /// Pieces, events and comparisons so far: what `HullOptions::max_steps` bounds. Beyond them
    /// `collect` gives up.
    std::uint64_t num_steps() const { return num_steps_; }

private:
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();

    struct Value {
        double u = 0.0;
        double error = 0.0;
    };
    /// Bounds of u as (low, -high): a minimum of both extends them.
    using Bounds = Eigen::Array2d;
    static double low(const Bounds& bounds) { return bounds.x(); }
    static double high(const Bounds& bounds) { return -bounds.y(); }

    /// Where pieces end: on the strip's first ray, in an event, or on its second ray.
    struct Node {
        Bounds bounds;
        double value = 0.0;  // on a ray: u; in an event: w_to, see `bound_events`
        double error = 0.0;  // on a ray: of u; in an event: 1 / (w_from + w_to)
    };
    struct Active {     // a line at the current place
        Bounds bounds;  // since the strip's first ray, through all that went on as this line
        std::uint32_t strip = 0;
        std::uint32_t from = 0;  // node in which its span began
    };
    struct Span {  // of a piece that may be built
        std::uint32_t strip = 0;
        std::uint32_t from = 0;  // nodes
        std::uint32_t to = 0;
    };
    /// The lines of one camera. Its nodes are numbered by strip: those on the first ray, those in
    /// events by their positions in the camera's `PencilSide::sorted`, those on the second ray.
    struct Bundle {
        const PencilSide* own = nullptr;
        const PencilSide* other = nullptr;
        std::uint32_t view = 0;
        std::uint32_t first_ray = 0;  // of the camera
        std::uint32_t first_strip = 0;
        std::uint32_t num_rays = 0;
        std::vector<Active> active;
        std::vector<Node> nodes;           // only grows; the strip's begin at `first`
        std::vector<Span> spans;           // only grows
        std::uint32_t room_for_nodes = 0;  // sizes of both
        std::uint32_t room_for_spans = 0;
        std::uint32_t first = 0;         // in `nodes`
        std::uint32_t num_at_start = 0;  // nodes
        std::uint32_t num_events = 0;
        std::uint32_t num_spans = 0;
        std::uint32_t position = 0;   // the least of the events'; they may go on at 0
        bool is_rising = true;        // the strip meets its events by rising position
        bool has_only_chains = true;  // each line goes on from the first ray to the second
        Bounds at_ray;                // of the active lines, on the current ray
        Bounds bounds;                // of all nodes
        Node* strip_nodes() { return nodes.data() + first; }
        const Node* strip_nodes() const { return nodes.data() + first; }
        std::uint32_t first_end() const { return num_at_start + num_events; }
    };
    struct NodeUse {
        std::uint32_t event = 0;     // if a visible piece ends or begins there
        std::uint32_t num_seen = 0;  // visible pieces
    };
    struct Entry {  // an event that is being sorted
        double phi = 0.0;
        double phi_error = 0.0;
        std::uint32_t event = 0;
        std::uint32_t view = 0;
    };

    /// Where the plane of a strip cuts a ray of this view: 1 / depth.
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
    bool all_carve_ = true;  // whoever crosses a line crosses a border of what is carved
    Verdict verdict_at_centre_;
    Verdict verdict_above_;
    Verdict infinity_toggles_;
    Range limits_;
    double phi_error_scale_ = 0.0;
    double spread_scale_ = 0.0;  // of the error of u in an event
    bool is_degenerate_ = false;
    std::uint64_t num_steps_ = 0;
    std::uint64_t max_steps_ = 0;
    std::vector<Bundle> bundles_;  // of the other views; the vector only grows
    std::size_t num_bundles_ = 0;
    std::vector<std::pair<Node, std::uint32_t>> lines_;  // with their strips, while they are sorted
    std::vector<std::uint32_t> place_of_;  // by strip: its place in `active`, if it is there
    std::vector<Range> allowed_;           // where the current camera may see somebody
    std::vector<Range> faces_;             // where all cameras so far may: by falling u
    std::vector<Range> less_faces_;        // the next `faces_`
    std::vector<std::uint32_t> seen_;      // visible spans of the current bundle
    std::uint32_t num_seen_ = 0;
    std::vector<NodeUse> uses_;  // of its nodes
    // these only grow, too
    std::vector<Piece> pieces_;  // by view
    std::vector<Event> events_;  // by view, then along the strip
    std::vector<Entry> entries_;
    std::vector<Entry> merged_;
    std::vector<std::uint32_t> list_ends_;  // in `entries_`, of each camera
    std::vector<std::uint32_t> order_;
    std::vector<std::uint32_t> visible_at_start_;
    std::uint32_t num_pieces_ = 0;
    std::uint32_t num_events_ = 0;
    std::uint32_t num_visible_at_start_ = 0;
};

}  // namespace atrium::hull
