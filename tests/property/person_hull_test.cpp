#include "core/config/rig.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "tests/support/shapes/winding_number.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <limits>

// Compares the simulated person with its hull, from pictures like a camera's, with noise and
// shadow.
namespace atrium {
namespace {

using simulation::Scene;

struct Case {
    const char* look;
    const char* motion;
    double time_s;
};

class PersonHull : public testing::TestWithParam<Case> {
protected:
    void SetUp() override {
        auto rig = config::load_rig(atrium::test::source_dir() + "/deploy/rigs/full_body.toml");
        ASSERT_TRUE(rig) << rig.error().message;
        cameras_ = rig->cameras;
        simulation::RoomOptions options;
        options.look = GetParam().look;
        options.motion = GetParam().motion;
        auto renderer = simulation::RoomRenderer::create(cameras_, options);
        ASSERT_TRUE(renderer) << renderer.error().message;
        renderer_.emplace(std::move(*renderer));
        truth_ = renderer_->person().mesh(GetParam().time_s);
    }

    hull::SilhouetteView view_of(std::size_t camera, const image::Mask& mask) {
        hull::SilhouetteView view{
            cameras_[camera].intrinsics, cameras_[camera].camera_from_site, {}, {}};
        std::vector<silhouette::SilhouettePolygon> polygons;
        silhouette::extract_silhouette(
            mask, cameras_[camera].intrinsics, {}, silhouette_scratch_, polygons);
        for (auto& polygon : polygons) view.contours.push_back(std::move(polygon.vertices_px));
        return view;
    }

    std::vector<hull::SilhouetteView> views_of_true_masks() {
        std::vector<hull::SilhouetteView> views;
        image::YuvImage picture;
        for (std::size_t c = 0; c < cameras_.size(); ++c) {
            image::Mask mask;
            renderer_->render(GetParam().time_s, c, Scene::kPerson, 0, picture, &mask);
            views.push_back(view_of(c, mask));
        }
        return views;
    }

    std::vector<hull::SilhouetteView> views_of_segmented_pictures() {
        std::vector<hull::SilhouetteView> views;
        image::YuvImage picture;
        for (std::size_t c = 0; c < cameras_.size(); ++c) {
            segmentation::BackgroundLearner learner;
            for (std::uint32_t shot = 1; shot <= 8; ++shot) {
                renderer_->render(0.0, c, Scene::kEmptyRoom, shot, picture);
                EXPECT_TRUE(learner.add(picture));
            }
            segmentation::Segmenter segmenter(learner.finish().value(), {});
            renderer_->render(GetParam().time_s, c, Scene::kPerson, 100, picture);
            image::Mask mask;
            EXPECT_TRUE(segmenter.segment(picture, mask));
            views.push_back(view_of(c, mask));
        }
        return views;
    }

    /// Fraction of the true person's vertices that are inside `mesh`, or outside it by at most
    /// `slack_px` pixels of the camera in which that vertex is largest.
    double share_contained(const geometry::TriangleMesh& mesh, double slack_px) const {
        std::size_t num_contained = 0;
        std::size_t num_tried = 0;
        constexpr std::size_t kStride = 23;  // the skin is far finer than the hull
        for (std::size_t i = 0; i < truth_.vertices.size(); i += kStride) {
            const Eigen::Vector3d& p = truth_.vertices[i];
            ++num_tried;
            num_contained +=
                test::winding_number(mesh, p) > 0.5 || distance(mesh, p) <= slack_px * pixel_at(p);
        }
        return static_cast<double>(num_contained) / static_cast<double>(num_tried);
    }

    std::vector<geometry::CalibratedCamera> cameras_;
    std::optional<simulation::RoomRenderer> renderer_;
    geometry::TriangleMesh truth_;
    silhouette::SilhouetteScratch silhouette_scratch_;
    hull::HullScratch hull_scratch_;

private:
    double pixel_at(const Eigen::Vector3d& p_site) const {
        double smallest = std::numeric_limits<double>::infinity();
        for (const auto& camera : cameras_) {
            smallest =
                std::min(smallest, (camera.camera_from_site * p_site).z() / camera.intrinsics.fx);
        }
        return smallest;
    }

    static double distance(const geometry::TriangleMesh& mesh, const Eigen::Vector3d& p) {
        double best = std::numeric_limits<double>::infinity();
        for (const auto& [a, b, c] : mesh.triangles) {
            best =
                std::min(best, distance(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], p));
        }
        return best;
    }

    // to a triangle: its plane if the foot point is inside, otherwise its nearest edge
    static double distance(const Eigen::Vector3d& a,
                           const Eigen::Vector3d& b,
                           const Eigen::Vector3d& c,
                           const Eigen::Vector3d& p) {
        const Eigen::Vector3d normal = (b - a).cross(c - a);
        const double area_sq = normal.squaredNorm();
        if (area_sq > 0.0) {
            const double u = (b - p).cross(c - p).dot(normal) / area_sq;
            const double v = (c - p).cross(a - p).dot(normal) / area_sq;
            if (u >= 0.0 && v >= 0.0 && u + v <= 1.0)
                return std::abs((p - a).dot(normal)) / std::sqrt(area_sq);
        }
        const auto to_edge = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
            const double length_sq = (to - from).squaredNorm();
            const double t =
                length_sq > 0.0 ? std::clamp((p - from).dot(to - from) / length_sq, 0.0, 1.0) : 0.0;
            return (p - from - t * (to - from)).norm();
        };
        return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
    }
};

TEST_P(PersonHull, ContainsThePersonUpToAPixel) {
    const hull::VisualHull hull =
        hull::compute_visual_hull(views_of_true_masks(), {}, hull_scratch_);
    ASSERT_EQ(hull.status, hull::HullStatus::kOk);
    EXPECT_TRUE(geometry::inspect(hull.mesh).manifold);
    EXPECT_EQ(share_contained(hull.mesh, 1.0), 1.0);
    EXPECT_GT(geometry::volume_m3(hull.mesh), geometry::volume_m3(truth_));
}

// The blurred segments may be off by one pixel, and a noisy edge by one more. Thinner parts may be
// lost.
TEST_P(PersonHull, ContainsThePersonAfterRealSegmentation) {
    const hull::VisualHull hull =
        hull::compute_visual_hull(views_of_segmented_pictures(), {}, hull_scratch_);
    ASSERT_EQ(hull.status, hull::HullStatus::kOk);
    EXPECT_TRUE(geometry::inspect(hull.mesh).manifold);
    EXPECT_GT(share_contained(hull.mesh, 2.0), 0.99);
}

TEST_P(PersonHull, MoreCamerasNeverAddVolume) {
    const auto views = views_of_true_masks();
    double former = std::numeric_limits<double>::infinity();
    for (std::size_t n = 3; n <= views.size(); ++n) {
        hull::HullOptions keep_all;
        keep_all.keep_phantoms = true;  // dropping by size is not monotonic
        const auto hull =
            hull::compute_visual_hull(std::span(views).first(n), keep_all, hull_scratch_);
        ASSERT_EQ(hull.status, hull::HullStatus::kOk);
        const double volume = geometry::volume_m3(hull.mesh);
        EXPECT_LE(volume, former * (1 + 1e-9)) << n << " cameras";
        former = volume;
    }
}

INSTANTIATE_TEST_SUITE_P(People,
                         PersonHull,
                         testing::Values(Case{"ada", "push", 1.5},
                                         Case{"ben", "wave", 0.4},
                                         Case{"otto", "walk", 2.2}),
                         [](const auto& people) { return std::string(people.param.look); });

}  // namespace
}  // namespace atrium
