#include "tests/unit/occupied_room/occupied_capsules.hpp"

#include "tests/support/random.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/unit/site_node/capsule_room.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::occupied_room::test {
namespace {

constexpr int kSide = 160;

// Stripes, tiles and a gradient: neither flat nor one colour.
image::YuvImage patterned_room(std::size_t camera) {
    image::YuvImage room{{kSide, kSide}, {kSide / 2, kSide / 2}, {kSide / 2, kSide / 2}};
    const double phase = static_cast<double>(camera);
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const double tile = y > 100 && ((x / 16 + y / 12) & 1) != 0 ? -14.0 : 0.0;
            room.y.row(y)[x] = static_cast<std::uint8_t>(140.0 + 20.0 * std::sin(0.05 * x + phase) +
                                                         0.15 * y + tile);
            room.u.row(y / 2)[x / 2] = static_cast<std::uint8_t>(y > 100 ? 122 : 130);
            room.v.row(y / 2)[x / 2] = static_cast<std::uint8_t>(126 + x / 40);
        }
    }
    return room;
}

}  // namespace

CapsuleFilm::CapsuleFilm(int num_cameras)
    : cameras(atrium::test::make_ring_rig(
          {.num_cameras = num_cameras, .radius_m = 3.2, .size_px = kSide, .focal_px = 170.0})),
      bounds_site{{-1.2, -1.2, 0.0}, {1.2, 1.2, 2.0}} {
    for (std::size_t camera = 0; camera < cameras.size(); ++camera)
        rooms_.push_back(patterned_room(camera));
    drawn_.resize(cameras.size());
}

const CapsuleFilm::Drawn& CapsuleFilm::drawn(std::size_t camera,
                                             const Eigen::Vector3d& floor_site) {
    std::optional<Drawn>& last = drawn_[camera];
    if (!last || last->floor_site != floor_site) {
        const auto body = site_node::test::make_body(floor_site);
        last = Drawn{floor_site,
                     site_node::test::draw(body, cameras[camera]),
                     site_node::test::draw(std::span(body).subspan(2, 2), cameras[camera])};
    }
    return *last;
}

void CapsuleFilm::add_noise(image::YuvImage& picture) {
    atrium::test::Random random(seed_++);
    std::normal_distribution<double> noise(0.0, 1.2);
    for (image::Plane* plane : {&picture.y, &picture.u, &picture.v}) {
        const double scale = plane == &picture.y ? 1.0 : 0.5;
        for (std::uint8_t& value : plane->data)
            value = static_cast<std::uint8_t>(
                std::clamp(std::lround(value + scale * noise(random)), 0L, 255L));
    }
}

image::YuvImage CapsuleFilm::empty(std::size_t camera) {
    image::YuvImage picture = rooms_[camera];
    add_noise(picture);
    return picture;
}

image::YuvImage CapsuleFilm::picture(std::size_t camera,
                                     const Eigen::Vector3d& floor_site,
                                     image::Mask* truth) {
    image::YuvImage picture = rooms_[camera];
    const auto& [_, mask, legs] = drawn(camera, floor_site);
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            if (mask.at(x, y) == 0) continue;
            const bool is_leg = legs.at(x, y) != 0;
            picture.y.row(y)[x] = is_leg ? 45 : 90;
            picture.u.row(y / 2)[x / 2] = is_leg ? 135 : 110;
            picture.v.row(y / 2)[x / 2] = is_leg ? 122 : 170;
        }
    }
    add_noise(picture);
    if (truth != nullptr) *truth = mask;
    return picture;
}

segmentation::BackgroundStatistics CapsuleFilm::learned_empty(std::size_t camera) {
    segmentation::BackgroundLearner learner;
    for (int i = 0; i < 12; ++i) (void)learner.add(empty(camera));
    return *learner.finish();
}

}  // namespace atrium::occupied_room::test
