#include "site_node/site_node.hpp"

#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/base/named_thread.hpp"
#include "core/status/bottleneck.hpp"
#include "site_node/metaframe_losses.hpp"

#include <fmt/format.h>

#include <thread>

namespace atrium::site_node {
namespace {

using std::chrono::nanoseconds;

// So many lost metaframes are no hiccup of the start: one second of most rooms.
constexpr std::uint64_t kManyLost = 30;

// Whether camera nodes saw people, but left out all textures.
bool lacks_textures(const capture::Metaframe& metaframe) {
    bool has_people = false;
    for (const capture::CameraFrame& frame : metaframe.frames) {
        if (frame.found == nullptr) continue;
        if (frame.found->has_texture) return false;
        has_people |= !frame.found->contours_px.empty();
    }
    return has_people;
}

}  // namespace

Expected<void> SiteNode::run(std::stop_token stop) {
    if (auto begun = run_control_->begin(); !begun) return begun;
    const std::stop_callback pass_on(stop, [this] { run_control_->finish({}); });
    const bus::SiteDescription description{
        config_.name, source_->rig().cameras, source_->rig().bounds_site};
    if (auto written = writers_.description.write(description); !written)
        return tl::unexpected(written.error());
    if (recorder_ != nullptr && !config_.record.folder.empty()) {
        if (auto started = recorder_->start(config_.record.folder); !started) return started;
    }
    {
        // destruction stops and joins in the order of the data: captured metaframes still go out
        const std::jthread publisher =
            named_thread("publish", [this](std::stop_token s) { publish_frames(s); });
        const std::jthread worker =
            named_thread("work", [this](std::stop_token s) { compute_frames(s); });
        const std::jthread silhouettes =
            named_thread("silhouettes", [this](std::stop_token s) { find_silhouettes(s); });
        const std::jthread orders = record_orders_ == nullptr
                                        ? std::jthread()
                                        : named_thread("record orders", [this](std::stop_token s) {
                                              record_orders_->run(std::move(s));
                                          });
        const std::jthread capturer = named_thread(
            "capture", [this](std::stop_token) { capture_metaframes(run_control_->token()); });
        report_status(run_control_->token());
    }
    const Expected<void> recorded = recorder_ ? recorder_->stop() : Expected<void>();
    // after a loss of the name its instances belong to another program
    if (!run_control_->has_lost_name()) {
        if (auto gone = writers_.description.dispose(description); !gone)
            app::log::warn("{}", gone.error().message);
    }
    const bus::SiteStatus total = status();
    app::log::info("stopped captured={} published={} incomplete={} late={} rate={} failed={} {}",
                   total.num_metaframes_captured,
                   total.num_metaframes_published,
                   total.num_dropped_incomplete,
                   total.num_dropped_late,
                   total.stream.num_dropped_for_rate,
                   total.num_failed,
                   atrium::status::process_fields(total.processor, total.first_output_s));
    if (const std::string line = losses_line({}, total); !line.empty())
        app::log::info("counted {}", line);
    if (const auto* const worker = pipeline_.worker())
        app::log::info("segmentation_worker {}", worker->line());
    for (const capture::CameraCounters& counters : source_->camera_counters()) {
        if (source_->is_live() || has_faults(counters))
            app::log::info("camera {}", to_line(counters));
    }
    coherence_watcher_.finish();
    rig_watcher_.finish(coherence_watcher_.doubts_rig());
    if (auto done = run_control_->result(); !done) return done;
    if (!recorded) return recorded;
    return explain_no_output(total, stop.stop_requested());
}

// A site that published nothing of the pictures that came failed, unless the user ended it at once.
Expected<void> SiteNode::explain_no_output(const bus::SiteStatus& total, bool was_stopped) {
    const std::uint64_t num_lost = total.num_failed + total.num_dropped_incomplete;
    const std::uint64_t num_published = total.num_metaframes_published;
    const std::string& found = rig_watcher_.last_reason();
    if (num_with_people_ > 0 || num_published + num_lost == 0) return {};
    if (was_stopped && num_published + num_lost < kManyLost) return {};
    if (num_published > 0) {
        if (found.empty()) {  // an empty room
            warn_of_nobody(num_published);
            return {};
        }
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("no person was published, though cameras saw some: all {} "
                                      "meshes are empty: {}",
                                      num_published,
                                      found));
    }
    const std::lock_guard lock(losses_mutex_);
    std::string reason = last_failure_;
    if (!found.empty()) reason = fmt::format("{}{}{}", found, reason.empty() ? "" : "; ", reason);
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format("nothing was published: of all metaframes {} failed and {} were incomplete{}",
                    total.num_failed,
                    total.num_dropped_incomplete,
                    reason.empty() ? "; the counts of the cameras above say which pictures are "
                                     "missing"
                                   : ": " + reason));
}

