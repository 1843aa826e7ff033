#pragma once

#include "site_node/hull/better_diagonals.hpp"
#include "site_node/hull/cones.hpp"
#include "site_node/hull/face_triangulator.hpp"
#include "site_node/hull/pencils.hpp"
#include "site_node/hull/strip_chart.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace atrium::hull {

/// Name of a hull vertex, by what meets in it: three strips (sorted, 20 bits each), a ray and a
/// strip (bit 62 set), or the centre of a camera in one of its loops (bit 63 set).
using VertexKey = std::uint64_t;
inline constexpr VertexKey kCentreBit = VertexKey{1} << 63;
inline constexpr VertexKey kRayBit = VertexKey{1} << 62;

/// A run of neighbouring strips of one chain, the unit of parallel work.
struct StripRun {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

/// The faces on one run of strips. Vertices are numbered within the run.
struct RunFaces {
    struct Vertex {
        VertexKey key = 0;
        bool is_owner = false;       // all runs use this `position` for the vertex
        bool may_be_needed = false;  // on a viewing edge or on the bounds
        Eigen::Vector3d position;    // grid frame
    };
    std::vector<Vertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::pair<std::uint32_t, std::uint32_t>>
        edges;                           // directed; the face is on the left, seen from outside
    std::size_t num_sides_on_lines = 0;  // triangle sides with both ends on one line
    std::uint64_t num_steps = 0;
    bool failed = false;  // not in general position
    bool unbounded = false;

    void clear() {
        vertices.clear();
        triangles.clear();
        edges.clear();
        num_sides_on_lines = 0;
        num_steps = 0;
        failed = unbounded = false;
    }
};

/// Finds and triangulates the faces of a run, strip by strip.
///
/// A vertical sweep line moves over the chart of the strip from left to right. It keeps the lines
/// in order of u, with the verdict of the other cameras on the gap below each line. A gap is part
/// of a face where `Cones::has_face` holds for its verdict. Every predicate is exact
/// (`StripChart`), so all strips find the same polyhedron.
///
/// Reuse one object; it allocates only while it grows. Not thread-safe: one object per worker.
class StripSweep {
public:
    /// Sweeps the strips of `run` and replaces `faces` by the result. `max_steps` limits
    /// `faces.num_steps`; above the limit `faces` is incomplete. Errors: `faces.failed` (not in
    /// general position) and `faces.unbounded`; the sweep then stops early.
    void run(const Cones& cones,
             const Pencils& pencils,
             const StripRun& run,
             std::uint64_t max_steps,
             RunFaces& faces);

private:
    using Corner = FaceTriangulator::Corner;
    using Lines = BetterDiagonals::Lines;
    using RegionId = FaceTriangulator::RegionId;
    using Side = FaceTriangulator::Side;
    using Place = StripChart::Place;

    // The strip's own two rays, as boundary lines of a corner.
    static constexpr std::uint32_t kFromRay = kNoStrip - 2;
    static constexpr std::uint32_t kToRay = kNoStrip - 3;

    struct Line {
        Verdict below;                            // of the other cameras on the gap below
        double meets_at = 0.0;                    // does not meet the line below it before this phi
        std::uint32_t piece = StripChart::kNone;  // kNone: the camera's centre
        std::uint32_t strip = 0;
        std::uint32_t end_event = StripChart::kNone;
        std::uint32_t edge_start = 0;  // vertex where its current edge began, if it bounds a face
        RegionId region_below = -1;
        bool face_below = false;
    };
    struct Entering {  // a piece on the strip's first ray
        double u = 0.0;
        double error = 0.0;
        std::uint32_t piece = 0;
    };
    /// Lines that begin in one point, from the upper to the lower one.
    class FewLines {
    public:
        void clear() { size_ = 0; }
        bool empty() const { return size_ == 0; }
        std::size_t size() const { return size_; }
        Line& operator[](std::size_t j) { return lines_[j]; }
        Line* begin() { return lines_.data(); }
        Line* end() { return lines_.data() + size_; }
        const Line* begin() const { return lines_.data(); }
        const Line* end() const { return lines_.data() + size_; }
        void insert(std::size_t at, const Line& line) {
            for (std::size_t j = size_++; j > at; --j) lines_[j] = lines_[j - 1];
            lines_[at] = line;
        }

    private:
        std::array<Line, 3> lines_;
        std::size_t size_ = 0;
    };
    /// The sectors around a point where lines end and others begin. Lines are numbered around the
    /// point: arriving ones from the upper to the lower, then leaving ones from the lower to the
    /// upper. Sector j lies between lines j - 1 and j. Sector 0 is above the point and sector
    /// `below()` is below it; these are the same sector where no line arrives or none leaves.
    struct Turn {
        static constexpr std::size_t kMost = 6;
        std::array<Line*, kMost> lines{};
        std::array<bool, kMost> is_face{};
        std::array<RegionId, kMost> region{};
        RegionId region_below = -1;
        std::size_t num_arriving = 0;
        std::size_t num_lines = 0;
        std::size_t below() const { return num_arriving % num_lines; }
        std::size_t after(std::size_t j) const { return j + 1 == num_lines ? 0 : j + 1; }
        std::size_t before(std::size_t j) const { return j == 0 ? num_lines - 1 : j - 1; }
    };

