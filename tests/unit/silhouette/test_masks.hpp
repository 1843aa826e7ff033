#pragma once

#include "core/image/image.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::silhouette::test {

struct Capsule {
    double x0, y0, x1, y1, radius;
};

/// Draws all points within `radius` of a segment. `radius_noise_px` roughens the outline.
inline void draw(image::Mask& mask, const Capsule& c, std::uint8_t value = 255) {
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            const double dx = c.x1 - c.x0;
            const double dy = c.y1 - c.y0;
            const double length_sq = std::max(dx * dx + dy * dy, 1e-12);
            const double t = std::clamp(((x - c.x0) * dx + (y - c.y0) * dy) / length_sq, 0.0, 1.0);
            if (std::hypot(x - c.x0 - t * dx, y - c.y0 - t * dy) <= c.radius)
                mask.row(y)[x] = value;
        }
    }
}

/// A standing figure of about 130,000 pixels in a picture of 1 MP. One hand is on the hip, which
/// leaves a hole.
inline image::Mask person_mask() {
    image::Mask mask(1000, 1000);
    for (const Capsule& c : {Capsule{500, 180, 500, 190, 48},  // head
                             Capsule{500, 280, 505, 480, 75},  // trunk
                             Capsule{470, 500, 440, 850, 38},  // legs
                             Capsule{540, 500, 570, 850, 38},
                             Capsule{435, 270, 330, 400, 24},  // left arm, hand on hip
                             Capsule{330, 400, 440, 470, 22},
                             Capsule{570, 270, 690, 380, 24},  // right arm, stretched out
                             Capsule{690, 380, 700, 260, 20}}) {
        draw(mask, c);
    }
    return mask;
}

/// Flips each pixel next to the border between foreground and background with probability `p`.
inline void roughen(image::Mask& mask, double p, std::mt19937& random) {
    const image::Mask before = mask;
    std::bernoulli_distribution flip(p);
    for (int y = 1; y + 1 < mask.height; ++y) {
        for (int x = 1; x + 1 < mask.width; ++x) {
            const std::uint8_t here = before.at(x, y);
            const bool border = before.at(x - 1, y) != here || before.at(x + 1, y) != here ||
                                before.at(x, y - 1) != here || before.at(x, y + 1) != here;
            if (border && flip(random)) mask.row(y)[x] = here ? 0 : 255;
        }
    }
}

inline image::Mask noise_mask(int width, int height, double density, unsigned seed) {
    std::mt19937 random(seed);
    std::bernoulli_distribution on(density);
    image::Mask mask(width, height);
    for (std::uint8_t& value : mask.data) value = on(random) ? 255 : 0;
    return mask;
}

inline std::int64_t num_foreground(const image::Mask& mask) {
    return std::count(mask.data.begin(), mask.data.end(), 255);
}

}  // namespace atrium::silhouette::test
