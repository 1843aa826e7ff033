#pragma once

#include "core/base/expected.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace atrium::golden {

inline constexpr int kWidth = 320;
inline constexpr int kHeight = 180;

/// The content of a golden picture, and its view.
struct Scene {
    std::string name;  // of the picture's file
    std::vector<renderer::EyeView> eyes;
    std::function<void(renderer::SceneRenderer&)> fill;
};

inline std::ostream& operator<<(std::ostream& out, const Scene& scene) { return out << scene.name; }

/// One for each kind of object that the renderer draws.
std::vector<Scene> all_scenes();

/// The objects of the scene "shapes", by their numbers.
std::map<std::uint32_t, renderer::ObjectLook> shapes();
renderer::ViewCamera shapes_camera();

/// Draws the scene in the current context.
Expected<renderer::RenderedPicture> draw(const Scene& scene);

}  // namespace atrium::golden
