#include "tests/support/shapes/exact_intersection.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Nef_polyhedron_3.h>
#include <CGAL/Polyhedron_3.h>
#include <CGAL/Polyhedron_incremental_builder_3.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace atrium::test {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Polyhedron = CGAL::Polyhedron_3<Kernel>;
using Nef = CGAL::Nef_polyhedron_3<Kernel>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;

Vector exact(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// The pyramid over one loop, which ends at the plane at `far_m` along the axis.
class PyramidBuilder : public CGAL::Modifier_base<Polyhedron::HalfedgeDS> {
public:
    PyramidBuilder(const ExactCone& cone, const std::vector<Eigen::Vector3d>& loop, double far_m) {
        const Point apex = CGAL::ORIGIN + exact(cone.centre);
        const Vector axis = exact(cone.axis);
        Vector area = CGAL::NULL_VECTOR;
        for (const Eigen::Vector3d& direction : loop) {
            const Vector ray = exact(direction);
            // in rational numbers, which keep the base exactly flat
            base_.push_back(apex + ray * (Kernel::FT(far_m) / (ray * axis)));
        }
        for (std::size_t i = 0; i < base_.size(); ++i) {
            area =
                area + CGAL::cross_product(base_[i] - apex, base_[(i + 1) % base_.size()] - apex);
        }
        if (area * axis < 0) std::reverse(base_.begin(), base_.end());
        apex_ = apex;
    }

    void operator()(Polyhedron::HalfedgeDS& structure) override {
        const std::size_t n = base_.size();
        CGAL::Polyhedron_incremental_builder_3<Polyhedron::HalfedgeDS> builder(structure, true);
        builder.begin_surface(n + 1, n + 1);
        for (const Point& p : base_) builder.add_vertex(p);
        builder.add_vertex(apex_);
        for (std::size_t i = 0; i < n; ++i) {
            builder.begin_facet();
            for (const std::size_t corner : {n, (i + 1) % n, i})
                builder.add_vertex_to_facet(corner);
            builder.end_facet();
        }
        builder.begin_facet();
        for (std::size_t i = 0; i < n; ++i) builder.add_vertex_to_facet(i);
        builder.end_facet();
        builder.end_surface();
    }

private:
    Point apex_;
    std::vector<Point> base_;
};

Nef solid_of(const ExactCone& cone, double far_m) {
    Nef solid(Nef::EMPTY);
    for (const auto& loop : cone.loops) {
        PyramidBuilder builder(cone, loop, far_m);
        Polyhedron pyramid;
        pyramid.delegate(builder);
        solid = solid ^ Nef(pyramid);
    }
    return solid.regularization();
}

Eigen::Vector3d rounded(const Point& p) {
    // `to_double` of a lazy number is accurate to 1e-5 only, that of its exact value to the last
    // bit
    return {CGAL::to_double(p.x().exact()),
            CGAL::to_double(p.y().exact()),
            CGAL::to_double(p.z().exact())};
}

// Twice the area vector of one cycle of a face, around `origin`.
Eigen::Vector3d double_area(Nef::SHalfedge_const_handle start, const Eigen::Vector3d& origin) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Nef::SHalfedge_around_facet_const_circulator at(start);
    const Nef::SHalfedge_around_facet_const_circulator end(at);
    do {
        const Eigen::Vector3d p = rounded(at->source()->center_vertex()->point()) - origin;
        ++at;
        sum += p.cross(rounded(at->source()->center_vertex()->point()) - origin);
    } while (at != end);
    return sum;
}

void measure_faces(const Nef& nef, ExactSolid& solid) {
    const Eigen::Vector3d origin = solid.vertices.front();
    double six_volumes = 0.0;
    for (auto face = nef.halffacets_begin(); face != nef.halffacets_end(); ++face) {
        if (!face->incident_volume()->mark()) continue;  // seen from inside the solid, once each
        std::int64_t num_cycles = 0;
        Eigen::Vector3d area = Eigen::Vector3d::Zero();
        Eigen::Vector3d corner = origin;
        for (auto cycle = face->facet_cycles_begin(); cycle != face->facet_cycles_end(); ++cycle) {
            if (!cycle.is_shalfedge()) continue;
            const Nef::SHalfedge_const_handle edge(cycle);
            corner = rounded(edge->source()->center_vertex()->point());
            area += double_area(edge, origin);
            ++num_cycles;
        }
        six_volumes += area.dot(corner - origin);
        solid.euler_characteristic += 2 - num_cycles;
    }
    solid.volume_m3 = std::abs(six_volumes) / 6.0;
}

}  // namespace

ExactSolid intersect_exactly(std::span<const ExactCone> cones, double far_m) {
    Nef common = solid_of(cones.front(), far_m);
    for (const ExactCone& cone : cones.subspan(1)) common = common * solid_of(cone, far_m);
    common = common.regularization();

    ExactSolid solid;
    for (auto volume = common.volumes_begin(); volume != common.volumes_end(); ++volume)
        solid.num_components += volume->mark() ? 1 : 0;
    if (solid.num_components == 0) return solid;
    for (auto v = common.vertices_begin(); v != common.vertices_end(); ++v)
        solid.vertices.push_back(rounded(v->point()));
    solid.num_edges = common.number_of_edges();
    solid.euler_characteristic = static_cast<std::int64_t>(solid.vertices.size()) -
                                 static_cast<std::int64_t>(solid.num_edges);
    measure_faces(common, solid);
    for (const ExactCone& cone : cones) {
        for (const Eigen::Vector3d& p : solid.vertices)
            solid.is_cut |= cone.axis.dot(p - cone.centre) > 0.999999 * far_m;
    }
    return solid;
}

}  // namespace atrium::test
