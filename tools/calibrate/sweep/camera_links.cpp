#include "tools/calibrate/sweep/camera_links.hpp"

namespace atrium::calibrate {

void CameraLinks::count(const std::vector<std::size_t>& cameras) {
    for (const std::size_t a : cameras)
        for (const std::size_t b : cameras) ++shared_[a * num_cameras_ + b];
}

std::vector<std::size_t> CameraLinks::unlinked(std::size_t least) const {
    std::size_t first = 0;
    for (std::size_t c = 1; c < num_cameras_; ++c)
        if (shared(c, c) > shared(first, first)) first = c;
    std::vector<std::size_t> open{first};
    std::vector<bool> is_linked(num_cameras_, false);
    is_linked[first] = true;
    while (!open.empty()) {
        const std::size_t a = open.back();
        open.pop_back();
        for (std::size_t b = 0; b < num_cameras_; ++b) {
            if (is_linked[b] || shared(a, b) < least) continue;
            is_linked[b] = true;
            open.push_back(b);
        }
    }
    std::vector<std::size_t> apart;
    for (std::size_t c = 0; c < num_cameras_; ++c)
        if (!is_linked[c]) apart.push_back(c);
    return apart;
}

}  // namespace atrium::calibrate
