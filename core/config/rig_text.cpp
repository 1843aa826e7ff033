#include "core/config/rig_text.hpp"

#include <fmt/format.h>

#include <iterator>

namespace atrium::config {

std::string rig_text(const Rig& rig, const std::vector<std::string>& comments) {
    std::string text;
    auto out = std::back_inserter(text);
    for (const std::string& comment : comments) {
        std::string line = comment;
        for (char& c : line)
            if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
        fmt::format_to(out, "# {}\n", line);
    }
    fmt::format_to(out, "units = \"m\"\nrate_hz = {}\n", rig.rate_hz);
    if (rig.bounds_site.size().minCoeff() > 0.0) {
        const auto& [min, max] = rig.bounds_site;
        fmt::format_to(out,
                       "\n[bounds]\nmin = [{}, {}, {}]\nmax = [{}, {}, {}]\n",
                       min.x(),
                       min.y(),
                       min.z(),
                       max.x(),
                       max.y(),
                       max.z());
    }
    for (const auto& camera : rig.cameras) {
        const geometry::PinholeCamera& k = camera.intrinsics;
        fmt::format_to(out,
                       "\n[[camera]]\nname = \"{}\"\nwidth = {}\nheight = {}\n",
                       camera.name,
                       k.width,
                       k.height);
        fmt::format_to(out, "fx = {}\nfy = {}\ncx = {}\ncy = {}\n", k.fx, k.fy, k.cx, k.cy);
        if (k.skew != 0.0) fmt::format_to(out, "skew = {}\n", k.skew);
        const auto& d = k.distortion;
        fmt::format_to(out, "distortion = [{}, {}, {}, {}, {}]\n", d[0], d[1], d[2], d[3], d[4]);
        const Eigen::Matrix3d r = camera.camera_from_site.rotation.toRotationMatrix();
        fmt::format_to(out, "rotation = [");
        for (int i = 0; i < 9; ++i)
            fmt::format_to(out, "{}{}", i == 0 ? "" : ", ", r(i / 3, i % 3));
        const Eigen::Vector3d& t = camera.camera_from_site.translation;
        fmt::format_to(out, "]  # camera_from_site, row-major\n");
        fmt::format_to(
            out, "translation = [{}, {}, {}]  # camera_from_site\n", t.x(), t.y(), t.z());
    }
    return text;
}

}  // namespace atrium::config
