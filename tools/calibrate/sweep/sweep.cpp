#include "tools/calibrate/sweep/sweep.hpp"

#include "site_node/source/open_source.hpp"
#include "tools/calibrate/sweep/detect_lights.hpp"
#include "tools/calibrate/sweep/resting_wand.hpp"
#include "tools/calibrate/sweep/sweep_preview.hpp"
#include "tools/calibrate/sweep/sweep_tally.hpp"
#include "tools/calibrate/sweep/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace atrium::calibrate {
namespace {

// Finds the lights in the pictures of all cameras.
class LightObserver : public Observer {
public:
    LightObserver(std::vector<NominalCamera> all, double light_threshold)
        : Observer(std::move(all)), buffers_(cameras().size()), seen_(cameras().size()) {
        for (std::size_t c = 0; c < buffers_.size(); ++c)
            detectors_.emplace_back(DetectionOptions{light_threshold});
    }

    void look(std::size_t c, const image::RawImage& image) override {
        seen_[c].reset();
        if (image.empty()) return;
        detectors_[c].detect(image::working_view(image, buffers_[c]), seen_[c].emplace());
    }

protected:
    const std::vector<std::optional<DetectedLights>>& seen() const { return seen_; }

private:
    std::vector<LightDetector> detectors_;
    std::vector<image::YuvImage> buffers_;
    std::vector<std::optional<DetectedLights>> seen_;
};

class SweptWand final : public LightObserver {
public:
    SweptWand(SweepTally tally, const std::vector<NominalCamera>& cameras, double light_threshold)
        : LightObserver(cameras, light_threshold), tally_(std::move(tally)) {}

    void count(const capture::Metaframe& instant) override {
        tally_.add(static_cast<std::uint32_t>(instant.frame_id), seen());
    }
    bool is_complete() const override { return tally_.is_complete(); }
    std::string progress(std::size_t most_characters) const override {
        return tally_.progress(most_characters);
    }
    std::vector<std::string> take_warnings() override { return tally_.take_warnings(); }
    std::vector<preview::View> views(const capture::Metaframe& instant) const override {
        return views_of(instant, tally_);
    }

    const SweepTally& tally() const { return tally_; }

private:
    SweepTally tally_;
};

class LyingWand final : public LightObserver {
public:
    LyingWand(RestingWand resting, const std::vector<NominalCamera>& cameras)
        : LightObserver(cameras, 0.0), resting_(std::move(resting)) {}

    void count(const capture::Metaframe&) override { resting_.add(seen()); }
    bool is_complete() const override { return resting_.is_complete(); }
    std::string progress(std::size_t) const override { return resting_.progress(); }
    std::vector<std::string> take_warnings() override { return {}; }
    std::vector<preview::View> views(const capture::Metaframe& instant) const override {
        return views_of(instant, resting_, cameras());
    }

    const RestingWand& resting() const { return resting_; }

private:
    RestingWand resting_;
};

}  // namespace

Expected<Sweep> record_sweep(const SweepOptions& options, const Wand& wand, std::stop_token stop) {
    Sweep sweep;
    const auto source =
        site_node::open_uncalibrated_source(options.source.capture, options.source.room, stop);
    if (!source) return tl::unexpected(source.error());
    const config::Rig& rig = (*source)->rig();
    sweep.rate_hz = rig.rate_hz;
    sweep.cameras = nominal_cameras(rig);
    auto tally = SweepTally::make(wand, sweep.cameras, {options.num_instants, rig.rate_hz});
    if (!tally) return tl::unexpected(tally.error());
    fmt::print(stderr,
               "sweep: {} cameras; sweep the wand through the whole space and turn it; Ctrl-C ends "
               "the sweep and solves\n",
               sweep.cameras.size());
    SweptWand observer(std::move(*tally), sweep.cameras, options.light_threshold);
    if (auto watched = watch(**source, options.source, observer, stop); !watched)
        return tl::unexpected(watched.error());
    if (const std::string why = observer.tally().why_too_little(); !why.empty())
        return make_error(ErrorKind::kInvalidData, why);
    sweep.points = observer.tally().points();
    return sweep;
}

Expected<LightPoints> watch_resting_wand(const SourceOptions& options,
                                         const Wand& wand,
                                         const config::Rig& rig,
                                         std::stop_token stop) {
    const auto source = site_node::open_uncalibrated_source(options.capture, options.room, stop);
    if (!source) return tl::unexpected(source.error());
    const std::vector<NominalCamera> cameras = nominal_cameras((*source)->rig());
    auto resting = RestingWand::make(wand, cameras);
    if (!resting) return tl::unexpected(resting.error());
    fmt::print(stderr,
               "floor: {} cameras; lay the wand on the floor{}, and step away each time\n",
               cameras.size(),
               resting->num_needed() == 1
                   ? ""
                   : ", at the origin first, its far end towards +X, then at two other places");
    LyingWand observer(std::move(*resting), cameras);
    if (auto watched = watch(**source, options, observer, std::move(stop)); !watched)
        return tl::unexpected(watched.error());
    const RestingWand& found = observer.resting();
    if (!found.is_complete())
        return make_error(
            ErrorKind::kInvalidData,
            found.sees_other_wand()
                ? found.progress()
                : fmt::format("two cameras saw the wand at rest at {} of {} places: darken the "
                              "room, let its lights look up, and lay it where cameras see all of "
                              "them",
                              found.num_places(),
                              found.num_needed()));
    LightPoints points = found.points();
    std::erase_if(points, [&](const LightCamera& camera) {
        return std::ranges::find(rig.cameras, camera.name, &geometry::CalibratedCamera::name) ==
               rig.cameras.end();
    });
    return points;
}

}  // namespace atrium::calibrate
