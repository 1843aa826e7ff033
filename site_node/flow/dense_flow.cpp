#include "site_node/flow/dense_flow.hpp"

#include <opencv2/video/tracking.hpp>

#include <cassert>
#include <cstring>

namespace atrium::flow {
namespace {

// The preset's finest scale is 2. One level finer more than halves the error of limbs at 2 to 3 m/s
// and doubles the cost.
constexpr int kFinestScale = 1;

// Only read.
cv::Mat view_of(const image::Plane& plane) {
    return {plane.height, plane.width, CV_8U, const_cast<std::uint8_t*>(plane.data.data())};
}

}  // namespace

struct DenseFlow::Search {
    cv::Ptr<cv::DISOpticalFlow> dis;
    cv::Mat flow;
    int width = 0;  // of the pictures that `dis` has seen
    int height = 0;
};

void keep_to_calling_threads() { cv::setNumThreads(1); }

DenseFlow::DenseFlow() : search_(std::make_unique<Search>()) {}
DenseFlow::~DenseFlow() = default;
DenseFlow::DenseFlow(DenseFlow&&) noexcept = default;
DenseFlow& DenseFlow::operator=(DenseFlow&&) noexcept = default;

void DenseFlow::compute(const image::Plane& from, const image::Plane& to, FlowField& out) {
    assert(from.width >= kMinFlowPx && from.height >= kMinFlowPx);
    assert(from.width == to.width && from.height == to.height);
    if (search_->width != from.width || search_->height != from.height) {
        // OpenCV 4.6 crashes when an instance gets another size (opencv_contrib#1476)
        search_->dis = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST);
        search_->dis->setFinestScale(kFinestScale);
        search_->width = from.width;
        search_->height = from.height;
    }
    // a result that is not empty would be the start of the search
    search_->flow.release();
    search_->dis->calc(view_of(from), view_of(to), search_->flow);
    out.width = from.width;
    out.height = from.height;
    out.displacement_px.resize(from.data.size());
    static_assert(sizeof(Eigen::Vector2f) == 2 * sizeof(float));
    const auto row_bytes = static_cast<std::size_t>(from.width) * sizeof(Eigen::Vector2f);
    for (int y = 0; y < from.height; ++y) {
        std::memcpy(static_cast<void*>(out.displacement_px.data() +
                                       static_cast<std::ptrdiff_t>(y) * from.width),
                    search_->flow.ptr(y),
                    row_bytes);
    }
}

}  // namespace atrium::flow
