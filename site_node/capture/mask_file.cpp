#include "site_node/capture/mask_file.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

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

}  // namespace atrium::capture
