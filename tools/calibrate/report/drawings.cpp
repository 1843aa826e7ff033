#include "tools/calibrate/report/drawings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

namespace atrium::calibrate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMostPoints = 700;  // dots of one drawing

/// Collects the elements of one drawing.
class Svg {
public:
    Svg(double width, double height, const std::string& title) {
        fmt::format_to(out(),
                       "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\"><title>{}</title>\n",
                       width,
                       height,
                       escaped(title));
    }

    void line(const Vector2d& a, const Vector2d& b, const char* kind) {
        fmt::format_to(out(),
                       "<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" "
                       "y2=\"{:.1f}\"/>",
                       kind,
                       a.x(),
                       a.y(),
                       b.x(),
                       b.y());
    }

    void dot(const Vector2d& at, double radius, const char* kind) {
        fmt::format_to(out(),
                       "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>",
                       kind,
                       at.x(),
                       at.y(),
                       radius);
    }

    void box(const Vector2d& at, const Vector2d& size, const char* kind, double opacity = 1.0) {
        fmt::format_to(out(),
                       "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
                       "height=\"{:.1f}\" fill-opacity=\"{:.2f}\"/>",
                       kind,
                       at.x(),
                       at.y(),
                       size.x(),
                       size.y(),
                       opacity);
    }

    void path(const std::vector<Vector2d>& points, const char* kind, bool is_closed) {
        fmt::format_to(out(), "<path class=\"{}\" d=\"", kind);
        for (std::size_t i = 0; i < points.size(); ++i)
            fmt::format_to(
                out(), "{}{:.1f} {:.1f}", i == 0 ? "M" : "L", points[i].x(), points[i].y());
        fmt::format_to(out(), "{}\"/>", is_closed ? "Z" : "");
    }

    /// `anchor`: "start", "middle" or "end".
    void text(const Vector2d& at, const std::string& text, const char* anchor = "start") {
        fmt::format_to(out(),
                       "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>",
                       at.x(),
                       at.y(),
                       anchor,
                       escaped(text));
    }

    std::string done() { return std::move(svg_) + "</svg>\n"; }

private:
    std::back_insert_iterator<std::string> out() { return std::back_inserter(svg_); }
    std::string svg_;
};

// Every so many of `count` points, so that a drawing stays small.
std::size_t step_of(std::size_t count) {
    return std::max<std::size_t>(
        1, static_cast<std::size_t>(std::ceil(static_cast<double>(count) / kMostPoints)));
}

class RigDrawing {
public:
    RigDrawing(const CalibrationReport& report, double azimuth_deg, double elevation_deg)
        : report_(report) {
        const double a = azimuth_deg * std::numbers::pi / 180.0;
        const double e = elevation_deg * std::numbers::pi / 180.0;
        right_ = Vector3d(std::cos(a), std::sin(a), 0.0);
        up_ = Vector3d(-std::sin(a) * std::sin(e), std::cos(a) * std::sin(e), std::cos(e));
        frame_all();
    }

    std::string draw(const std::string& title) {
        Svg svg(kWidth, height_, title);
        draw_floor(svg);
        const std::size_t step = step_of(report_.seen_site.size());
        for (std::size_t i = 0; i < report_.seen_site.size(); i += step)
            svg.dot(at(report_.seen_site[i]), 1.5, "seen");
        if (report_.previous_rig && report_.comparison) {
            const geometry::RigidTransform new_from_old =
                report_.comparison->old_from_new.inverse();
            for (const geometry::CalibratedCamera& camera : report_.previous_rig->cameras)
                draw_camera(svg,
                            new_from_old * camera.camera_from_site.inverse(),
                            camera.intrinsics,
                            "old");
        }
        for (const ReportedCamera& one : report_.cameras)
            draw_camera(
                svg, one.camera.camera_from_site.inverse(), one.camera.intrinsics, "camera");
        for (const ReportedCamera& one : report_.cameras) draw_name(svg, one.camera);
        return svg.done();
    }

private:
    static constexpr double kWidth = 560.0, kMargin = 70.0, kMostHeight = 520.0;

    Vector2d flat(const Vector3d& point) const { return {right_.dot(point), -up_.dot(point)}; }
    Vector2d at(const Vector3d& point) const {
        return scale_ * (flat(point) - low_) + Vector2d::Constant(kMargin);
    }

