#include "tests/support/people/walk_film.hpp"

#include "tests/support/people/walking_people.hpp"

namespace atrium::test {
namespace {

constexpr std::size_t kLooks = 48;
constexpr double kLook_s = 0.5;
constexpr double kInstant_s = 1.0 / 30.0;
constexpr std::size_t kEvery = 8;  // of the vertices

}  // namespace

WalkFilm::WalkFilm(std::uint64_t seed, int num_people, std::size_t first_look)
    : seed_(seed), first_look_(first_look) {
    const WalkingPeople people({.seed = seed, .num_people = num_people});
    for (std::size_t i = 0; i < kLooks; ++i) {
        const double now_s = 1.0 + kLook_s * static_cast<double>(first_look + i);
        auto& look = looks_.emplace_back();
        for (int offset = -2; offset <= 1; ++offset)
            look[static_cast<std::size_t>(offset + 2)] =
                people.points(now_s + offset * kInstant_s, kEvery);
    }
}

coherence::Sight WalkFilm::sight(std::size_t look, const Filming& filming) const {
    Random random(1000 * seed_ + first_look_ + look);
    coherence::Sight sight;
    for (const bool is_now : {true, false}) {
        auto& hulls = is_now ? sight.now : sight.before;
        for (std::size_t c = 0; c < filming.truth.size(); ++c) {
            const int late = c == filming.late_camera ? filming.late_instants : 0;
            const auto& points = looks_[look][static_cast<std::size_t>((is_now ? 2 : 1) - late)];
            const geometry::CalibratedCamera& camera = filming.truth[c];
            std::vector<std::vector<Eigen::Vector2d>> contours(1);
            for (const Eigen::Vector3d& p : points) {
                Eigen::Vector2d px = camera.intrinsics.project(camera.camera_from_site * p);
                px.x() += between(random, -filming.noise_px, filming.noise_px);
                px.y() += between(random, -filming.noise_px, filming.noise_px);
                contours[0].push_back(px);
            }
            if (filming.spoil) filming.spoil(c, first_look_ + look, random, contours);
            const Eigen::Vector2d last(camera.intrinsics.width - 0.5,
                                       camera.intrinsics.height - 0.5);
            for (auto& contour : contours)
                for (Eigen::Vector2d& px : contour)
                    px = px.cwiseMax(Eigen::Vector2d::Constant(-0.5)).cwiseMin(last).eval();
            hulls.push_back(coherence::hull_of(contours, camera.intrinsics));
        }
    }
    return sight;
}

}  // namespace atrium::test