void SiteNode::warn_of_nobody(std::uint64_t num_metaframes) {
    if (told_nobody_.exchange(true)) return;
    app::log::warn(
        "nobody_seen metaframes={} reason=\"no mesh has a person\" advice=\"if somebody was there, "
        "look at what the cameras show: --preview FILE.png; the empty room must have the light of "
        "the pictures and nobody in it, masks must show people in white: docs/backgrounds.md\"",
        num_metaframes);
}

void SiteNode::capture_metaframes(std::stop_token stop) {
    const double tolerance_ms = config_.capture.tolerance_ms > 0.0
                                    ? config_.capture.tolerance_ms
                                    : 250.0 / metaframe_rate_hz(config_, source_->rig());
    capture::AssemblerOptions options;
    options.tolerance = nanoseconds(static_cast<std::int64_t>(tolerance_ms * 1e6));
    options.deadline = nanoseconds(static_cast<std::int64_t>(config_.capture.deadline_ms * 1e6));
    options.min_cameras = static_cast<std::size_t>(config_.capture.min_cameras);
    std::uint64_t num_stray = 0;
    const auto take = [&](std::optional<capture::Metaframe> metaframe,
                          const capture::MetaframeAssembler& assembler) {
        if (assembler.counters().num_stray > num_stray) {
            num_stray = assembler.counters().num_stray;
            complaints_.warn(fmt::format("pictures that fit no metaframe num={}", num_stray));
        }
        num_incomplete_ = assembler.counters().num_incomplete;
        num_incomplete_used_ = assembler.counters().num_incomplete_used;
        offsets_.update(assembler.offsets(), options.tolerance);
        if (metaframe) hand_over(std::move(*metaframe));
    };
    capture::TimedAssembler assembler(source_->rig().cameras.size(), options, take);
    const auto result = source_->run(stop, [&](capture::CameraFrame frame) {
        if (recorder_ != nullptr) recorder_->add(frame);
        assembler.add(std::move(frame));
    });
    if (!stop.stop_requested()) assembler.finish();
    if (source_->is_live()) app::log::info("camera offsets in ms {}", offsets_.line());
    run_control_->finish(result);
}

void SiteNode::hand_over(capture::Metaframe metaframe) {
    std::string missing;
    for (const capture::CameraFrame& frame : metaframe.frames) {
        if (frame.is_lost()) missing += " " + source_->rig().cameras[frame.camera].name;
    }
    if (!missing.empty()) {
        missing_cameras_.warn(missing,
                              fmt::format("metaframe goes on without cameras id={} missing=\"{}\"",
                                          metaframe.frame_id,
                                          missing.substr(1)));
    }
    const std::uint64_t num_captured = ++num_captured_;
    metaframes_.offer(std::move(metaframe));
    if (config_.capture.as_fast_as_possible) lock_step_.wait(num_captured, run_control_->token());
}

