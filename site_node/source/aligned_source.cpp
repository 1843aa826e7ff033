#include "site_node/source/aligned_source.hpp"

#include "site_node/capture/pace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atrium::site_node {
namespace {

constexpr std::size_t kMostKeptBytes = std::size_t{1} << 30;

}  // namespace

Expected<std::unique_ptr<AlignedSource>> AlignedSource::create(
    std::unique_ptr<capture::FrameSource> source,
    const std::vector<std::string>& cameras,
    double rate_hz) {
    if (source->loop_length() == 0)
        return make_error(ErrorKind::kConfiguration,
                          "simulation.shows: a site on several hosts can show people only");
    const std::vector<geometry::CalibratedCamera>& all = source->rig().cameras;
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < all.size() && cameras.empty(); ++i) chosen.push_back(i);
    for (const std::string& name : cameras) {
        const auto found = std::ranges::find(all, name, &geometry::CalibratedCamera::name);
        if (found == all.end())
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("the rig has no camera '{}'", name));
        chosen.push_back(static_cast<std::size_t>(found - all.begin()));
    }
    config::Rig rig = source->rig();
    rig.rate_hz = rate_hz;
    rig.cameras.clear();
    for (const std::size_t camera : chosen) rig.cameras.push_back(all[camera]);
    return std::unique_ptr<AlignedSource>(
        new AlignedSource(std::move(source), std::move(chosen), std::move(rig)));
}

AlignedSource::AlignedSource(std::unique_ptr<capture::FrameSource> source,
                             std::vector<std::size_t> chosen,
                             config::Rig rig)
    : source_(std::move(source)),
      chosen_(std::move(chosen)),
      rig_(std::move(rig)),
      counters_(rig_) {
    std::size_t bytes = 0;
    for (const geometry::CalibratedCamera& camera : rig_.cameras)
        bytes +=
            static_cast<std::size_t>(camera.intrinsics.width * camera.intrinsics.height) * 5 / 2;
    const std::size_t length = source_->loop_length();
    if (length * bytes > kMostKeptBytes) return;
    kept_.assign(length, std::vector<std::optional<capture::CameraFrame>>(chosen_.size()));
}

std::vector<Expected<void>> AlignedSource::show_background(const std::vector<std::size_t>& cameras,
                                                           const BackgroundSink& sink,
                                                           std::stop_token stop) {
    std::vector<std::size_t> of_source;
    for (const std::size_t camera : cameras) of_source.push_back(chosen_[camera]);
    const auto pass_on = [&](std::size_t camera, const image::YuvView& picture) {
        const auto chosen = std::ranges::find(chosen_, camera);
        return sink(static_cast<std::size_t>(chosen - chosen_.begin()), picture);
    };
    return source_->show_background(of_source, pass_on, stop);
}

Expected<capture::CameraFrame> AlignedSource::read_picture(std::size_t camera, std::size_t index) {
    auto frame = source_->read_picture(chosen_[camera], index);
    if (frame) frame->camera = camera;
    return frame;
}

Expected<capture::CameraFrame> AlignedSource::decoded(std::size_t camera, std::size_t index) {
    if (kept_.empty()) return read_picture(camera, index);
    auto& kept = kept_[index][camera];
    if (kept) return *kept;
    auto frame = read_picture(camera, index);
    if (frame) kept = *frame;
    return frame;
}

Expected<void> AlignedSource::run(std::stop_token stop, const Sink& sink) {
    capture::Pace pace(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rig_.rate_hz)),
                       capture::Pace::Phase::kAligned);
    const auto length = static_cast<std::int64_t>(source_->loop_length());
    while (pace.wait(stop)) {
        const auto index = static_cast<std::size_t>(pace.number() % length);
        for (std::size_t camera = 0; camera < chosen_.size() && !stop.stop_requested(); ++camera) {
            auto frame = decoded(camera, index);
            if (!frame) {  // missing or unreadable, as in a recording that is played
                counters_.count_incomplete(camera);
                sink({camera, pace.due_time(), {}, nullptr});
                continue;
            }
            counters_.count_received(camera);
            frame->capture_time = pace.due_time();
            sink(std::move(*frame));
        }
    }
    return {};
}

}  // namespace atrium::site_node
