#pragma once

#include "viewer/renderer/scene_renderer.hpp"

#include <cstdint>
#include <vector>

namespace atrium::golden {

/// How different two pictures are to the eye: the distance of their colours in CIE Lab (CIE 1976),
/// where 2.3 is about what is just noticed, in each pixel. Both are blurred first (Gaussian, sigma
/// 1 px): one pixel of an edge that falls to the other side is not seen on a screen.
///
/// Mahy, Van Eycken, Oosterlinck. Evaluation of Uniform Color Spaces Developed after the Adoption
/// of CIELAB and CIELUV. Color Research and Application 19(2), 1994: the 2.3.
struct PictureDifference {
    double mean = 0.0;
    double percentile_99_9 = 0.0;  // 58 of the 57,600 pixels of a golden picture differ by more
    double share_over_5 = 0.0;     // of the pixels, in [0, 1]: whoever looks for it sees it
    std::vector<float> per_pixel;  // rows from the top
};

/// Both of one size.
PictureDifference picture_difference(const renderer::RenderedPicture& a,
                                     const renderer::RenderedPicture& b);

/// The same picture, drawn by the same kind of driver: its code is made for the processor at hand,
/// and rounds accordingly, by a grey level or an edge's pixel here and there.
///
/// Mean: noise of one grey level is 0.25, and all of the picture one level lighter 0.4; two levels
/// are too many. Percentile: what is larger than 8 x 8 px must not differ by what is just noticed.
/// Share: 28 pixels, some places along edges.
struct Limits {
    double mean = 0.5;
    double percentile_99_9 = 2.3;
    double share_over_5 = 0.0005;
};

bool is_within(const PictureDifference& difference, const Limits& limits = {});

/// Of `per_pixel`: black where nothing differs, white from 10 on.
renderer::RenderedPicture as_picture(const PictureDifference& difference, int width);

}  // namespace atrium::golden
