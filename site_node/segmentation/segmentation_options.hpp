#pragma once

namespace atrium::segmentation {

/// Luma and chroma are full-range bytes. The defaults were chosen on recordings of people in lit
/// rooms, 0.3 MP, compressed.
struct SegmentationOptions {
    /// Mahalanobis distance up to which the chroma of a pixel can be background.
    double max_chroma_distance = 6.0;
    /// Least deviation of chroma (quantisation, compression, few frames), added to what was
    /// learned; at least 1.
    double min_chroma_sigma = 1.6;

    /// A surface in shadow keeps at least this part of its luma, and its hue.
    double darkest_shadow = 0.6;
    /// A surface may become brighter by this part of its luma.
    double max_highlight = 0.12;
    /// How far luma may leave these limits by noise, in deviations.
    double max_luma_distance = 4.0;
    /// Least deviation of luma.
    double min_luma_sigma = 2.5;

    /// Smaller specks of foreground, and holes in it, are removed; 0 keeps all.
    int min_area_px = 100;
};

}  // namespace atrium::segmentation
