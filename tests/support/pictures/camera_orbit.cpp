#include "tests/support/pictures/camera_orbit.hpp"

#include "simulation/person_painter.hpp"
#include "simulation/room.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace atrium::test {
namespace {

constexpr double kMiddle_m = 0.9;  // height of the target
constexpr int kBlock_px = 16;
constexpr std::array<std::uint8_t, 3> kScreenBgr{96, 150, 40};

Photo on_grey(std::span<const std::uint8_t> rgba, int width, int height) {
    Photo photo{width, height, {}, image::Mask(width, height)};
    photo.bgr.resize(photo.opacity.data.size() * 3);
    for (std::size_t i = 0; i < photo.opacity.data.size(); ++i) {
        const std::uint8_t* p = rgba.data() + 4 * i;
        photo.opacity.data[i] = p[3] > 0 ? 255 : 0;
        // like `PersonPhotographer`: the mean of the samples that show the person
        for (std::size_t c = 0; c < 3; ++c)
            photo.bgr[3 * i + c] = static_cast<std::uint8_t>(
                p[3] > 0 ? std::min(255, (p[2 - c] * 255 + p[3] / 2) / p[3]) : 128);
    }
    return photo;
}

// Sums of absolute differences over blocks, row by row.
std::vector<double> block_changes(const Photo& a, const Photo& b) {
    const int num_across = (a.width + kBlock_px - 1) / kBlock_px;
    const int num_down = (a.height + kBlock_px - 1) / kBlock_px;
    std::vector<double> sums(static_cast<std::size_t>(num_across * num_down), 0.0);
    std::size_t i = 0;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x, i += 3) {
            int sum = 0;
            for (std::size_t c = i; c < i + 3; ++c)
                sum += std::abs(static_cast<int>(a.bgr[c]) - static_cast<int>(b.bgr[c]));
            sums[static_cast<std::size_t>(y / kBlock_px * num_across + x / kBlock_px)] += sum / 3.0;
        }
    }
    return sums;
}

}  // namespace

geometry::CalibratedCamera camera_at(const Eigen::Vector3d& position_site,
                                     const Eigen::Vector3d& target_site,
                                     int width_px,
                                     int height_px,
                                     double focal_px) {
    const Eigen::Vector3d z = (target_site - position_site).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d rotation;
    rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
    geometry::CalibratedCamera camera;
    camera.name = "viewpoint";
    camera.intrinsics = {.width = width_px,
                         .height = height_px,
                         .fx = focal_px,
                         .fy = focal_px,
                         .cx = (width_px - 1) / 2.0,
                         .cy = (height_px - 1) / 2.0};
    camera.camera_from_site.rotation = Eigen::Quaterniond(rotation);
    camera.camera_from_site.translation = -(rotation * position_site);
    return camera;
}

std::vector<geometry::CalibratedCamera> orbit(
    int num_steps, double radius_m, double height_m, int width_px, int height_px, double focal_px) {
    std::vector<geometry::CalibratedCamera> cameras;
    for (int i = 0; i < num_steps; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / num_steps;
        cameras.push_back(
            camera_at({radius_m * std::cos(angle), radius_m * std::sin(angle), height_m},
                      {0.0, 0.0, kMiddle_m},
                      width_px,
                      height_px,
                      focal_px));
    }
    return cameras;
}

std::vector<geometry::CalibratedCamera> free_viewpoints(int count, int side_px, double focal_px) {
    std::vector<geometry::CalibratedCamera> cameras;
    for (int i = 0; i < count; ++i) {
        const double angle = 2.39996323 * i;  // the golden angle
        const double height_m = 0.5 + 1.9 * (i * 7 % count + 0.5) / count;
        const double radius_m = 2.4 + 0.8 * (i * 3 % count + 0.5) / count;
        cameras.push_back(
            camera_at({radius_m * std::cos(angle), radius_m * std::sin(angle), height_m},
                      {0.0, 0.0, kMiddle_m},
                      side_px,
                      side_px,
                      focal_px));
    }
    return cameras;
}

