#include "viewer/renderer/person/warm_up_person.hpp"

#include "viewer/renderer/person/camera_blend.hpp"

#include <Eigen/Geometry>

#include <cassert>
#include <cstdint>
#include <utility>

namespace atrium::renderer {
namespace {

// Not powers of two, like the sizes of real people, for which drivers may have separate shaders.
constexpr int kLayerWidth = 5;
constexpr int kLayerHeight = 3;

// Whether a camera sees a corner of the triangle with `num` cameras. The first three cameras see
// the first corner, the last three the second; the third corner equals the first.
bool sees(std::size_t camera, std::size_t corner, std::size_t num) {
    const std::size_t first = corner == 1 && num > kCamerasPerVertex ? num - kCamerasPerVertex : 0;
    return camera >= first && camera < first + kCamerasPerVertex && camera < num;
}

}  // namespace

PersonModel make_warm_up_person(const Eigen::Vector3f& eye_site,
                                const Eigen::Vector3f& target_site,
                                std::size_t num_cameras) {
    assert(num_cameras >= kCamerasPerTriangle.back());
    const Eigen::Vector3f to_eye = (eye_site - target_site).normalized();
    const Eigen::Vector3f right = to_eye.unitOrthogonal();
    const Eigen::Vector3f up = to_eye.cross(right);

    PersonModel model;
    for (std::size_t g = 0; g < kCamerasPerTriangle.size(); ++g) {
        const Eigen::Vector3f at = target_site + 0.2f * static_cast<float>(g) * right;
        const auto first = static_cast<std::uint32_t>(model.vertices_site.size());
        model.triangles.push_back({first, first + 1, first + 2});
        for (const Eigen::Vector3f& corner :
             {at, Eigen::Vector3f(at + 0.1f * right), Eigen::Vector3f(at + 0.1f * up)}) {
            model.vertices_site.push_back(corner);
            model.bounds_site.extend(corner);
        }
    }
    const std::size_t num_vertices = model.vertices_site.size();
    model.normals.assign(num_vertices, to_eye);
    model.normals[2] = -to_eye;  // the first triangle is at the outline
    model.fallback.assign(num_vertices, Eigen::Vector3f::Constant(0.5f));
    for (std::size_t c = 0; c < num_cameras; ++c) {
        PersonModel::Camera camera;
        camera.centre_site = eye_site;
        camera.intrinsics.fx = camera.intrinsics.fy = kLayerWidth;
        camera.crop_px = {0, 0, kLayerWidth, kLayerHeight};
        camera.layer_coordinates.assign(num_vertices, {0.5f, 0.5f, 1.0f});
        camera.facing.assign(model.triangles.size(), 1.0f);
        for (const std::size_t num : kCamerasPerTriangle)
            for (std::size_t corner = 0; corner < 3; ++corner)
                camera.quality.push_back(sees(c, corner, num) ? 1.0f : 0.0f);
        model.cameras.push_back(std::move(camera));
    }
    model.layer_width = kLayerWidth;
    model.layer_height = kLayerHeight;
    // nobody, so that all cameras see the outline end
    model.layers.assign(num_cameras * 4 * kLayerWidth * kLayerHeight, 0);
    return model;
}

}  // namespace atrium::renderer
