#include "bench/hull/hull_scenes.hpp"

#include "site_node/views/views_file.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/scene_maker.hpp"
#include "tests/support/shapes/union_outline.hpp"

#include <algorithm>
#include <random>

namespace atrium::bench {
namespace {

const std::filesystem::path kData = ATRIUM_SOURCE_DIR "/../shared/data";

constexpr std::uint64_t kPose = 6;  // one hand on the hip: a hole in some silhouettes
constexpr int kBallVertices = 96;   // finer than any outline taken from it

}  // namespace

std::vector<hull::SilhouetteView> person_views(int num_views, int segments_per_view) {
    std::mt19937_64 random(kPose);
    const std::vector<test::ConvexPart> parts = test::make_person(random, Eigen::Vector3d::Zero());
    std::vector<hull::SilhouetteView> views;
    for (const auto& camera : test::make_ring_rig({.num_cameras = num_views})) {
        std::vector<test::Contour> shapes;
        for (const test::ConvexPart& part : parts) {
            test::Contour points;
            for (const test::Sphere& ball : part.balls) {
                const test::Contour outline = test::outline_of(ball, camera, kBallVertices);
                points.insert(points.end(), outline.begin(), outline.end());
            }
            shapes.push_back(test::convex_hull(points));
        }
        const test::PixelBox picture{Eigen::Vector2d::Constant(-1e4),
                                     Eigen::Vector2d::Constant(1e4)};
        const test::UnionOutlineOptions options{
            .num_segments = segments_per_view,
            .num_cells = std::clamp(2 * segments_per_view, 300, 1000)};
        views.push_back(test::make_view(camera, test::outline_of_union(shapes, picture, options)));
    }
    return views;
}

std::optional<std::vector<hull::SilhouetteView>> shared_set(const std::string& name) {
    const auto loaded = views::load_views_file(kData / "hulls" / (name + ".json"));
    if (!loaded) return std::nullopt;
    std::vector<hull::SilhouetteView> views;
    for (const views::NamedView& view : *loaded) views.push_back(view.view);
    return views;
}

std::filesystem::path recording_folder(const std::string& name) {
    return kData / "recordings" / name;
}

std::size_t num_segments(const std::vector<hull::SilhouetteView>& views) {
    std::size_t sum = 0;
    for (const hull::SilhouetteView& view : views) {
        for (const auto& contour : view.contours) sum += contour.size();
    }
    return sum;
}

}  // namespace atrium::bench
