#pragma once

#include "viewer/renderer/scene_renderer.hpp"

#include <cstdint>
#include <vector>

namespace atrium::golden {

/// Visible difference of two pictures: the distance of their colours in CIE Lab (CIE 1976) in each
/// pixel, where 2.3 is just noticeable. Both are blurred first (Gaussian, sigma 1 px), because one
/// pixel of an edge that moves to the other side is invisible on a screen.
///
/// Mahy, Van Eycken, Oosterlinck. Evaluation of Uniform Color Spaces Developed after the Adoption
/// of CIELAB and CIELUV. Color Research and Application 19(2), 1994: the 2.3.
struct PictureDifference {
    double mean = 0.0;
    double percentile_99_9 = 0.0;  // 58 of the 57,600 pixels of a golden picture differ by more
    double share_over_5 = 0.0;     // of the pixels, in [0, 1]; visible on close inspection
    std::vector<float> per_pixel;  // rows from the top
};

/// Both must have the same size.
PictureDifference picture_difference(const renderer::RenderedPicture& a,
                                     const renderer::RenderedPicture& b);

/// Limits for the same picture from the same kind of driver. The driver generates code for the
/// processor, whose rounding changes a grey level or an edge pixel here and there.
///
/// Mean: noise of one grey level is 0.25, and a picture lighter by one level 0.4. Two levels are
/// too many. Percentile: an area above 8 x 8 px must not differ noticeably. Share: 28 pixels, some
/// places along edges.
struct Limits {
    double mean = 0.5;
    double percentile_99_9 = 2.3;
    double share_over_5 = 0.0005;
};

bool is_within(const PictureDifference& difference, const Limits& limits = {});

/// Picture of `per_pixel`: black without a difference, white from 10 on.
renderer::RenderedPicture as_picture(const PictureDifference& difference, int width);

}  // namespace atrium::golden
