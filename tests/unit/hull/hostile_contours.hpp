#pragma once

#include "tests/support/shapes/polygons.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace atrium::test {

using Point = Eigen::Vector2d;

/// Contours of about 20 px that cross and touch themselves and each other. They depend only on the
/// seed.
class HostileContours {
public:
    explicit HostileContours(std::uint32_t seed) : random_(seed) {}

    Contours make() {
        switch (index(7)) {
            case 0:
                return several(1, 3, [&] { return on_lattice(3 + index(10), 4 + index(5)); });
            case 1:
                return several(1, 2, [&] { return spiky_blob(); });
            case 2:
                return several(1, 4, [&] { return figure_eight(); });
            case 3:
                return several(2, 4, [&] { return star(); });
            case 4:
                return tiles();
            case 5:
                return nested();
            default:
                return noisy();
        }
    }
    int index(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }

private:
    template <typename Make>
    Contours several(int least, int most, Make make) {
        Contours contours(static_cast<std::size_t>(least + index(most - least + 1)));
        for (Contour& contour : contours) contour = make();
        return contours;
    }
    // vertices on vertices, vertices on edges, and edges along edges
    Contour on_lattice(int num_points, int size) {
        Contour contour;
        for (int i = 0; i < num_points; ++i) contour.emplace_back(index(size), index(size));
        return contour;
    }
    Contour spiky_blob() {
        Contour contour;
        const Point centre(uniform(0, 5), uniform(0, 5));
        for (int i = 0; i < 20; ++i) {
            const double angle = i * std::numbers::pi / 10.0;
            const Point p = centre + 6.0 * Point(std::cos(angle), std::sin(angle));
            contour.push_back(p);
            if (index(4) == 0) {
                contour.emplace_back(uniform(-10, 10), uniform(-10, 10));
                if (index(2) == 0) contour.push_back(p);
            }
        }
        return contour;
    }
    Contour figure_eight() {
        const double x = index(8);
        const double y = index(8);
        return {{x, y}, {x + 4, y + 4}, {x + 4, y}, {x, y + 4}};
    }
    Contour star() {
        const int n = 5 + 2 * index(4);
        const int step = 2 + index(n / 2 - 1);
        Contour contour;
        const Point centre(index(6), index(6));
        for (int i = 0; i < n; ++i) {
            const double angle = 2.0 * std::numbers::pi * i * step / n;
            contour.push_back(centre + 5.0 * Point(std::cos(angle), std::sin(angle)));
        }
        return contour;
    }
    // some identical, most side by side
    Contours tiles() {
        return several(2, 8, [&]() -> Contour {
            const double x = index(4);
            const double y = index(4);
            const double w = 1 + index(3);
            const double h = 1 + index(3);
            return {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}};
        });
    }
    Contours nested() {
        Contours contours;
        for (int i = 0; i < 5; ++i) {
            Contour ring;
            for (int k = 0; k < 12; ++k) {
                const double angle = k * std::numbers::pi / 6.0;
                const double radius = 10.0 - 2.0 * i + (index(3) == 0 ? 2.0 : 0.0);
                ring.push_back(radius * Point(std::cos(angle), std::sin(angle)));
            }
            contours.push_back(ring);
        }
        return contours;
    }
    Contours noisy() {
        Contour contour;
        for (int i = 0; i < 150; ++i) {
            const double angle = i * std::numbers::pi / 75.0;
            contour.push_back(10.0 * Point(std::cos(angle), std::sin(angle)) +
                              Point(uniform(-0.4, 0.4), uniform(-0.4, 0.4)));
        }
        return {contour};
    }

    std::mt19937 random_;
};

}  // namespace atrium::test
