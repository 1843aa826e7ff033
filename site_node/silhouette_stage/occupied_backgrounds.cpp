#include "site_node/silhouette_stage/occupied_backgrounds.hpp"

#include "core/app/log.hpp"
#include "core/app/progress.hpp"
#include "site_node/capture/timed_assembler.hpp"
#include "site_node/occupied_room/learn_occupied_room.hpp"
#include "site_node/segmentation/background_quality.hpp"
#include "site_node/silhouette_stage/kept_picture.hpp"
#include "site_node/silhouette_stage/learned_rooms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

namespace atrium::site_node {
namespace {

using segmentation::BackgroundStatistics;
using Clock = std::chrono::steady_clock;

// Pictures in memory at most; larger rigs learn from fewer instants.
constexpr std::size_t kMaxBytes = std::size_t{768} << 20;

// [camera][instant]; null: no picture.
using Kept = std::vector<std::vector<std::unique_ptr<KeptPicture>>>;

std::unique_ptr<KeptPicture> keep(const capture::CameraFrame& frame) {
    image::YuvImage buffer;
    auto kept = std::make_unique<KeptPicture>();
    kept->keep(image::working_view(frame.image, buffer));
    return kept;
}

// Collects pictures of all cameras.
class InstantCollector {
public:
    InstantCollector(capture::FrameSource& source, const BackgroundOptions& options)
        : source_(source), options_(options), kept_(source.rig().cameras.size()) {
        std::size_t bytes = 0;
        for (const auto& camera : source.rig().cameras) {
            bytes += static_cast<std::size_t>(camera.intrinsics.width) *
                     static_cast<std::size_t>(camera.intrinsics.height) * 3 / 2;
        }
        const auto wanted = static_cast<std::size_t>(
            options.num_frames > 0 ? options.num_frames : BackgroundOptions::kNumWithPeople);
        num_wanted_ = std::clamp(wanted,
                                 occupied_room::kMinOccupiedPictures,
                                 std::max(kMaxBytes / std::max<std::size_t>(bytes, 1),
                                          occupied_room::kMinOccupiedPictures));
    }

    Expected<Kept> collect(const std::stop_token& stop) {
        if (source_.num_frames() > 0) {
            read(stop);
        } else if (auto watched = watch(stop); !watched) {
            return tl::unexpected(watched.error());
        }
        return std::move(kept_);
    }

private:
    // Camera by camera, each forwards: a video cannot be read in another order without decoding it
    // anew.
    void read(const std::stop_token& stop) {
        const std::size_t num = std::min(num_wanted_, source_.num_frames());
        for (std::size_t camera = 0; camera < kept_.size(); ++camera) {
            kept_[camera].resize(num);
            for (std::size_t i = 0; i < num && !stop.stop_requested(); ++i) {
                auto frame = source_.read_picture(camera, i * source_.num_frames() / num);
                if (frame) kept_[camera][i] = keep(*frame);
                log_progress(camera * num + i + 1, kept_.size() * num);
            }
        }
    }

    Expected<void> watch(const std::stop_token& stop) {
        const double rate_hz = source_.rig().rate_hz;
        capture::AssemblerOptions assembling;
        assembling.tolerance =
            std::chrono::nanoseconds(static_cast<std::int64_t>(0.25e9 / rate_hz));
        assembling.deadline = std::chrono::milliseconds(100);
        assembling.min_cameras = 2;
        const auto gap = std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(options_.watch_s / static_cast<double>(num_wanted_)));
        std::stop_source enough;
        const std::stop_callback pass_on(stop, [&] { enough.request_stop(); });
        auto due = Clock::now();
        std::size_t num = 0;
        const auto take = [&](std::optional<capture::Metaframe> metaframe,
                              const capture::MetaframeAssembler&) {
            if (!metaframe || Clock::now() < due || num >= num_wanted_) return;
            due = std::max(due + gap, Clock::now());
            for (const capture::CameraFrame& frame : metaframe->frames)
                kept_[frame.camera].push_back(frame.image.empty() ? nullptr : keep(frame));
            if (++num >= num_wanted_) enough.request_stop();
            log_progress(num, num_wanted_);
        };
        capture::TimedAssembler assembler(kept_.size(), assembling, take);
        return source_.run(enough.get_token(),
                           [&](capture::CameraFrame frame) { assembler.add(std::move(frame)); });
    }

    void log_progress(std::size_t done, std::size_t total) {
        if (!progress_) progress_.emplace("picture", total);
        if (const auto line = progress_->update(done))
            app::log::info("reading the room with people in it: {}", *line);
    }

