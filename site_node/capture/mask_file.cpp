#include "site_node/capture/mask_file.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>

namespace atrium::capture {

std::filesystem::path numbered_png(const std::filesystem::path& folder, std::size_t number) {
    return folder / fmt::format("{:06d}.png", number);
}

Expected<void> write_mask(const image::Mask& mask, const std::filesystem::path& file) {
    // OpenCV only reads the data
    const cv::Mat picture(
        mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.data.data()));
    bool written = false;
    try {
        written = cv::imwrite(file.string(), picture);
    } catch (const cv::Exception&) {
        written = false;
    }
    if (!written) return make_error(ErrorKind::kUnavailable, file.string() + ": cannot write");
    return {};
}

bool looks_inverted(const image::Mask& mask) {
    constexpr double kMost = 0.5;
    constexpr double kNearlyAll = 0.9;
    const int last_x = mask.width - 1;
    const int last_y = mask.height - 1;
    int border = 0;
    for (int x = 0; x <= last_x; ++x)
        border += (mask.row(0)[x] != 0 ? 1 : 0) + (mask.row(last_y)[x] != 0 ? 1 : 0);
    for (int y = 0; y <= last_y; ++y)
        border += (mask.row(y)[0] != 0 ? 1 : 0) + (mask.row(y)[last_x] != 0 ? 1 : 0);
    const auto num = std::count(mask.data.begin(), mask.data.end(), std::uint8_t{255});
    return border > kNearlyAll * 2 * (mask.width + mask.height) &&
           static_cast<double>(num) > kMost * static_cast<double>(mask.data.size());
}

}  // namespace atrium::capture
