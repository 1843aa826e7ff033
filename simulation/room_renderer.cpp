#include "simulation/room_renderer.hpp"

#include "simulation/person_painter.hpp"
#include "simulation/room.hpp"
#include "simulation/sensor_noise.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <optional>

namespace atrium::simulation {
namespace {

Expected<void> check_cameras(const std::vector<geometry::CalibratedCamera>& cameras) {
    constexpr int kMaxPictureSidePx = 8192;
    if (cameras.empty())
        return make_error(ErrorKind::kConfiguration, "simulation: the rig has no camera");
    for (const geometry::CalibratedCamera& camera : cameras) {
        const geometry::PinholeCamera& c = camera.intrinsics;
        if (c.width < 2 || c.height < 2 || c.width > kMaxPictureSidePx ||
            c.height > kMaxPictureSidePx || c.width % 2 != 0 || c.height % 2 != 0) {
            return make_error(ErrorKind::kConfiguration,
                              "simulation: camera " + camera.name +
                                  ": width and height must be even, 2 to 8192 px");
        }
        if (!(c.fx > 0.0 && c.fy > 0.0)) {
            return make_error(ErrorKind::kConfiguration,
                              "simulation: camera " + camera.name + ": fx and fy must be > 0");
        }
    }
    return {};
}

// Returns the pixels that the skins can cover; the whole picture if part of them is beside or
// behind the camera.
image::PixelRect region_of(const geometry::CalibratedCamera& camera,
                           std::span<const PosedSkin> skins) {
    const geometry::PinholeCamera& c = camera.intrinsics;
    const Eigen::Matrix3d rotation = camera.camera_from_site.rotation.toRotationMatrix();
    Eigen::Array2d low = Eigen::Array2d::Constant(1e9);
    Eigen::Array2d high = Eigen::Array2d::Constant(-1e9);
    for (const PosedSkin& skin : skins) {
        for (const Eigen::Vector3f& p_site : skin.positions) {
            const Eigen::Vector3d p =
                rotation * p_site.cast<double>() + camera.camera_from_site.translation;
            if (p.z() < 0.05) return {0, 0, c.width, c.height};
            const Eigen::Array2d px = c.distort(c.project(p)).array();
            low = low.min(px);
            high = high.max(px);
        }
    }
    const int x0 = std::clamp(static_cast<int>(std::max(low.x(), -9.0)) - 2, 0, c.width);
    const int y0 = std::clamp(static_cast<int>(std::max(low.y(), -9.0)) - 2, 0, c.height);
    const int x1 = std::clamp(static_cast<int>(std::min(high.x(), 1e5)) + 3, 0, c.width);
    const int y1 = std::clamp(static_cast<int>(std::min(high.y(), 1e5)) + 3, 0, c.height);
    return {x0, y0, x1 - x0, y1 - y0};
}

void darken(const RoomView& view,
            std::span<const std::uint8_t> shadow,
            std::size_t first,
            std::size_t num,
            std::uint8_t* bgr) {
    for (std::size_t i = 0; i < num; ++i) {
        const unsigned hidden =
            shadow[view.shadow_index[first + i]] * view.shadow_strength[first + i];
        if (hidden == 0) continue;
        const unsigned kept = 65025 - hidden;  // of 255 * 255
        for (std::size_t channel = 0; channel < 3; ++channel) {
            bgr[3 * i + channel] =
                static_cast<std::uint8_t>((bgr[3 * i + channel] * kept + 32512) / 65025);
        }
    }
}

// `rgba` is premultiplied.
void lay_over(const std::uint8_t* rgba, int num, std::uint8_t* bgr) {
    for (int i = 0; i < num; ++i, rgba += 4, bgr += 3) {
        const unsigned uncovered = 255u - rgba[3];
        if (uncovered == 255u) continue;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const unsigned value = rgba[2 - channel] + (bgr[channel] * uncovered + 127u) / 255u;
            bgr[channel] = static_cast<std::uint8_t>(std::min(value, 255u));
        }
    }
}

}  // namespace

struct RoomRenderer::Impl {
    Impl(std::vector<geometry::CalibratedCamera> owned_cameras,
         const RoomOptions& room_options,
         std::vector<Person> made_people,
         std::vector<Model> made_models,
         Room made_room,
         PersonPainter made_painter)
        : cameras(std::move(owned_cameras)),
          people(std::move(made_people)),
          models(std::move(made_models)),
          room(std::move(made_room)),
          painter(std::move(made_painter)),
          noise(room_options.noise_lsb, room_options.seed),
          options(room_options),
          skins(std::max(people.size(), models.size())) {}

    std::vector<geometry::CalibratedCamera> cameras;
    std::vector<Person> people;
    std::vector<Model> models;  // instead of `people`
    Room room;
    PersonPainter painter;
    SensorNoise noise;
    std::vector<RoomView> views;
    RoomOptions options;
    std::optional<double> posed_time_s;
    std::vector<PosedSkin> skins;
    std::span<const std::uint8_t> shadow;
    std::vector<std::uint8_t> bgr;

