#pragma once

#include "site_node/hull/cones.hpp"
#include "site_node/hull/face_triangulator.hpp"
#include "site_node/hull/pencils.hpp"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace atrium::hull {

/// Ids of a hull vertex: the sorted triple of strips that meet in it, 21 bits each; bit 63 marks a
/// camera centre.
using VertexKey = std::uint64_t;
inline constexpr std::uint32_t kMaxStrips = (1u << 21) - 2;

/// A run of neighbouring strips of one contour: the unit of parallel work.
struct StripRun {
    std::uint32_t view = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

/// The faces on one run of strips; vertex numbers are the run's own.
struct RunFaces {
    struct Vertex {
        VertexKey key = 0;
        bool is_owner = false;  // `position` is the one that all runs use for this vertex
        bool on_viewing_edge = false;
        Eigen::Vector3d position;  // relative to Cones::origin
    };
    std::vector<Vertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::pair<std::uint32_t, std::uint32_t>>
        edges;  // directed, face to the left seen from outside
    std::uint64_t num_steps = 0;
    bool failed =
        false;  // the order of events contradicts itself: not in general position for double
    bool unbounded = false;

    void clear() {
        vertices.clear();
        triangles.clear();
        edges.clear();
        num_steps = 0;
        failed = unbounded = false;
    }
};

/// Finds the faces strip by strip.
///
/// Chart of a strip: phi in [0, 1] from ray g to ray next[g], u = 1 / depth, so that the lines in
/// which other strips cut this one are straight. From left to right it keeps the lines in order of
/// u, with the set of cones that the gap below each line is in; the face is where that set is full.
/// The order at the strip's last ray is the order with which the next strip starts, so one run is
/// one sweep.
class StripSweep {
public:
    void run(const Cones& cones,
             const Pencils& pencils,
             const StripRun& run,
             std::uint64_t max_steps,
             RunFaces& faces);

private:
    using Corner = FaceTriangulator::Corner;
    using Side = FaceTriangulator::Side;

    struct Line {
        double u_before = 0.0;  // at the last event
        double u = 0.0;         // now
        double phi0 = 0.0;      // this strip's part of the line, from (phi0, u0)
        double u0 = 0.0;
        double phi1 = 0.0;  // to (phi1, u1)
        double u1 = 0.0;
        double slope = 0.0;
        std::uint64_t inside_below = 0;  // bit k: the gap below is inside cone k
        std::int32_t region_below = -1;
        std::uint32_t strip = 0;
        std::uint32_t edge_start =
            0;  // vertex at which its current edge began, where it bounds a face
        std::uint32_t ray_vertex = 0;  // vertex on the ray that ends the strip
        std::uint32_t view = 0;
    };
    /// A ray of another camera pierces this strip.
    struct Event {
        double phi = 0.0;
        double u = 0.0;
        std::uint32_t ray = 0;
        std::uint32_t view = 0;
        bool rising = false;  // the sweep meets the rays of that camera by growing angle
    };
    struct EventRange {  // events of one camera in the current strip, before they are sorted
        std::uint32_t first = 0;
        std::uint32_t count = 0;
        std::uint32_t first_position = 0;
        bool rising = false;
    };

    static constexpr std::uint32_t kCentreStrip = std::numeric_limits<std::uint32_t>::max();
    static constexpr std::uint32_t kInfinityStrip = kCentreStrip - 1;

    // strip_sweep_events.cpp: what happens where
    void start_lines(std::uint32_t ray);
    void collect_events(std::uint32_t strip);
    void collect_events_of(std::uint32_t strip, std::uint32_t k);
    void aim(Line& line);
    double u_at_ray(std::uint32_t ray, std::uint32_t strip) const;

    // strip_sweep.cpp: the sweep itself
    void sweep_strip(std::uint32_t strip);
    void sort_events();
    void begin_faces();
    void end_faces();
    void advance(double phi);
    void resolve_crossings(double phi);
    void cross(std::size_t p, double phi, double u);
    void handle(const Event& event);
    void pass(std::size_t p, std::uint32_t strip, const Event& event);
    void insert_pair(std::uint32_t strip_a, std::uint32_t strip_b, const Event& event);
    void remove_pair(std::uint32_t strip_a, std::uint32_t strip_b, const Event& event);
    std::size_t find_line(std::uint32_t strip) const;

    // strip_sweep_vertices.cpp: names and places
    std::uint32_t add_vertex(VertexKey key, const Corner& at, bool is_owner, bool on_viewing_edge);
    std::uint32_t ray_vertex(std::uint32_t ray, std::uint32_t strip, double u);
    std::uint32_t centre_vertex();
    std::uint32_t triple_vertex(std::uint32_t strip_x, std::uint32_t strip_y, double phi, double u);
    std::uint32_t event_vertex(const Event& event);
    void end_edge(const Line& line, std::uint32_t vertex, Side side);

    std::uint64_t mask_above(std::size_t p) const { return lines_[p - 1].inside_below; }
    bool must_stop() const { return faces_->failed || faces_->num_steps > max_steps_; }
    bool is_full(std::uint64_t mask) const { return mask == full_; }

    const Cones* cones_ = nullptr;
    const Pencils* pencils_ = nullptr;
    RunFaces* faces_ = nullptr;
    std::uint64_t max_steps_ = 0;
    std::uint32_t view_ = 0;
    std::uint32_t strip_ = 0;
    std::uint64_t full_ = 0;
    double phi_ = 0.0;
    std::vector<Line> lines_;           // by falling u; the first is the camera's centre
    std::vector<Event> events_;         // by camera, then along the strip
    std::vector<std::uint32_t> order_;  // events along the strip
    std::vector<EventRange> ranges_;
    FaceTriangulator triangulator_;
};

}  // namespace atrium::hull