    void frame_all() {
        std::vector<Vector3d> points = report_.seen_site;
        Vector3d low = Vector3d::Constant(1e9), high = -low;
        for (const ReportedCamera& one : report_.cameras)
            points.push_back(one.camera.centre_site());
        for (const Vector3d& point : points) {
            low = low.cwiseMin(point);
            high = high.cwiseMax(point);
        }
        if (points.empty()) low = Vector3d::Zero(), high = Vector3d::Ones();
        size_m_ = std::max(0.1, (high - low).norm());
        // a floor far away would make the rig small
        has_floor_ = std::abs(low.z()) < size_m_;
        floor_low_ = {std::floor(low.x()), std::floor(low.y())};
        floor_high_ = {std::ceil(high.x()), std::ceil(high.y())};
        if (has_floor_)
            for (const double x : {floor_low_.x(), floor_high_.x()})
                for (const double y : {floor_low_.y(), floor_high_.y()})
                    points.emplace_back(x, y, 0.0);
        low_ = Vector2d::Constant(1e9);
        Vector2d top = -low_;
        for (const Vector3d& point : points) {
            low_ = low_.cwiseMin(flat(point));
            top = top.cwiseMax(flat(point));
        }
        const Vector2d extent = (top - low_).cwiseMax(0.05 * size_m_);
        scale_ = std::min((kWidth - 2.0 * kMargin) / extent.x(),
                          (kMostHeight - 2.0 * kMargin) / extent.y());
        height_ = scale_ * extent.y() + 2.0 * kMargin;
    }

    void draw_floor(Svg& svg) const {
        if (!has_floor_ || (floor_high_ - floor_low_).maxCoeff() > 100.0) return;
        for (double x = floor_low_.x(); x <= floor_high_.x(); x += 1.0)
            svg.line(at({x, floor_low_.y(), 0.0}), at({x, floor_high_.y(), 0.0}), "floor");
        for (double y = floor_low_.y(); y <= floor_high_.y(); y += 1.0)
            svg.line(at({floor_low_.x(), y, 0.0}), at({floor_high_.x(), y, 0.0}), "floor");
        const Vector3d origin = Vector3d::Zero();
        svg.line(at(origin), at(0.5 * Vector3d::UnitX()), "axis-x");
        svg.line(at(origin), at(0.5 * Vector3d::UnitY()), "axis-y");
        svg.line(at(origin), at(0.5 * Vector3d::UnitZ()), "axis-z");
    }

    void draw_camera(Svg& svg,
                     const geometry::RigidTransform& site_from_camera,
                     const geometry::PinholeCamera& lens,
                     const char* kind) const {
        const double depth = 0.06 * size_m_;
        std::vector<Vector2d> corners;
        for (const auto& [u, v] : {std::array{-0.5, -0.5},
                                   {lens.width - 0.5, -0.5},
                                   {lens.width - 0.5, lens.height - 0.5},
                                   {-0.5, lens.height - 0.5}})
            corners.push_back(at(site_from_camera * (depth * lens.ray_camera({u, v}))));
        const Vector2d centre = at(site_from_camera.translation);
        svg.path(corners, kind, true);
        for (const Vector2d& corner : corners) svg.line(centre, corner, kind);
    }

    // Beside the camera, on the side away from the room's middle.
    void draw_name(Svg& svg, const geometry::CalibratedCamera& camera) const {
        const Vector2d centre = at(camera.centre_site());
        const double outwards = centre.x() < kWidth / 2.0 ? -1.0 : 1.0;
        svg.text({centre.x() + outwards * 9.0, centre.y() - 7.0},
                 camera.name,
                 outwards < 0.0 ? "end" : "start");
    }

    const CalibrationReport& report_;
    Vector3d right_, up_;
    Vector2d low_ = Vector2d::Zero();  // of all that is drawn
    Vector2d floor_low_ = Vector2d::Zero(), floor_high_ = Vector2d::Zero();
    bool has_floor_ = true;
    double size_m_ = 1.0, scale_ = 1.0, height_ = kMostHeight;
};

// The largest of a few round factors at which an arrow of `longest` fits into `room`.
double round_factor(double longest, double room) {
    for (const double factor : {1000.0, 500.0, 200.0, 100.0, 50.0, 20.0, 10.0, 5.0, 2.0})
        if (longest * factor <= room) return factor;
    return 1.0;
}

std::string title_of(double azimuth_deg, double elevation_deg) {
    return elevation_deg > 80.0 ? std::string("the rig from above")
                                : fmt::format("the rig from the side, {:.0f} degrees", azimuth_deg);
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
        }
    }
    return out;
}

std::string draw_rig(const CalibrationReport& report, double azimuth_deg, double elevation_deg) {
    return RigDrawing(report, azimuth_deg, elevation_deg)
        .draw(title_of(azimuth_deg, elevation_deg));
}

