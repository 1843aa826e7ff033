#pragma once

#include "core/image/image.hpp"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace atrium::flow {

/// Displacement of each pixel of a picture [px].
struct FlowField {
    int width = 0;
    int height = 0;
    std::vector<Eigen::Vector2f> displacement_px;  // rows from the top

    const Eigen::Vector2f& at(int x, int y) const {
        return displacement_px[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(x)];
    }
};

/// Makes OpenCV compute on the calling threads alone, in the whole process. Programs that use
/// DenseFlow call it once: their own pool decides how many threads compute.
void keep_to_calling_threads();

/// Smallest width and height of a picture [px].
constexpr int kMinFlowPx = 96;

/// Finds where each pixel of one picture is in another.
///
/// Kroeger et al., "Fast Optical Flow using Dense Inverse Search", 2016, in OpenCV's fastest
/// preset, but one level finer: about 3 core-ms for eight pictures of 130 x 200. Where nothing has
/// texture, the result is a smooth guess. Keeps its memory while the size stays; one per thread.
class DenseFlow {
public:
    DenseFlow();
    ~DenseFlow();
    DenseFlow(DenseFlow&&) noexcept;
    DenseFlow& operator=(DenseFlow&&) noexcept;

    /// The pixel (x, y) of `from` is at (x, y) + out.at(x, y) in `to`. Both have the same size, of
    /// at least kMinFlowPx each way.
    void compute(const image::Plane& from, const image::Plane& to, FlowField& out);

private:
    struct Search;
    std::unique_ptr<Search> search_;
};

}  // namespace atrium::flow