void SiteNode::find_silhouettes(std::stop_token stop) {
    while (auto begun = metaframes_.begin(stop)) {
        std::unique_ptr<Pipeline::Silhouettes> memory;
        if (begun->dropped) memory = std::move(begun->dropped->silhouettes);
        begun->dropped.reset();
        auto choice = stream_.offer(std::chrono::steady_clock::now());
        if (choice && hosts_ != nullptr) {
            // the camera nodes count their turns from the last metaframe that was sent
            const bool is_sent = !lacks_textures(begun->value);
            if (is_sent) last_sent_ = begun->value.capture_time;
            hosts_->set_wishes({choice->level.jpeg_quality,
                                choice->level.colour_divisor,
                                choice->level.send_every,
                                last_sent_});
            if (!is_sent) {
                stream_.give_back();
                choice.reset();
            }
        }
        if (choice)
            find_silhouettes_of(begun->value, *choice, std::move(memory));
        else
            lock_step_.finish();
    }
}

void SiteNode::find_silhouettes_of(const capture::Metaframe& metaframe,
                                   const StreamAdapter::Choice& choice,
                                   std::unique_ptr<Pipeline::Silhouettes> memory) {
    if (memory == nullptr) memory = spare_silhouettes_.try_take().value_or(nullptr);
    if (memory == nullptr) memory = std::make_unique<Pipeline::Silhouettes>();
    const auto found = pipeline_.find_silhouettes(metaframe, pool_.background(), *memory);
    if (!found) {
        memory->release();
        spare_silhouettes_.put(std::move(memory));
        return count_failure(metaframe.frame_id, found.error());
    }
    metaframes_.hand_over({std::move(memory), choice, ThreadPool::Priority(pool_)});
}

void SiteNode::compute_frames(std::stop_token stop) {
    while (auto ready = metaframes_.take(stop)) {
        compute_frame(*ready);
        ready->silhouettes->release();
        spare_silhouettes_.put(std::move(ready->silhouettes));
    }
}

void SiteNode::count_failure(std::uint64_t frame_id, const Error& error) {
    ++num_failed_;
    lock_step_.finish();
    failures_.warn(error.message,
                   fmt::format("metaframe failed id={} reason=\"{}\"", frame_id, error.message));
    const std::lock_guard lock(losses_mutex_);
    last_failure_ = error.message;
}

void SiteNode::compute_frame(Ready& ready) {
    auto frame = spare_frames_.try_take().value_or(nullptr);
    if (frame == nullptr) frame = std::make_unique<SiteFrame>();
    const StreamAdapter::Choice& choice = ready.choice;
    const ColourCoding coding{choice.level.jpeg_quality, choice.level.colour_divisor};
    pipeline_.pause_refinement(is_refinement_paused_);
    const auto done = pipeline_.compute(*ready.silhouettes, coding, pool_, *frame);
    if (rig_watcher_.wants_look(std::chrono::steady_clock::now()))
        rig_watcher_.put(pipeline_.look(*ready.silhouettes, *frame));
    const std::uint64_t id = ready.silhouettes->metaframe().frame_id;
    if (coherence_watcher_.wants(id, std::chrono::steady_clock::now()))
        coherence_watcher_.put(id, pipeline_.views(*ready.silhouettes));
    if (!done) return count_failure(ready.silhouettes->metaframe().frame_id, done.error());
    stream_.coded(choice, *frame, std::chrono::steady_clock::now());
    count_losses(*frame);
    stage_times_.computed(*frame);
    show_preview(*ready.silhouettes);
    app::log::debug(
        "metaframe id={} triangles={} silhouettes_ms={:.2f} hull_ms={:.2f} encode_ms={:.2f} "
        "total_ms={:.2f} camouflaged_px={}",
        frame->frame_id,
        frame->hull.mesh.triangles.size(),
        frame->milliseconds.silhouettes,
        frame->milliseconds.hull,
        frame->milliseconds.encode,
        frame->milliseconds.total,
        frame->num_camouflaged_px);
    site_frames_.put(std::move(frame));
}

