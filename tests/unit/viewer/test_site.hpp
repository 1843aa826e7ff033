#pragma once

#include "core/bus/messages.hpp"

#include <string>

namespace atrium::viewer::test_site {

/// A site with a person of one colour: a sphere of 0.4 m at (0, 0, 1.2), seen by four cameras.
bus::SiteDescription description(const std::string& site);

struct Frame {
    bus::SiteMesh mesh;
    std::vector<bus::CameraTexture> textures;
};
/// `luma` in [0, 255] is the grey of the person.
Frame frame(const std::string& site, std::uint64_t frame_id, std::uint8_t luma);

}  // namespace atrium::viewer::test_site
