#include "tools/calibrate/up_text.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kDegreesOf1Rad = 57.29578;
constexpr double kAlongAxis_deg = 2.0;

// "0.00, 1.00, 0.00", without negative zeros.
std::string numbers_text(const Eigen::Vector3d& v, int digits, const char* between) {
    const double scale = std::pow(10.0, digits);
    std::string text;
    for (const double x : v)
        text += fmt::format(
            "{}{:.{}f}", text.empty() ? "" : between, std::round(scale * x) / scale + 0.0, digits);
    return text;
}

}  // namespace

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegreesOf1Rad;
}

Eigen::Vector3d nearest_axis(const Eigen::Vector3d& v) {
    int axis = 0;
    v.cwiseAbs().maxCoeff(&axis);
    return (v[axis] > 0.0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(axis);
}

std::string vector_text(const Eigen::Vector3d& v) { return "(" + numbers_text(v, 2, ", ") + ")"; }

std::string direction_text(const Eigen::Vector3d& v) { return numbers_text(v, 3, ","); }

std::string option_text(const Eigen::Vector3d& v) {
    if (degrees_between(v, nearest_axis(v)) > kAlongAxis_deg) return direction_text(v);
    int axis = 0;
    v.cwiseAbs().maxCoeff(&axis);
    return {v[axis] > 0.0 ? '+' : '-', "XYZ"[axis]};
}

std::string enumerated(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    return text;
}

}  // namespace atrium::calibrate
