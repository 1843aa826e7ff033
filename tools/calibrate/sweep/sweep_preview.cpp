#include "tools/calibrate/sweep/sweep_preview.hpp"

#include <fmt/format.h>

namespace atrium::calibrate {
namespace {

constexpr double kBrightness = 2.0;  // the room is dark

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
        view.outlines_px = seen.covered.outlines_px();
    }
    return views;
}

std::vector<preview::View> views_of(const capture::Metaframe& instant,
                                    const RestingWand& resting,
                                    const std::vector<NominalCamera>& cameras) {
    std::vector<preview::View> views;
    for (std::size_t c = 0; c < instant.frames.size(); ++c) {
        preview::View& view = views.emplace_back();
        view.name = cameras[c].name;
        view.image = instant.frames[c].image;
        view.brightness = kBrightness;
        view.marks_px = resting.wand_px(c);
        view.caption = fmt::format(
            "{}  {}", view.name, view.marks_px.empty() ? "not all lights" : "all lights");
    }
    return views;
}

}  // namespace atrium::calibrate
