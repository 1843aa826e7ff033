#include "tools/export/frame_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

namespace atrium::exporting {
namespace {

constexpr double kUsualRateHz = 30.0;  // of a single frame

double seconds(std::chrono::nanoseconds duration) {
    return std::chrono::duration<double>(duration).count();
}

Expected<Survey> nothing_there(const std::shared_ptr<const recording::WorldFile>& world,
                               const Selection& selection) {
    Selection all = selection;
    all.begin = world->begin();
    all.end = world->end();
    all.every = 1;
    auto source = FrameSource::open(world, all);
    if (!source) return tl::unexpected(source.error());
    std::optional<Timestamp> first;
    Timestamp last;
    while (const auto frame = source->next()) {
        if (!first) first = frame->time;
        last = frame->time;
    }
    const std::string file = world->file().path().string();
    if (!first) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: has no complete frame of site '{}' (refused {}, "
                                      "damaged {}, incomplete {})",
                                      file,
                                      selection.site,
                                      source->frames().num_refused(),
                                      source->frames().num_damaged(),
                                      source->num_left_out()));
    }
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("no frame of site '{}' from {:.2f} to {:.2f} s: {} has frames of "
                                  "it from {:.2f} to {:.2f} s",
                                  selection.site,
                                  seconds(selection.begin - world->begin()),
                                  seconds(selection.end - world->begin()),
                                  file,
                                  seconds(*first - world->begin()),
                                  seconds(last - world->begin())));
}

}  // namespace

Expected<FrameSource> FrameSource::open(const std::shared_ptr<const recording::WorldFile>& world,
                                        const Selection& selection) {
    auto frames =
        recording::SiteFrames::open(world, selection.site, selection.begin, selection.end);
    if (!frames) return tl::unexpected(frames.error());
    return FrameSource(std::move(*frames), selection.every);
}

std::optional<recording::SiteFrame> FrameSource::next() {
    while (auto frame = frames_.next()) {
        const bool is_complete = frame->textures.size() == frame->mesh.textured_cameras.size();
        if (!is_complete || (last_ && frame->mesh.capture_time <= *last_)) {
            ++num_left_out_;
            continue;
        }
        last_ = frame->mesh.capture_time;
        if (num_good_++ % every_ == 0) return frame;
    }
    return std::nullopt;
}

double Survey::time_s(std::size_t frame) const {
    return seconds(frames[frame].capture_time - frames.front().capture_time);
}

Expected<Survey> survey(const std::shared_ptr<const recording::WorldFile>& world,
                        const Selection& selection,
                        std::size_t max_frames) {
    auto source = FrameSource::open(world, selection);
    if (!source) return tl::unexpected(source.error());
    Survey result;
    while (result.frames.size() < max_frames) {
        const auto frame = source->next();
        if (!frame) break;
        if (result.frames.empty() && frame->placement)
            result.placement = frame->placement->world_from_site;
        result.frames.push_back({frame->mesh.capture_time, frame->time});
    }
    if (result.frames.empty()) return nothing_there(world, selection);
    result.num_refused = source->frames().num_refused();
    result.num_damaged = source->frames().num_damaged();
    result.damage = source->frames().damage();
    std::vector<std::int64_t> periods;
    for (std::size_t i = 1; i < result.frames.size(); ++i) {
        periods.push_back(
            (result.frames[i].capture_time - result.frames[i - 1].capture_time).count());
    }
    result.rate_hz = kUsualRateHz;
    if (!periods.empty()) {
        const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
        std::nth_element(periods.begin(), middle, periods.end());
        result.rate_hz = 1e9 / static_cast<double>(*middle);
    }
    return result;
}

}  // namespace atrium::exporting
