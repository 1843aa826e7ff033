#include "tools/calibrate/up_text.hpp"

#include "tools/calibrate/judge/angles.hpp"

#include <fmt/format.h>

#include <cmath>

namespace atrium::calibrate {
namespace {

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
