#include "bench/scale/viewer_guests.hpp"

#include "core/codec/mesh_codec.hpp"
#include "tests/support/shapes/decode_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace atrium::bench {
namespace {

// Decodes each mesh, changes it by `change`, and codes it again.
template <typename Change>
Expected<void> change_meshes(CodedStream& stream, const Change& change) {
    codec::MeshEncoder encoder;
    std::size_t number = 0;
    for (auto& frame : stream.frames) {
        auto mesh = test::decode_mesh(frame.mesh.draco,
                                      {.max_triangles = 1U << 20U, .max_vertices = 1U << 20U});
        if (!mesh) return tl::unexpected(mesh.error());
        change(number++, *mesh);
        auto size = encoder.encode(*mesh, {.position_bits = 16}, frame.mesh.draco);
        if (!size) return tl::unexpected(size.error());
    }
    return {};
}

void subdivide(geometry::TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [found, is_new] = middles.try_emplace(
            std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
        if (is_new) {
            const Eigen::Vector3d sum = mesh.vertices[a] + mesh.vertices[b];
            mesh.vertices.emplace_back(0.5 * sum);
        }
        return found->second;
    };
    const auto triangles = std::exchange(mesh.triangles, {});
    for (const auto& [a, b, c] : triangles) {
        const std::uint32_t ab = middle(a, b);
        const std::uint32_t bc = middle(b, c);
        const std::uint32_t ca = middle(c, a);
        mesh.triangles.push_back({a, ab, ca});
        mesh.triangles.push_back({ab, b, bc});
        mesh.triangles.push_back({ca, bc, c});
        mesh.triangles.push_back({ab, bc, ca});
    }
}

}  // namespace

void repeat_cameras(std::size_t num_cameras, CodedStream& stream) {
    auto& cameras = stream.description.cameras;
    const std::size_t num_before = cameras.size();
    while (cameras.size() < num_cameras) {
        cameras.push_back(cameras[cameras.size() % num_before]);
        cameras.back().name = fmt::format("again{}", cameras.size());
    }
    for (auto& frame : stream.frames) {
        const std::vector<bus::CameraTexture> textures = frame.textures;
        for (const bus::CameraTexture& texture : textures) {
            for (std::size_t camera = texture.camera + num_before; camera < num_cameras;
                 camera += num_before) {
                frame.textures.push_back(texture);
                frame.textures.back().camera = static_cast<std::uint32_t>(camera);
                frame.mesh.textured_cameras.push_back(static_cast<std::uint32_t>(camera));
            }
        }
    }
}

Expected<void> subdivide_meshes(int times, CodedStream& stream) {
    return change_meshes(stream, [&](std::size_t, geometry::TriangleMesh& mesh) {
        for (int i = 0; i < times; ++i) subdivide(mesh);
    });
}

Expected<void> make_absurd(CodedStream& stream) {
    std::size_t number = 0;
    for (auto& camera : stream.description.cameras) {
        auto& lens = camera.intrinsics;
        switch (number++ % 6) {
            case 0:
                lens.fx = lens.fy = 1e7;
                break;
            case 1:
                lens.fx = 1e-9;
                lens.skew = 1e7;
                break;
            case 2:
                lens.distortion.fill(1e7);
                break;
            case 3:
                camera.camera_from_site.translation = Eigen::Vector3d(0.0, 0.0, 0.1);
                break;
            case 4:
                camera.camera_from_site.translation = Eigen::Vector3d::Constant(1e5);
                break;
            default:
                lens.cx = -1e7;
        }
    }
    return change_meshes(stream, [](std::size_t frame, geometry::TriangleMesh& mesh) {
        constexpr std::array<double, 5> kScales = {1e4, 1e-6, 1.0, 1.0, 30.0};
        for (Eigen::Vector3d& p : mesh.vertices) {
            p *= kScales[frame % kScales.size()];
            if (frame % kScales.size() == 2) p.z() = 0.0;
            if (frame % kScales.size() == 3) p.x() += 9e4;
        }
    });
}

}  // namespace atrium::bench
