#pragma once

namespace atrium::segmentation {

/// Luma and chroma are full-range bytes. One set of defaults for all cameras and rooms; what each
/// is for, and what it was chosen by: docs/segmentation.md.
struct SegmentationOptions {
    /// Mahalanobis distance up to which the chroma of a pixel can be background.
    double max_chroma_distance = 6.0;
    /// Least deviation of chroma (quantisation, compression, few frames), added to what was
    /// learned; at least 1.
    double min_chroma_sigma = 1.6;

    /// A surface in shadow keeps at least this part of its luma, and its hue.
    double darkest_shadow = 0.6;
    /// The same where the surface's own colour is so strong that the hue alone tells its shadow
    /// from a dark thing in front of it; not above `darkest_shadow`.
    double darkest_coloured_shadow = 0.45;
    /// A surface may become brighter by this part of its luma.
    double max_highlight = 0.1;
    /// How far luma may leave these limits by noise, in deviations.
    double max_luma_distance = 3.5;
    /// Least deviation of luma.
    double min_luma_sigma = 2.0;
    /// Below this luma chroma means nothing and does not vote.
    double dark_luma = 16.0;

    /// Light that flickers or changes as a whole: each picture is compared at a brightness changed
    /// by up to this part; 0: as it is.
    double max_gain_change = 0.25;
    /// Light that drifts: the learned room follows the pictures with this time constant, in
    /// pictures; 0: it stays as learned.
    double drift_frames = 2000.0;
    /// How far it may follow, in grey levels of luma; chroma half as far.
    double max_drift = 40.0;

    /// Smaller specks of foreground are removed; 0 keeps all.
    int min_area_px = 100;
    /// Smaller holes in it are filled; 0 keeps all.
    int max_hole_px = 100;
};

}  // namespace atrium::segmentation
