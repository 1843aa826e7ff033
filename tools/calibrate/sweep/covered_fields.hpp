#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace atrium::calibrate {

/// Which parts of a camera's picture have shown something, as 8 x 8 fields.
class CoveredFields {
public:
    CoveredFields(int width, int height) : width_(width), height_(height) {}

    /// Marks the field of a point [px].
    void cover(const Eigen::Vector2d& px);

    bool is_covered(const Eigen::Vector2d& px) const;

    /// Of all fields, 0 to 1.
    double share() const;

    /// The part of the picture in which least is covered: "lower left".
    const char* emptiest_part() const;

    /// The corners of each covered field [px].
    std::vector<std::vector<Eigen::Vector2d>> outlines_px() const;

private:
    static constexpr int kFields = 8;
    std::size_t field_of(const Eigen::Vector2d& px) const;
    bool at(int x, int y) const { return covered_[static_cast<std::size_t>(y * kFields + x)]; }

    int width_, height_;
    std::array<bool, static_cast<std::size_t>(kFields* kFields)> covered_{};
};

}  // namespace atrium::calibrate
