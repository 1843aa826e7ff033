#include "tools/calibrate/formats/rig_file.hpp"

#include "core/base/write_check.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <iterator>

namespace atrium::calibrate {

std::string rig_text(const config::Rig& rig, const std::vector<std::string>& comments) {
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

bool is_rig(const Tree& toml) {
    const Tree* cameras = find(toml, {"camera"});
    return cameras != nullptr && cameras->is_array();
}

bool is_rig_file(const std::filesystem::path& file) {
    if (file.extension() != ".toml") return false;
    const auto text = read_bytes(file, kMaxTextBytes);
    const auto tree = text ? parse_toml(*text, file.string()) : Expected<Tree>(Tree());
    return tree && is_rig(*tree);
}

Expected<void> write_text(const std::filesystem::path& file,
                          const std::string& text,
                          bool may_replace) {
    std::error_code failure;
    if (!may_replace && std::filesystem::exists(file, failure)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: exists already; give another -o, or --force to replace "
                                      "it",
                                      file.string()));
    }
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (!std::filesystem::exists(file, failure)) {
        if (auto writable = check_folder_writable(folder, text.size(), "-o"); !writable)
            return writable;
    }
    std::filesystem::create_directories(folder, failure);
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream << text;
    stream.close();
    if (stream) return {};
    return tl::unexpected(cannot_write(file, "write", errno));
}

}  // namespace atrium::calibrate