    void pose(double time_s) {
        if (posed_time_s == time_s) return;
        for (std::size_t i = 0; i < skins.size(); ++i) {
            const double own_s = time_of_person_s(options, static_cast<int>(i), time_s);
            models.empty() ? people[i].pose(own_s, skins[i]) : models[i].pose(own_s, skins[i]);
            painter.set_pose(i, skins[i]);
        }
        shadow = painter.draw_shadow();
        posed_time_s = time_s;
    }

    void add_people(std::size_t camera_index, image::Mask* true_mask) {
        const RoomView& view = views[camera_index];
        darken(view, shadow, 0, view.shadow_index.size(), bgr.data());
        const image::PixelRect region = region_of(cameras[camera_index], skins);
        if (region.empty()) return;
        const std::span<const std::uint8_t> rgba = painter.draw(cameras[camera_index], region);
        for (int y = 0; y < region.height; ++y) {
            const std::uint8_t* row =
                rgba.data() + static_cast<std::ptrdiff_t>(4) * y * region.width;
            const std::ptrdiff_t start =
                static_cast<std::ptrdiff_t>(region.y + y) * view.width + region.x;
            lay_over(row, region.width, bgr.data() + 3 * start);
            if (true_mask == nullptr) continue;
            for (int x = 0; x < region.width; ++x)
                true_mask->data[static_cast<std::size_t>(start + x)] =
                    row[4 * x + 3] >= 128 ? 255 : 0;
        }
    }
};

RoomRenderer::RoomRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RoomRenderer::RoomRenderer(RoomRenderer&&) noexcept = default;
RoomRenderer& RoomRenderer::operator=(RoomRenderer&&) noexcept = default;
RoomRenderer::~RoomRenderer() = default;

Expected<RoomRenderer> RoomRenderer::create(std::vector<geometry::CalibratedCamera> cameras,
                                            const RoomOptions& options) {
    if (auto valid = check_cameras(cameras); !valid) return tl::unexpected(valid.error());
    if (auto valid = check(options); !valid) return tl::unexpected(valid.error());
    std::vector<Person> people;
    std::vector<Model> models;
    for (int i = 0; i < options.num_people; ++i) {
        const RoomOptions own = options_of_person(options, i);
        if (options.model.empty()) {
            auto made = Person::create(own);
            if (!made) return tl::unexpected(made.error());
            people.push_back(std::move(*made));
        } else {
            auto loaded = Model::load(own);
            if (!loaded) return tl::unexpected(loaded.error());
            models.push_back(std::move(*loaded));
        }
    }
    int max_width = 0;
    int max_height = 0;
    for (const geometry::CalibratedCamera& camera : cameras) {
        max_width = std::max(max_width, camera.intrinsics.width);
        max_height = std::max(max_height, camera.intrinsics.height);
    }
    const Room room = make_room(cameras, options);
    auto painter = models.empty() ? PersonPainter::create(people, room, max_width, max_height)
                                  : PersonPainter::create(models, room, max_width, max_height);
    if (!painter) return tl::unexpected(painter.error());
    auto impl = std::make_unique<Impl>(std::move(cameras),
                                       options,
                                       std::move(people),
                                       std::move(models),
                                       room,
                                       std::move(*painter));
    for (const geometry::CalibratedCamera& camera : impl->cameras) {
        impl->views.push_back(view_room(room, camera.intrinsics, camera.camera_from_site));
    }
    return RoomRenderer(std::move(impl));
}

void RoomRenderer::render(double time_s,
                          std::size_t camera_index,
                          Scene scene,
                          std::uint32_t shot,
                          image::YuvImage& out,
                          image::Mask* true_mask) {
    assert(camera_index < impl_->cameras.size());
    const RoomView& view = impl_->views[camera_index];
    impl_->bgr = view.bgr;
    if (true_mask != nullptr) *true_mask = image::Mask(view.width, view.height);
    if (scene == Scene::kPerson) {
        impl_->pose(time_s);
        impl_->add_people(camera_index, true_mask);
    }
    const std::uint64_t picture = std::bit_cast<std::uint64_t>(time_s) * 0x9e3779b97f4a7c15ull +
                                  (static_cast<std::uint64_t>(shot) << 20) + 2 * camera_index +
                                  (scene == Scene::kPerson ? 1 : 0);
    const std::size_t row_bytes = static_cast<std::size_t>(view.width) * 3;
    for (int y = 0; y < view.height; ++y) {
        impl_->noise.add(
            picture, y, {impl_->bgr.data() + static_cast<std::size_t>(y) * row_bytes, row_bytes});
    }
    image::yuv_from_bgr(impl_->bgr.data(), view.width, view.height, row_bytes, out);
}

const Person& RoomRenderer::person(std::size_t index) const {
    assert(index < impl_->people.size());
    return impl_->people[index];
}

const std::vector<geometry::CalibratedCamera>& RoomRenderer::cameras() const {
    return impl_->cameras;
}

}  // namespace atrium::simulation
