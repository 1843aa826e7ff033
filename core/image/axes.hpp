#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace atrium::image {

/// Structure of arrays of three-component vectors.
struct Axes {
    std::vector<float> x, y, z;

    void resize(std::size_t size) {
        x.resize(size);
        y.resize(size);
        z.resize(size);
    }
    std::size_t size() const { return x.size(); }
};

inline void set(Axes& axes, std::size_t i, const Eigen::Vector3f& value) {
    axes.x[i] = value.x();
    axes.y[i] = value.y();
    axes.z[i] = value.z();
}

}  // namespace atrium::image