std::string draw_picture(const ReportedCamera& camera) {
    constexpr double kDrawnWidth = 520.0;
    constexpr int kColumns = 8, kRows = 6;
    const geometry::PinholeCamera& lens = camera.camera.intrinsics;
    const double scale = kDrawnWidth / std::max(1, lens.width);
    const Vector2d size(kDrawnWidth, scale * lens.height);
    const Vector2d field = size.cwiseQuotient(Vector2d(kColumns, kRows));
    const auto place = [&](const Vector2d& px) {
        return Vector2d(scale * (px + Vector2d::Constant(0.5)));
    };
    std::array<Vector2d, kColumns * kRows> sums;
    sums.fill(Vector2d::Zero());
    std::array<int, kColumns * kRows> counts{};
    for (const PointError& point : camera.errors) {
        if (point.is_outlier) continue;
        const Vector2d at = place(point.px).cwiseQuotient(field);
        const int column = std::clamp(static_cast<int>(at.x()), 0, kColumns - 1);
        const int row = std::clamp(static_cast<int>(at.y()), 0, kRows - 1);
        const auto index = static_cast<std::size_t>(row * kColumns + column);
        sums[index] += point.error_px;
        ++counts[index];
    }
    double longest = 0.0;
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (counts[i] > 0) longest = std::max(longest, sums[i].norm() / counts[i]);
    const double factor = round_factor(longest * scale, 0.6 * field.minCoeff());

    Svg svg(size.x(),
            size.y() + 18.0,
            fmt::format("picture of {}: points and mean errors", camera.camera.name));
    svg.box({0.5, 0.5}, size - Vector2d::Ones(), "picture");
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (counts[i] == 0) continue;
        const Vector2d corner(static_cast<double>(i % kColumns) * field.x(),
                              static_cast<double>(i / kColumns) * field.y());
        svg.box(corner, field, "covered", std::min(0.45, 0.12 + 0.01 * counts[i]));
    }
    const std::size_t step = step_of(camera.errors.size());
    for (std::size_t i = 0; i < camera.errors.size(); i += step)
        if (!camera.errors[i].is_outlier) svg.dot(place(camera.errors[i].px), 0.9, "point");
    // outliers are few and are what one looks for
    std::size_t num_outliers = 0;
    for (const PointError& point : camera.errors)
        if (point.is_outlier && ++num_outliers <= static_cast<std::size_t>(kMostPoints))
            svg.dot(place(point.px), 2.0, "outlier");
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (counts[i] == 0) continue;
        const Vector2d middle((static_cast<double>(i % kColumns) + 0.5) * field.x(),
                              (static_cast<double>(i / kColumns) + 0.5) * field.y());
        svg.line(middle, middle + factor * scale / counts[i] * sums[i], "error");
        svg.dot(middle, 1.8, "error-foot");
    }
    svg.text({2.0, size.y() + 13.0},
             fmt::format("errors drawn {:.0f} times as long as they are", factor));
    return svg.done();
}

std::string draw_distortion(const geometry::PinholeCamera& lens,
                            const geometry::PinholeCamera* before) {
    constexpr double kDrawnWidth = 260.0, kDrawnHeight = 150.0, kLeft = 46.0, kBottom = 24.0;
    constexpr int kSteps = 40;
    // to the corner that is furthest from the principal point
    const Vector2d centre(lens.cx, lens.cy);
    const Vector2d corner(lens.cx > 0.5 * lens.width ? -0.5 : lens.width - 0.5,
                          lens.cy > 0.5 * lens.height ? -0.5 : lens.height - 0.5);
    const double furthest = std::max(1.0, (corner - centre).norm());
    const auto curve = [&](const geometry::PinholeCamera& of) {
        const Vector2d from(of.cx, of.cy);
        std::vector<Vector2d> points;
        for (int i = 0; i <= kSteps; ++i) {
            const double r = furthest * i / kSteps;
            const Vector2d px = from + r * (corner - centre) / furthest;
            points.emplace_back(r, (of.distort(px) - from).norm() - r);
        }
        return points;
    };
    const std::vector<Vector2d> now = curve(lens);
    const std::vector<Vector2d> then = before != nullptr ? curve(*before) : std::vector<Vector2d>();
    double least = 0.0, most = 0.0;
    for (const auto* points : {&now, &then})
        for (const Vector2d& point : *points) {
            least = std::min(least, point.y());
            most = std::max(most, point.y());
        }
    if (most - least < 0.1) most = least + 0.1;
    const auto place = [&](const Vector2d& point) {
        return Vector2d(kLeft + (kDrawnWidth - kLeft - 8.0) * point.x() / furthest,
                        8.0 + (kDrawnHeight - 8.0 - kBottom) * (most - point.y()) / (most - least));
    };
    Svg svg(kDrawnWidth, kDrawnHeight, "distortion over the distance from the principal point");
    svg.line(place({0.0, 0.0}), place({furthest, 0.0}), "scale");
    svg.line(place({0.0, least}), place({0.0, most}), "scale");
    const auto draw = [&](const std::vector<Vector2d>& points, const char* kind) {
        std::vector<Vector2d> placed;
        for (const Vector2d& point : points) placed.push_back(place(point));
        if (!placed.empty()) svg.path(placed, kind, false);
    };
    draw(then, "curve-old");
    draw(now, "curve");
    svg.text({kLeft - 4.0, 14.0}, fmt::format("{:.1f} px", most), "end");
    svg.text({kLeft - 4.0, kDrawnHeight - kBottom}, fmt::format("{:.1f} px", least), "end");
    svg.text({kDrawnWidth - 8.0, kDrawnHeight - 6.0},
             fmt::format("{:.0f} px from the principal point", furthest),
             "end");
    return svg.done();
}

}  // namespace atrium::calibrate
