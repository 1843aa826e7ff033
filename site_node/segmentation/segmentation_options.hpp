#pragma once

namespace atrium::segmentation {

/// Options with one set of defaults for all cameras and rooms. Luma and chroma are full-range
/// bytes. docs/segmentation.md explains each option and its default.
struct SegmentationOptions {
    /// Mahalanobis distance up to which the chroma of a pixel counts as background.
    double max_chroma_distance = 6.0;
    /// Noise floor of chroma (quantisation, compression, few frames), added to the
    /// learned deviation; at least 1.
    double min_chroma_sigma = 1.6;

    /// Smallest fraction of its luma that a surface keeps in shadow; it keeps its hue.
    double darkest_shadow = 0.6;
    /// Like `darkest_shadow`, for surfaces whose colour is strong enough for the hue to distinguish
    /// a shadow from a dark object in front. A value above `darkest_shadow` acts as that.
    double darkest_coloured_shadow = 0.45;
    /// Largest fraction of its luma by which a surface may brighten.
    double max_highlight = 0.1;
    /// Luma noise beyond these limits, in deviations.
    double max_luma_distance = 3.5;
    /// Lower limit of the luma deviation.
    double min_luma_sigma = 2.0;
    /// Luma below which chroma is ignored.
    double dark_luma = 16.0;

    /// Flickering or globally changing light: largest fraction by which the brightness of a picture
    /// is compensated; 0: off.
    double max_gain_change = 0.25;
    /// Drifting light: time constant with which the background model follows the pictures, in
    /// pictures; 0: off.
    double drift_frames = 2000.0;
    /// Largest drift that the model follows, in grey levels of luma; half as far for chroma.
    double max_drift = 40.0;

    /// Decides the pixels at the outline by local colours (outline_refinement.hpp).
    bool refine_outline = true;

    /// Specks of foreground smaller than this are removed; 0 keeps all.
    int min_area_px = 100;
    /// Holes in the foreground smaller than this are filled; 0 keeps all.
    int max_hole_px = 100;
};

}  // namespace atrium::segmentation
