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
#include <vector>

namespace atrium::hull {

/// How all other cones cut one strip.
///
/// Chart of a strip: phi in [0, 1] from its first ray to its second, u = 1 / depth, so that other
/// strips cut it in straight lines. A line is cut into *pieces* by *events*: rays of its own camera
/// that pierce this strip, where it goes on as the line of the next segment of that silhouette.
///
/// Only what may matter is shown. Along a contour the ray only grazes the body: a face lies between
/// the nearest depth at which all cameras may see somebody and the farthest one, and most pieces
/// are in front of or behind all that.
class StripChart {
public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    static constexpr std::uint32_t kInfinityStrip = kNoStrip - 1;

    enum class Visibility : std::uint8_t { kVisible = 0, kAbove = 1, kBelow = 2 };
    struct Piece {
        double at_from = 0.0;  // u = at_from + phi * slope
        double slope = 0.0;
        double error = 0.0;  // of u at a given phi
        double min_u = 0.0;  // bounds over the piece; until it ends, u where it starts
        double max_u = 0.0;
        std::uint32_t strip = 0;
        std::uint32_t start_event = kNone;  // none: the strip's first ray
        std::uint32_t end_event = kNone;    // none: its second
        std::uint8_t view = 0;
        Visibility visibility = Visibility::kVisible;
    };
    struct Event {
        double phi = 0.0;
        double phi_error = 0.0;
        std::uint32_t ray = 0;
        std::array<std::uint32_t, 3> arriving{};  // pieces
        std::array<std::uint32_t, 3> leaving{};
        std::uint8_t view = 0;
        std::uint8_t num_arriving = 0;
        std::uint8_t num_leaving = 0;
        bool is_wholly_visible = true;
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
    bool may_have_faces() const { return lowest_ <= highest_; }
    /// Visible pieces on the strip's first ray, in no order.
    std::span<const std::uint32_t> visible_at_start() const { return visible_at_start_; }
    /// Visible events along the strip.
    std::span<const std::uint32_t> order() const { return order_; }
    const Piece& piece(std::uint32_t p) const { return pieces_[p]; }
    const Event& event(std::uint32_t e) const { return events_[e]; }
    /// Of an event that is not wholly visible: above all faces, or below.
    bool is_above_faces(const Event& event) const;
    /// At the camera, as far as visible pieces tell: pieces above the visible ones are crossed.
    const Verdict& verdict_above() const { return verdict_above_; }
    Verdict toggles(std::uint32_t piece) const {
        return pieces_[piece].strip == kInfinityStrip
                   ? infinity_toggles_
                   : cones_->strips[pieces_[piece].strip].toggles;
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
    bool is_above(std::uint32_t upper, std::uint32_t lower, const Place& at);
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
    struct Active {  // a line at the current ray
        std::uint32_t strip = 0;
        double u = 0.0;
        double error = 0.0;
        std::uint32_t piece = 0;
    };
    struct Value {
        double u = 0.0;
        double error = 0.0;
    };

    Value value_at(const PencilSide& other, std::uint32_t strip, std::uint32_t ray) const;
    void find_active(std::uint32_t ray);
    bool collect_from(std::uint32_t k);
    bool collect_events(const PencilSide& own, const PencilSide& other);
    bool add_event(const PencilSide& other, std::uint32_t ray, const Place& at, bool rising);
    std::vector<Active>::iterator find(std::vector<Active>& active, std::uint32_t strip);
    void begin_piece(const PencilSide& other, Active& active, const Place& at);
    void open_piece(const PencilSide& other, Active& active, const Place& at);
    void close_piece(std::uint32_t p, const Place& at);
    void hide_pieces();
    void judge_above();
    void sort_events();
    bool is_before(std::uint32_t l, std::uint32_t r);
    exact::Line exact_line(std::uint32_t piece) const;
    exact::Place exact_place(const Place& at) const;
    double exact_unit() const {  // of u, from the grid's units to 1 / m
        return cones_->views[view_].ray_unit / cones_->centre_unit_m;
    }

    bool carves(std::uint32_t strip) const {
        return all_carve_ || cones_->strips[strip].toggles.carved != 0;
    }
    bool is_certain(double difference, double error) const {
        return std::abs(difference) > error && !cones_->only_exact;
    }

    const Cones* cones_ = nullptr;
    const Pencils* pencils_ = nullptr;
    std::uint32_t strip_ = 0;
    std::uint32_t view_ = 0;
    Cones::Strip own_;
    std::uint32_t other_view_ = 0;  // the camera whose lines are being collected
    std::uint32_t other_first_strip_ = 0;
    bool all_carve_ = true;  // whoever crosses a line crosses a border of what is carved
    Verdict verdict_at_centre_;
    Verdict verdict_above_;
    Verdict infinity_toggles_;
    double highest_ = 0.0;  // faces are between these
    double lowest_ = 0.0;
    double phi_error_scale_ = 0.0;
    double nearest_ = 0.0;  // bounds of one camera's pieces at which it begins or ends to carve
    double farthest_ = 0.0;
    bool is_degenerate_ = false;
    std::uint64_t num_steps_ = 0;
    std::uint64_t max_steps_ = 0;
    std::vector<std::vector<Active>> active_;  // by view
    std::vector<Piece> pieces_;                // by view
    std::vector<Event> events_;                // by view, then along the strip
    std::vector<std::uint32_t> order_;
    std::vector<std::uint32_t> visible_at_start_;
    std::vector<std::uint8_t> num_visible_;  // pieces of each event
};

}  // namespace atrium::hull
