#include "site_node/segmentation/segmentation.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

namespace atrium::segmentation {
namespace {

// Stages follow each other in strips of so many rows, so that what one writes is in the cache when
// the next reads it; even.
constexpr int kStripRows = 8;

}  // namespace

Segmenter::Segmenter(BackgroundStatistics room,
                     const SegmentationOptions& options,
                     const SegmentationAreas& areas)
    : options_(options), model_(make_model(std::move(room), options)) {
    if (!areas.everywhere()) areas_ = rasterise(areas, model_.width(), model_.height());
    raw_.resize(static_cast<std::size_t>(kStripRows + 2) *
                static_cast<std::size_t>(model_.width()));
}

Expected<void> Segmenter::segment(const image::YuvView& frame, image::Mask& out) {
    image::WorkingPicture made(frame);
    return segment(made, out);
}

Expected<void> Segmenter::segment(image::WorkingPicture& picture, image::Mask& out) {
    const image::YuvView& frame = picture.view();
    const BackgroundStatistics& room = model_.room;
    if (frame.width() != room.width || frame.height() != room.height ||
        frame.u.width != room.width / 2 || frame.u.height != room.height / 2 ||
        frame.v.width != frame.u.width || frame.v.height != frame.u.height) {
        return make_error(ErrorKind::kInvalidData,
                          "picture of " + std::to_string(frame.width()) + "x" +
                              std::to_string(frame.height()) +
                              ", but the empty room was learned at " + std::to_string(room.width) +
                              "x" + std::to_string(room.height));
    }
    if (frame.mosaic != room.mosaic) {
        return make_error(ErrorKind::kInvalidData,
                          "the empty room was learned from pictures with another colour mosaic");
    }
    if (out.width != room.width || out.height != room.height)
        out = image::Mask(room.width, room.height);
    test_and_clean(picture, out);
    light_.follow(frame, out, options_, model_);
    return {};
}

// `raw_` holds the last two rows of the strip before, then the strip.
void Segmenter::test_and_clean(image::WorkingPicture& picture, image::Mask& out) {
    const InstructionSet instructions = best_instruction_set();
    const std::int16_t inverse_gain = light_.inverse_gain(picture, model_, options_);
    const int width = model_.width();
    const int height = model_.height();
    const auto width_bytes = static_cast<std::size_t>(width);
    start_runs(clean_);
    int next = 0;  // row of `out`
    for (int first = 0; first < height; first += kStripRows) {
        const int end = std::min(first + kStripRows, height);
        const auto raw_row = [&](int y) {
            return raw_.data() + static_cast<std::ptrdiff_t>(y - first + 2) * width;
        };
        picture.make({0, first, width, end - first});
        test_rows(picture.view(), model_, inverse_gain, instructions, {first, end}, raw_row(first));
        for (; next < (end == height ? end : end - 1); ++next) {
            std::uint8_t* row = out.row(next);
            majority_3x3({raw_row(std::max(next - 1, 0)),
                          raw_row(next),
                          raw_row(std::min(next + 1, height - 1)),
                          width},
                         instructions,
                         clean_,
                         row);
            if (!areas_.data.empty()) {
                const std::uint8_t* area = areas_.row(next);
                for (int x = 0; x < width; ++x) row[x] &= area[x];
            }
            add_runs(row, width, clean_);
        }
        std::memcpy(raw_.data(), raw_row(end - 2), 2 * width_bytes);
    }
    remove_small_runs(out, options_.min_area_px, options_.max_hole_px, clean_);
}

}  // namespace atrium::segmentation
