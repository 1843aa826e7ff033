#include "site_node/segmentation/segmentation.hpp"

#include <string>

namespace atrium::segmentation {

Expected<void> segment(const image::YuvView& frame,
                       const BackgroundModel& model,
                       const SegmentationOptions& options,
                       SegmentationScratch& scratch,
                       image::Mask& out) {
    if (frame.width() != model.width || frame.height() != model.height ||
        frame.u.width != model.width / 2 || frame.u.height != model.height / 2 ||
        frame.v.width != frame.u.width || frame.v.height != frame.u.height) {
        return make_error(ErrorKind::kInvalidData,
                          "picture of " + std::to_string(frame.width()) + "x" +
                              std::to_string(frame.height()) +
                              ", but the empty room was learned at " + std::to_string(model.width) +
                              "x" + std::to_string(model.height));
    }
    if (scratch.raw.width != model.width || scratch.raw.height != model.height) {
        scratch.raw = image::Mask(model.width, model.height);
    }
    test_pixels(frame, model, best_instruction_set(), scratch.pixel_test, scratch.raw);
    majority_3x3(scratch.raw, scratch.clean, out);
    remove_small_parts(out, options.min_area_px, scratch.clean);
    return {};
}

}  // namespace atrium::segmentation