    /// A face that covers the sectors from `begin` to `end` of a turn, inclusive.
    struct Sectors {
        std::size_t begin = 0;
        std::size_t end = 0;
        bool is_above = false;  // includes the sector above the point
        bool is_below = false;
    };

    void sweep_strip();
    void enter_lines();
    template <typename Visit>
    void for_each_face(const Visit& visit);
    void begin_faces();
    void end_faces();
    bool is_ray_vertex(const Line& line, const Line& above) const;
    std::size_t end_of_face(std::size_t top) const;

    void advance(const Place& at);
    std::size_t first_crossing(const Place& at, double limit);
    bool is_reversed(std::size_t p, const Place& at);
    void find_meeting(std::size_t p);
    void cross(std::size_t p, const Place& at);
    void exchange_neighbours(std::size_t p, const Verdict& between, bool has_face_between);
    void handle(std::uint32_t event);
    void go_on(std::size_t p, std::uint32_t piece, std::uint32_t event);
    void collect_leaving(const StripChart::Event& event);
    void hide(std::size_t p, bool upwards);
    void show(std::size_t p, const Line& line, bool from_above);
    std::size_t place_of(std::uint32_t piece, const Place& at);

    // strip_sweep_turn.cpp: what happens to faces around a point
    template <typename MakeVertex>
    void turn(std::size_t first, std::size_t num_arriving, const MakeVertex& make_vertex);
    void turn_at_crossing(std::size_t p, const StripChart::Point& at);
    void cross_at_one_face(std::size_t p,
                           const StripChart::Point& at,
                           const Verdict& between,
                           bool has_face_between);
    Corner crossing_corner(std::size_t p, const StripChart::Point& at);
    void turn_at_event(std::size_t first, std::size_t num_arriving, std::uint32_t event);
    bool judge_leaving(std::size_t first, std::size_t num_arriving);
    bool has_face_around(std::size_t first, std::size_t num_arriving) const;
    Corner event_corner(std::uint32_t event);
    void bend(std::size_t p, const Corner& corner);
    void gather(std::size_t first, std::size_t num_arriving, Turn& turn);
    bool goes_straight(Turn& turn, const Sectors& face);
    void end_edges(const Turn& turn, const Sectors& face, std::uint32_t vertex);
    void pass_face(Turn& turn, const Sectors& face, const Corner& corner);
    void part_face(Turn& turn, const Corner& corner);
    void exchange_lines(std::size_t first, std::size_t num_arriving);
    void hand_over_regions(std::size_t first, const Turn& turn);

    // strip_sweep_vertices.cpp: names and places
    std::uint32_t add_vertex(VertexKey key, bool may_be_needed, const Eigen::Vector3d* position);
    std::uint32_t ray_vertex(std::uint32_t ray, const Line& line);
    std::uint32_t centre_vertex();
    std::uint32_t triple_vertex(std::uint32_t x, std::uint32_t y, const StripChart::Point& at);
    std::uint32_t event_vertex(const StripChart::Event& event);
    void start_corners();
    Corner make_corner(std::uint32_t vertex, const StripChart::Point& at, Lines lines);
    Corner ray_corner(std::uint32_t vertex, double phi, const Line& line);
    void finish_triangles();
    bool are_on_one_line(std::uint32_t corner_a, std::uint32_t corner_b) const;
    void end_edge(const Line& line, std::uint32_t vertex, Side side);

    bool must_stop() const {
        return faces_->failed || faces_->unbounded || chart_.num_steps() + num_steps_ > max_steps_;
    }
    Line make_line(std::uint32_t piece) const {
        const StripChart::Piece& of = chart_.piece(piece);
        Line line;
        line.piece = piece;
        line.strip = of.strip;
        line.end_event = of.end_event;
        return line;
    }
    void set_below(Line& line, const Verdict& verdict) const {
        line.below = verdict;
        line.face_below = cones_->has_face(own_, verdict);
    }

    const Cones* cones_ = nullptr;
    RunFaces* faces_ = nullptr;
    std::uint64_t max_steps_ = 0;
    std::uint64_t num_steps_ = 0;
    std::uint32_t strip_ = 0;
    Cones::Strip own_;
    double phi_ = 0.0;
    StripChart chart_;
    std::vector<Line> lines_;  // by falling u; the first one is the camera's centre
    FewLines leaving_;
    std::vector<Entering> entering_;
    std::vector<std::uint32_t> near_;  // lines that may cross their lower neighbours; only grows
    double next_meeting_ = 0.0;        // no two neighbours meet before this phi
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ray_vertices_;  // (strip, vertex) on a ray
    FaceTriangulator triangulator_;
    BetterDiagonals diagonals_;
    // of the current strip: triangles index corners, and each corner has a vertex of the run
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    std::vector<std::uint32_t> corner_vertices_;
    std::vector<Eigen::Vector2d> corners_m_;
    std::vector<Lines> corner_lines_;
    Eigen::Vector2d from_ray_;  // the strip's rays in an orthonormal frame of its plane
    Eigen::Vector2d to_ray_;
};

}  // namespace atrium::hull