void SiteNode::count_losses(const SiteFrame& frame) {
    const MetaframeLosses& losses = frame.losses;
    if (losses.regions_failed > 0) {
        std::string failed = fmt::format("failed={}", losses.regions_failed);
        for (const bus::RegionMeshes& remote : frame.remote) {
            if (remote.left_out.num_regions_failed > 0) failed += " host=" + remote.host;
        }
        missing_regions_.warn(
            failed, fmt::format("metaframe lacks regions id={} {}", frame.frame_id, failed));
    }
    const std::lock_guard lock(losses_mutex_);
    add(losses, losses_);
}

void SiteNode::show_preview(const Pipeline::Silhouettes& silhouettes) {
    const capture::Metaframe& metaframe = silhouettes.metaframe();
    if (preview_ == nullptr || !preview_->count(metaframe)) return;
    std::vector<std::vector<std::vector<Eigen::Vector2d>>> outlines_px;
    for (std::size_t camera = 0; camera < metaframe.frames.size(); ++camera)
        outlines_px.push_back(silhouettes.delivered_outlines(camera));
    preview_->show(metaframe, std::move(outlines_px));
}

void SiteNode::publish_frames(std::stop_token stop) {
    while (auto frame = site_frames_.take(stop)) {
        const auto num_bytes = publish(**frame);
        lock_step_.finish();
        if (!num_bytes) {
            ++num_failed_;
            complaints_.warn(fmt::format("not published id={} reason=\"{}\"",
                                         (*frame)->frame_id,
                                         num_bytes.error().message));
            continue;
        }
        app::log::debug(
            "published id={} capture_ns={}", (*frame)->frame_id, (*frame)->capture_time.ns);
        num_bytes_ += *num_bytes;
        if (num_published_ == 0) first_output_s_ = app::seconds_since_start();
        ++num_published_;
        if (!(*frame)->draco.empty()) ++num_with_people_;
        // a whole recording; one that loops never ends
        if (num_published_ == source_->num_frames() && num_with_people_ == 0)
            warn_of_nobody(num_published_);
        spare_frames_.put(std::move(*frame));
    }
}

// Textures of camera nodes have keys of their own. If there are any, the mesh names the key of
// each.
void SiteNode::name_remote_textures(const SiteFrame& frame, bus::SiteMesh& mesh) {
    if (frame.remote_textures.empty()) return;
    mesh.texture_frames.assign(mesh.textured_cameras.size(), {frame.frame_id, frame.capture_time});
    for (const RemoteTexture& texture : frame.remote_textures) {
        mesh.textured_cameras.push_back(texture.camera);
        mesh.texture_frames.push_back({texture.frame_id, texture.capture_time});
    }
}

// Writes the mesh last: with its arrival a viewer's pair is complete. Lends the coded bytes to the
// messages without a copy; afterwards `frame` has them again and keeps its memory.
Expected<std::size_t> SiteNode::publish(SiteFrame& frame) {
    bus::SiteMesh mesh{config_.name, frame.frame_id, frame.capture_time, {}, {}};
    const auto begin = std::chrono::steady_clock::now();
    std::size_t num_bytes = 0;
    for (CodedCamera& camera : frame.cameras) {
        bus::CameraTexture texture{config_.name,
                                   camera.camera,
                                   frame.frame_id,
                                   frame.capture_time,
                                   camera.crop_px,
                                   std::move(camera.texture.colour),
                                   std::move(camera.texture.mask)};
        const auto written = writers_.textures[camera.camera].write(texture);
        camera.texture = {std::move(texture.colour), std::move(texture.mask)};
        if (!written) return written;
        num_bytes += *written;
        mesh.textured_cameras.push_back(camera.camera);
    }
    name_remote_textures(frame, mesh);
    mesh.draco.swap(frame.draco);
    mesh.mesh_sizes = frame.mesh_sizes;
    const auto written = writers_.mesh.write(mesh);
    mesh.draco.swap(frame.draco);
    if (!written) return written;
    stage_times_.published(*written,
                           num_bytes,
                           std::chrono::steady_clock::now() - begin,
                           Timestamp::now() - frame.capture_time);
    return num_bytes + *written;
}

}  // namespace atrium::site_node