namespace {

// Calls `take` with each camera's drawing of the person (`PersonPainter::draw`).
template <typename Take>
Expected<void> draw_truth(std::span<const geometry::CalibratedCamera> room_cameras,
                          const simulation::RoomOptions& options,
                          double time_s,
                          std::span<const geometry::CalibratedCamera> cameras,
                          const Take& take) {
    const auto person = simulation::Person::create(options);
    if (!person) return tl::unexpected(person.error());
    int width = 0;
    int height = 0;
    for (const geometry::CalibratedCamera& camera : cameras) {
        width = std::max(width, camera.intrinsics.width);
        height = std::max(height, camera.intrinsics.height);
    }
    auto painter = simulation::PersonPainter::create(
        std::span(&*person, 1), simulation::make_room(room_cameras, options), width, height);
    if (!painter) return tl::unexpected(painter.error());
    simulation::PosedSkin skin;
    person->pose(time_s, skin);
    painter->set_pose(0, skin);
    for (const geometry::CalibratedCamera& camera : cameras) {
        const geometry::PinholeCamera& lens = camera.intrinsics;
        take(camera, painter->draw(camera, {0, 0, lens.width, lens.height}));
    }
    return {};
}

}  // namespace

Expected<std::vector<Photo>> photograph_truth(
    std::span<const geometry::CalibratedCamera> room_cameras,
    const simulation::RoomOptions& options,
    double time_s,
    std::span<const geometry::CalibratedCamera> cameras) {
    std::vector<Photo> photos;
    const auto drawn =
        draw_truth(room_cameras, options, time_s, cameras, [&](const auto& camera, auto rgba) {
            photos.push_back(on_grey(rgba, camera.intrinsics.width, camera.intrinsics.height));
        });
    if (!drawn) return tl::unexpected(drawn.error());
    return photos;
}

Expected<std::vector<TruePicture>> film_before_screen(
    std::span<const geometry::CalibratedCamera> room_cameras,
    const simulation::RoomOptions& options,
    double time_s,
    std::span<const geometry::CalibratedCamera> cameras) {
    std::vector<TruePicture> pictures;
    const auto drawn =
        draw_truth(room_cameras, options, time_s, cameras, [&](const auto& camera, auto rgba) {
            const auto& lens = camera.intrinsics;
            TruePicture& picture = pictures.emplace_back();
            picture.camera = camera;
            picture.mask = image::Mask(lens.width, lens.height);
            picture.bgr.resize(picture.mask.data.size() * 3);
            for (std::size_t i = 0; i < picture.mask.data.size(); ++i) {
                const std::uint8_t* p = rgba.data() + 4 * i;
                picture.mask.data[i] = p[3] >= 128 ? 255 : 0;
                for (std::size_t c = 0; c < 3; ++c)
                    picture.bgr[3 * i + c] = static_cast<std::uint8_t>(
                        std::min(255, p[2 - c] + kScreenBgr[c] * (255 - p[3]) / 255));
            }
            image::yuv_from_bgr(picture.bgr.data(),
                                lens.width,
                                lens.height,
                                static_cast<std::size_t>(lens.width) * 3,
                                picture.yuv);
        });
    if (!drawn) return tl::unexpected(drawn.error());
    return pictures;
}

PictureChanges changes(std::span<const Photo> photos) {
    PictureChanges all;
    for (std::size_t i = 0; i + 1 < photos.size(); ++i) {
        const Photo& from = photos[i];
        const std::vector<double> blocks = block_changes(from, photos[i + 1]);
        double sum = 0.0;
        for (const double block : blocks) {
            sum += block;
            all.largest_block = std::max(all.largest_block, block / (kBlock_px * kBlock_px));
        }
        const double mean = sum / (static_cast<double>(from.width) * from.height);
        all.largest = std::max(all.largest, mean);
        all.mean += mean / static_cast<double>(photos.size() - 1);
    }
    return all;
}

}  // namespace atrium::test