    capture::FrameSource& source_;
    const BackgroundOptions& options_;
    std::size_t num_wanted_ = 0;
    Kept kept_;
    std::optional<app::Progress> progress_;
};

occupied_room::OccupiedRoom seen_room(const config::Rig& rig, const Kept& kept) {
    occupied_room::OccupiedRoom seen{rig.cameras, rig.bounds_site, {}};
    for (const auto& pictures : kept) {
        std::vector<image::YuvView>& views = seen.pictures.emplace_back();
        for (const auto& picture : pictures)
            views.push_back(picture == nullptr ? image::YuvView() : picture->view());
    }
    return seen;
}

void report(const std::string& camera,
            const occupied_room::LearnedRoom& learned,
            const segmentation::SegmentationOptions& segmentation) {
    const auto quality = segmentation::background_quality(learned.room, segmentation);
    app::log::info(
        "learned the room with people in it camera={} pictures={} noise={:.2f} coverage={:.3f} "
        "people={:.4f} never_empty={:.4f}",
        camera,
        learned.room.num_frames,
        quality.noise,
        quality.coverage,
        learned.covered,
        learned.never_empty);
    constexpr double kMuch = 0.002;
    if (learned.never_empty > kMuch) {
        const image::PixelRect& px = learned.never_empty_px;
        app::log::warn(
            "camera '{}': {:.1f} % of the picture never showed the empty room, most around "
            "({}, {}), where the surroundings replace it; record for longer while people move "
            "about, or record the empty room (docs/backgrounds.md)",
            camera,
            100.0 * learned.never_empty,
            px.x + px.width / 2,
            px.y + px.height / 2);
    }
}

// A room with a person who never left looks like any other; its silhouettes do not.
void report_agreement(const config::Rig& rig,
                      const occupied_room::OccupiedRoom& seen,
                      const std::vector<Expected<occupied_room::LearnedRoom>>& rooms,
                      const segmentation::SegmentationOptions& segmentation,
                      const std::stop_token& stop) {
    std::vector<const BackgroundStatistics*> learned;
    for (const auto& room : rooms) learned.push_back(room ? &room->room : nullptr);
    const auto agreement = compare_learned_rooms(rig, seen.pictures, learned, segmentation, stop);
    if (!agreement) return;
    if (const std::string doubt = doubt_learned_rooms(*agreement); !doubt.empty()) {
        app::log::warn("{}", doubt);
    } else {
        app::log::info("the learned rooms agree instants={} explained={:.2f} worst={}:{:.2f}",
                       agreement->num_instants,
                       agreement->explained,
                       agreement->worst,
                       agreement->worst_explained);
    }
}

std::vector<Expected<BackgroundStatistics>> all_failed(std::size_t num, const Error& error) {
    return std::vector<Expected<BackgroundStatistics>>(num, tl::unexpected(error));
}

}  // namespace

std::vector<Expected<BackgroundStatistics>> learn_with_people(
    capture::FrameSource& source,
    const std::vector<std::size_t>& cameras,
    const BackgroundOptions& options,
    const segmentation::SegmentationOptions& segmentation,
    const std::stop_token& stop) {
    const Error stopped{ErrorKind::kUnavailable, "stopped while learning the empty room"};
    if (options.from == "auto") {
        app::log::info(
            "no pictures of the empty room (background.*): learning it from the pictures with "
            "people in it");
    }
    auto kept = InstantCollector(source, options).collect(stop);
    if (stop.stop_requested()) return all_failed(cameras.size(), stopped);
    if (!kept) return all_failed(cameras.size(), kept.error());
    const config::Rig& rig = source.rig();
    app::log::info("comparing the pictures of {} cameras to find the empty room",
                   rig.cameras.size());
    std::optional<app::Progress> progress;
    const occupied_room::OccupiedRoom seen = seen_room(rig, *kept);
    const auto rooms = occupied_room::learn_occupied_room(
        seen,
        segmentation,
        [&](std::size_t done, std::size_t total) {
            if (!progress) progress.emplace("step", total);
            if (const auto line = progress->update(done))
                app::log::info("learning the room with people in it: {}", *line);
        },
        stop);
    std::vector<Expected<BackgroundStatistics>> results;
    for (const std::size_t camera : cameras) {
        const std::string& name = rig.cameras[camera].name;
        if (stop.stop_requested()) {
            results.push_back(tl::unexpected(stopped));
        } else if (!rooms[camera]) {
            results.push_back(make_error(
                rooms[camera].error().kind,
                fmt::format(
                    "camera '{}': no background: {}", name, rooms[camera].error().message)));
        } else {
            report(name, *rooms[camera], segmentation);
            results.emplace_back(rooms[camera]->room);
        }
    }
    report_agreement(rig, seen, rooms, segmentation, stop);
    return results;
}

}  // namespace atrium::site_node
