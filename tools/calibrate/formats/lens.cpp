#include "tools/calibrate/formats/lens.hpp"

#include "tools/calibrate/formats/lens_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace atrium::calibrate {
namespace {

// A silhouette is uncertain by about a pixel anyway; a fit should not add to it.
constexpr double kMaxFitError_px = 1.0;
constexpr double kMaxFitErrorOfWidth = 0.002;  // 1.3 px of 640: what silhouettes are good for
constexpr double kFitWorthANote_px = 0.05;

bool is_in(double value, double low, double high) { return value >= low && value <= high; }

Expected<void> set_matrix(geometry::PinholeCamera& k, const LensNumbers& lens, const Error& error) {
    const std::vector<double>& m = lens.matrix;
    if (m.size() == 4) {
        k.fx = m[0];
        k.fy = m[1];
        k.cx = m[2];
        k.cy = m[3];
    } else if (m.size() == 9) {
        k.fx = m[0];
        k.skew = m[1];
        k.cx = m[2];
        k.fy = m[4];
        k.cy = m[5];
    } else {
        return tl::unexpected(error);
    }
    k.cx -= lens.pixel_centre;
    k.cy -= lens.pixel_centre;
    const bool is_sane = is_in(k.fx, 1e-3, 1e6) && is_in(k.fy, 1e-3, 1e6) &&
                         is_in(k.cx, -1e6, 1e6) && is_in(k.cy, -1e6, 1e6) &&
                         is_in(k.skew, -1e4, 1e4);
    if (!is_sane) return tl::unexpected(error);
    return {};
}

}  // namespace

bool is_fisheye(std::string model) {
    std::ranges::transform(model, model.begin(), [](unsigned char c) { return std::tolower(c); });
    return model == "fisheye" || model == "equidistant" || model == "kannala_brandt" ||
           model == "equi";
}

Expected<void> accept_fit(ForeignCamera& camera,
                          const std::array<double, 5>& distortion,
                          double error_px,
                          const std::string& model,
                          const std::string& where,
                          std::vector<std::string>& notes) {
    const double most_px = std::max(kMaxFitError_px, kMaxFitErrorOfWidth * camera.lens.width);
    if (!(error_px <= most_px)) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: camera '{}': its lens model ({}) differs by up to {:.3g} px from the "
                        "nearest one that Atrium knows (k1, k2, p1, p2, k3); calibrate with that "
                        "model, or undistort the pictures",
                        where,
                        camera.name,
                        model,
                        error_px));
    }
    camera.lens.distortion = distortion;
    if (error_px > kFitWorthANote_px) {
        notes.push_back(
            fmt::format("camera '{}': its lens model ({}) was fitted, with an error of "
                        "up to {:.2f} px in the picture{}",
                        camera.name,
                        model,
                        error_px,
                        error_px > kMaxFitError_px
                            ? ": people near its border lose a rim of that width; undistort the "
                              "pictures if that is too much"
                            : ""));
    }
    return {};
}

Expected<void> set_lens(ForeignCamera& camera,
                        const LensNumbers& lens,
                        const std::string& where,
                        std::vector<std::string>& notes) {
    geometry::PinholeCamera& k = camera.lens;
    const auto wrong = [&](const std::string& what) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: camera '{}': {}", where, camera.name, what));
    };
    const std::size_t num = lens.matrix.size();
    const auto bad_matrix = wrong(fmt::format(
        "its camera matrix must be 9 numbers (fx s cx, 0 fy cy, 0 0 1) or fx, fy, cx, cy in "
        "pixels, with focal lengths above 0{}",
        (num > 4 && num < 9) || num > 9 ? kCommaMakesTwo : ""));
    if (auto set = set_matrix(k, lens, bad_matrix.value()); !set) return set;
    if (!lens.size.empty()) {
        if (lens.size.size() != 2 || !is_in(lens.size[0], 16, 8192) ||
            !is_in(lens.size[1], 16, 8192))
            return wrong(
                fmt::format("its picture size must be width and height, 16 to 8192 px each{}",
                            lens.size.size() > 2 ? kCommaMakesTwo : ""));
        k.width = static_cast<int>(std::lround(lens.size[0]));
        k.height = static_cast<int>(std::lround(lens.size[1]));
    }
    camera.has_lens = true;
    const bool fisheye = is_fisheye(lens.model);
    const auto is_zero = [](double value) { return value == 0.0; };
    const std::vector<double>& d = lens.distortion;
    const bool has_count_of_model =
        fisheye ? d.size() <= 4 || std::all_of(d.begin() + 4, d.end(), is_zero)
                : d.size() <= 5 || d.size() == 8 || d.size() == 12 || d.size() >= 14;
    if (!has_count_of_model) {
        return wrong(fmt::format("its distortion has {} numbers, but must have {}{}",
                                 d.size(),
                                 fisheye ? "4" : "4, 5, 8, 12 or 14",
                                 kCommaMakesTwo));
    }
    if (d.size() > 12 && !std::all_of(d.begin() + 12, d.end(), is_zero))
        return wrong("a tilted sensor (tau x, tau y) is not supported; calibrate without it");
    const bool is_brown =
        !fisheye && (d.size() <= 5 || std::all_of(d.begin() + 5, d.end(), is_zero));
    if (is_brown) {
        std::copy_n(d.begin(), std::min<std::size_t>(d.size(), 5), k.distortion.begin());
        if (!std::ranges::all_of(k.distortion, [](double c) { return is_in(c, -100, 100); }))
            return wrong(
                "its distortion must be within -100 to 100; check the order of the values");
        return {};
    }
    geometry::PinholeCamera whole = k;  // if the size is unknown, about twice the principal point
    if (k.width == 0) whole.width = static_cast<int>(2.0 * std::clamp(k.cx, 8.0, 4096.0));
    if (k.height == 0) whole.height = static_cast<int>(2.0 * std::clamp(k.cy, 8.0, 4096.0));
    const LensFit fit = fit_lens(whole, fisheye ? equidistant_lens(d) : rational_lens(d));
    return accept_fit(camera,
                      fit.distortion,
                      fit.error_px,
                      fisheye ? "fisheye" : "rational, thin prism",
                      where,
                      notes);
}

}  // namespace atrium::calibrate
