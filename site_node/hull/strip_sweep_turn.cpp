#include "site_node/hull/strip_sweep.hpp"

#include <algorithm>

namespace atrium::hull {

// Sets the verdicts below the leaving lines. False if they contradict those below the arriving
// lines.
bool StripSweep::judge_leaving(std::size_t first, std::size_t num_arriving) {
    Verdict verdict = lines_[first - 1].below;
    for (Line& line : leaving_) {
        verdict ^= chart_.toggles(line.piece);
        set_below(line, verdict);
    }
    return verdict == lines_[first + num_arriving - 1].below;
}

bool StripSweep::has_face_around(std::size_t first, std::size_t num_arriving) const {
    bool has_face = lines_[first - 1].face_below;
    for (std::size_t j = 0; j < num_arriving; ++j) has_face |= lines_[first + j].face_below;
    for (const Line& line : leaving_) has_face |= line.face_below;
    return has_face;
}

// Collects the lines and sectors around the point.
void StripSweep::gather(std::size_t first, std::size_t num_arriving, Turn& turn) {
    turn.num_arriving = num_arriving;
    turn.num_lines = num_arriving + leaving_.size();
    const Line& above = lines_[first - 1];
    const Line& lowest = lines_[first + num_arriving - 1];
    turn.is_face[0] = above.face_below;
    turn.region[0] = above.region_below;
    turn.region_below = lowest.region_below;
    for (std::size_t j = 0; j < num_arriving; ++j) {
        turn.lines[j] = &lines_[first + j];
        const std::size_t sector = turn.after(j);
        if (sector == 0) continue;
        turn.is_face[sector] = lines_[first + j].face_below;
        turn.region[sector] = lines_[first + j].region_below;
    }
    for (std::size_t j = 0; j < leaving_.size(); ++j) {
        const std::size_t at = turn.num_lines - 1 - j;
        turn.lines[at] = &leaving_[j];
        if (at > num_arriving) turn.is_face[at] = leaving_[j].face_below;
    }
}

// Returns whether the boundary of `face` passes the point along one line. The face then has no
// vertex there and continues: the lines that cross its boundary do not affect the hull.
bool StripSweep::goes_straight(Turn& turn, const Sectors& face) {
    const std::size_t into = turn.before(face.begin);
    const std::size_t end = face.end;
    if (turn.lines[into]->strip != turn.lines[end]->strip) return false;
    if ((into < turn.num_arriving) == (end < turn.num_arriving)) return false;
    const bool begins_left = into < turn.num_arriving;
    Line& arriving = *turn.lines[begins_left ? into : end];
    Line& leaving = *turn.lines[begins_left ? end : into];
    leaving.edge_start = arriving.edge_start;
    // the face lies above the line or below it
    const RegionId region = begins_left ? turn.region_below : turn.region[0];
    for (std::size_t j = face.begin;; j = turn.after(j)) {
        turn.region[j] = region;
        if (j == end) break;
    }
    return true;
}

void StripSweep::end_edges(const Turn& turn, const Sectors& face, std::uint32_t vertex) {
    const std::size_t into = turn.before(face.begin);
    const std::size_t end = face.end;
    if (into < turn.num_arriving) {
        end_edge(*turn.lines[into], vertex, Side::kTop);
    } else {
        turn.lines[into]->edge_start = vertex;
    }
    if (end < turn.num_arriving) {
        end_edge(*turn.lines[end], vertex, Side::kBottom);
    } else {
        turn.lines[end]->edge_start = vertex;
    }
}

// Adds the corner to a face that does not include both the sector above and the sector below the
// point.
void StripSweep::pass_face(Turn& turn, const Sectors& face, const Corner& corner) {
    RegionId region = -1;
    if (face.is_above) {
        region = turn.region[0];
        triangulator_.add(region, corner, Side::kBottom);
    } else if (face.is_below) {
        region = turn.region_below;
        triangulator_.add(region, corner, Side::kTop);
    } else if (face.begin < turn.num_arriving) {
        triangulator_.close(turn.region[face.begin], corner);
    } else {
        region = triangulator_.open(corner);
    }
    for (std::size_t j = face.begin;; j = turn.after(j)) {
        turn.region[j] = region;
        if (j == face.end) break;
    }
}

// Adds the corner to a face that includes the sectors above and below the point: a gap inside the
// face begins or ends there.
void StripSweep::part_face(Turn& turn, const Corner& corner) {
    const std::size_t first_leaving = turn.num_arriving + 1;  // sector
    bool begins = turn.num_arriving < turn.num_lines;
    for (std::size_t j = 1; j < turn.num_arriving; ++j) begins &= turn.is_face[j];
    if (!begins) {
        triangulator_.merge(turn.region[0], turn.region_below, corner);
        turn.region_below = turn.region[0];
        for (std::size_t j = first_leaving; j < turn.num_lines; ++j)
            turn.region[j] = turn.region[0];
        return;
    }
    turn.region_below = triangulator_.split(turn.region[0], corner);
    for (std::size_t j = turn.num_lines - 1; j >= first_leaving && turn.is_face[j]; --j)
        turn.region[j] = turn.region[0];
    for (std::size_t j = first_leaving; j < turn.num_lines && turn.is_face[j]; ++j)
        turn.region[j] = turn.region_below;
}

void StripSweep::exchange_lines(std::size_t first, std::size_t num_arriving) {
    const std::size_t num_leaving = leaving_.size();
    const auto begin = lines_.begin() + static_cast<std::ptrdiff_t>(first);
    // lines that leave one point have met already
    for (Line& line : leaving_) line.meets_at = std::numeric_limits<double>::infinity();
    const std::size_t num_common = std::min(num_arriving, num_leaving);
    const auto rest = std::copy_n(leaving_.begin(), num_common, begin);
    if (num_arriving > num_common) {
        lines_.erase(rest, begin + static_cast<std::ptrdiff_t>(num_arriving));
    } else if (num_leaving > num_common) {
        lines_.insert(rest, leaving_.begin() + num_common, leaving_.end());
    }
    find_meeting(first - 1);
    if (num_leaving > 0) find_meeting(first + num_leaving - 1);
}

void StripSweep::hand_over_regions(std::size_t first, const Turn& turn) {
    const std::size_t num_leaving = leaving_.size();
    for (std::size_t j = 0; j < num_leaving; ++j) {
        leaving_[j].region_below =
            j + 1 == num_leaving ? turn.region_below : turn.region[turn.num_lines - 1 - j];
    }
    exchange_lines(first, turn.num_arriving);
    // a face may extend over lines that do not bound it
    for (std::size_t p = first + num_leaving;
         p < lines_.size() && lines_[p].face_below && lines_[p - 1].face_below;
         ++p) {
        lines_[p].region_below = lines_[p - 1].region_below;
    }
}

// The usual turn: line p becomes a line that begins in `corner`, with a face on one side.
void StripSweep::bend(std::size_t p, const Corner& corner) {
    Line& line = lines_[p];
    const std::uint32_t vertex = corner_vertices_[corner.vertex];
    const bool is_above = lines_[p - 1].face_below;
    const Side side = is_above ? Side::kBottom : Side::kTop;
    triangulator_.add(is_above ? lines_[p - 1].region_below : line.region_below, corner, side);
    end_edge(line, vertex, side);
    line.edge_start = vertex;
}

// Passes an event with one line before it and one after it.
void StripSweep::go_on(std::size_t p, std::uint32_t piece, std::uint32_t e) {
    Line& line = lines_[p];
    const Line& above = lines_[p - 1];
    const StripChart::Piece& next = chart_.piece(piece);
    if ((above.below ^ chart_.toggles(piece)) != line.below) {
        faces_->failed = true;
        return;
    }
    if (above.face_below || line.face_below) {
        if (above.face_below == line.face_below || line.strip == next.strip) {
            leaving_.clear();
            leaving_.insert(0, make_line(piece));
            turn_at_event(p, 1, e);
            return;
        }
        const Corner corner = event_corner(e);
        if (must_stop()) return;
        bend(p, corner);
    }
    line.piece = piece;
    line.strip = next.strip;
    line.end_event = next.end_event;
    find_meeting(p - 1);
    find_meeting(p);
}

// Replaces `num_arriving` lines from `first` on by `leaving_`; all of them meet in one point. Calls
// `make_vertex()` at most once; it returns the corner of the point.
template <typename MakeVertex>
void StripSweep::turn(std::size_t first, std::size_t num_arriving, const MakeVertex& make_vertex) {
    if (!judge_leaving(first, num_arriving)) {
        faces_->failed = true;
        return;
    }
    if (!has_face_around(first, num_arriving)) {
        exchange_lines(first, num_arriving);
        return;
    }
    Turn turn;
    gather(first, num_arriving, turn);
    std::size_t num_faces = 0;
    for (std::size_t j = 0; j < turn.num_lines; ++j) num_faces += turn.is_face[j] ? 1 : 0;
    if (num_faces == turn.num_lines) {
        std::fill_n(turn.region.begin(), turn.num_lines, turn.region[0]);
    } else {
        Corner corner;
        bool has_corner = false;
        for (std::size_t begin = 0; begin < turn.num_lines; ++begin) {
            if (!turn.is_face[begin] || turn.is_face[turn.before(begin)]) continue;
            Sectors face{begin, begin, begin == 0, begin == turn.below()};
            while (turn.is_face[turn.after(face.end)]) {
                face.end = turn.after(face.end);
                face.is_above |= face.end == 0;
                face.is_below |= face.end == turn.below();
            }
            if (goes_straight(turn, face)) continue;
            if (!has_corner) corner = make_vertex();
            has_corner = true;
            if (must_stop()) return;
            end_edges(turn, face, corner_vertices_[corner.vertex]);
            if (face.is_above && face.is_below) {
                part_face(turn, corner);
            } else {
                pass_face(turn, face, corner);
            }
        }
    }
    hand_over_regions(first, turn);
}

StripSweep::Corner StripSweep::crossing_corner(std::size_t p, const StripChart::Point& at) {
    const Line& upper = lines_[p];
    const Line& lower = lines_[p + 1];
    // outlines of one camera must not cross
    if (chart_.piece(upper.piece).view == chart_.piece(lower.piece).view) faces_->failed = true;
    const std::uint32_t vertex = triple_vertex(upper.strip, lower.strip, at);
    return make_corner(vertex, at, {upper.strip, lower.strip});
}

void StripSweep::turn_at_crossing(std::size_t p, const StripChart::Point& at) {
    turn(p, 2, [&] { return crossing_corner(p, at); });
}

// The usual crossing at a face, which lies in one of the four sectors.
void StripSweep::cross_at_one_face(std::size_t p,
                                   const StripChart::Point& at,
                                   const Verdict& between,
                                   bool has_face_between) {
    const Corner corner = crossing_corner(p, at);
    if (must_stop()) return;
    const std::uint32_t vertex = corner_vertices_[corner.vertex];
    const Line& above = lines_[p - 1];
    Line& upper = lines_[p];
    Line& lower = lines_[p + 1];
    if (above.face_below) {
        end_edge(upper, vertex, Side::kBottom);
        triangulator_.add(above.region_below, corner, Side::kBottom);
    } else if (lower.face_below) {
        end_edge(lower, vertex, Side::kTop);
        triangulator_.add(lower.region_below, corner, Side::kTop);
    } else if (upper.face_below) {
        end_edge(upper, vertex, Side::kTop);
        end_edge(lower, vertex, Side::kBottom);
        triangulator_.close(upper.region_below, corner);
    } else {
        upper.region_below = triangulator_.open(corner);
    }
    upper.edge_start = lower.edge_start = vertex;
    exchange_neighbours(p, between, has_face_between);
}

StripSweep::Corner StripSweep::event_corner(std::uint32_t e) {
    const StripChart::Event& event = chart_.event(e);
    const std::uint32_t piece = event.num_arriving > 0 ? event.arriving[0] : event.leaving[0];
    const StripChart::Point at = chart_.point(piece, chart_.place(e));
    const auto& strips = cones_->incidence[event.ray].strips;
    return make_corner(event_vertex(event), at, {strips[0], strips[1]});
}

void StripSweep::turn_at_event(std::size_t first, std::size_t num_arriving, std::uint32_t e) {
    turn(first, num_arriving, [&] { return event_corner(e); });
}

}  // namespace atrium::hull
