#include "tools/calibrate/sweep/sweep_preview.hpp"

#include <fmt/format.h>

namespace atrium::calibrate {
namespace {

constexpr double kBrightness = 2.0;  // the room is dark

// The corners of the covered fields [px].
std::vector<std::vector<Eigen::Vector2d>> outlines_of(const CoveredFields& covered,
                                                      const image::RawImage& image) {
    std::vector<std::vector<Eigen::Vector2d>> outlines;
    const auto corner = [&](int x, int y) {
        return Eigen::Vector2d(static_cast<double>(x) * image.width / kFields - 0.5,
                               static_cast<double>(y) * image.height / kFields - 0.5);
    };
    for (int y = 0; y < kFields; ++y)
        for (int x = 0; x < kFields; ++x)
            if (covered[static_cast<std::size_t>(y * kFields + x)])
                outlines.push_back(
                    {corner(x, y), corner(x, y + 1), corner(x + 1, y + 1), corner(x + 1, y)});
    return outlines;
}

}  // namespace

std::vector<preview::View> views_of(const capture::Metaframe& instant, const SweepTally& tally) {
    std::vector<preview::View> views;
    for (std::size_t c = 0; c < instant.frames.size(); ++c) {
        const CameraTally& seen = tally.cameras()[c];
        preview::View& view = views.emplace_back();
        view.name = tally.name(c);
        view.image = instant.frames[c].image;
        view.brightness = kBrightness;
        const std::string need = tally.need_of(c);
        view.caption =
            fmt::format("{}  {}",
                        view.name,
                        need.empty() ? fmt::format("enough: {}", seen.num_instants) : need);
        if (view.image.empty()) continue;
        view.marks_px = seen.wand_px;
        view.marks_px.insert(view.marks_px.end(), seen.others_px.begin(), seen.others_px.end());
        view.outlines_px = outlines_of(seen.covered, view.image);
    }
    return views;
}

}  // namespace atrium::calibrate
