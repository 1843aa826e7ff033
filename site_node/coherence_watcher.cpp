#include "site_node/coherence_watcher.hpp"

#include "core/app/log.hpp"
#include "core/base/thread_priority.hpp"
#include "core/bus/names.hpp"
#include "site_node/coherence/fault_text.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <ctime>
#include <utility>

namespace atrium::site_node {
namespace {

constexpr auto kSightPeriod = std::chrono::milliseconds(500);
constexpr auto kKeepPeriod = std::chrono::minutes(1);  // somebody may mend the camera meanwhile
constexpr double kNotGood_px = coherence::kFits_px;

double thread_cpu_s() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// `options`: empty, or with a space at the end.
std::string command_that_refines(const std::string& rig,
                                 const std::string& options,
                                 const std::string& recording) {
    return fmt::format(
        "calibrate refine {} {}--recording {} -o mended.toml", rig, options, recording);
}

// A fault that `calibrate refine` mends.
bool is_mendable(coherence::Verdict verdict) {
    return verdict == coherence::Verdict::kMoved || verdict == coherence::Verdict::kIncoherent ||
           verdict == coherence::Verdict::kLenses;
}

}  // namespace

CoherenceWatcher::CoherenceWatcher(std::vector<geometry::CalibratedCamera> cameras,
                                   double rate_hz,
                                   std::string rig_name,
                                   std::filesystem::path kept_folder,
                                   std::function<bool()> is_explained)
    : cameras_(std::move(cameras)),
      rate_hz_(rate_hz),
      rig_name_(std::move(rig_name)),
      is_explained_(std::move(is_explained)),
      watch_(cameras_),
      kept_(std::move(kept_folder), coherence::Coherence::kWindow),
      thread_([this](std::stop_token stop) { run(stop); }) {
    pthread_setname_np(thread_.native_handle(), "coherence");
}

CoherenceWatcher::~CoherenceWatcher() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
}

bool CoherenceWatcher::wants(std::uint64_t frame_id, Clock::time_point now) {
    if (cameras_.size() < 3) return false;
    if (before_id_) return frame_id > *before_id_;
    if (now < due_ || is_looking_) return false;
    due_ = now + kSightPeriod;
    wanted_at_ = now;
    return true;
}

void CoherenceWatcher::put(std::uint64_t frame_id, std::vector<views::NamedView> views) {
    if (!before_id_) {
        before_id_ = frame_id;
        before_ = std::move(views);
        return;
    }
    // metaframes between them were dropped: the motion is unknown
    if (frame_id != *before_id_ + 1) before_.clear();
    before_id_.reset();
    is_looking_ = true;
    slot_.put({{frame_id, std::move(views), std::exchange(before_, {})}, wanted_at_});
}

void CoherenceWatcher::run(std::stop_token stop) {
    lower_thread_priority();
    while (auto one = slot_.take(stop)) {
        look(std::move(*one));
        cpu_s_ = thread_cpu_s();
        is_looking_ = false;
    }
}

std::vector<coherence::SilhouetteHull> CoherenceWatcher::hulls_of(
    const std::vector<views::NamedView>& views) const {
    std::vector<coherence::SilhouetteHull> hulls(cameras_.size());
    for (const views::NamedView& view : views) {
        const auto camera =
            std::ranges::find(cameras_, view.name, &geometry::CalibratedCamera::name);
        if (camera == cameras_.end()) continue;
        hulls[static_cast<std::size_t>(camera - cameras_.begin())] =
            coherence::hull_of(view.view.contours, camera->intrinsics);
    }
    return hulls;
}

void CoherenceWatcher::look(Look&& look) {
    if (is_explained_()) {
        const std::lock_guard lock(newest_mutex_);
        newest_ = {};
        return;
    }
    coherence::Sight sight;
    sight.now = hulls_of(look.instant.now);
    if (!look.instant.before.empty()) sight.before = hulls_of(look.instant.before);
    const auto judgement = watch_.look(sight, look.wanted_at);
    if (watch_.has_used_last()) kept_.add(std::move(look.instant));
    if (!judgement) return;
    keep(*judgement, look.wanted_at);
    tell(*judgement);
    bus::RigCoherence status = status_of(judgement->report);
    const std::lock_guard lock(newest_mutex_);
    newest_ = std::move(status);
}

void CoherenceWatcher::keep(const coherence::CoherenceWatch::Judgement& judgement,
                            Clock::time_point now) {
    if (!kept_.has_folder()) return;
    if (!is_mendable(judgement.report.verdict)) {
        kept_at_.reset();
        return;
    }
    if (!judgement.is_told && kept_at_ && now - *kept_at_ < kKeepPeriod) return;
    kept_at_ = now;
    const auto written = kept_.write();
    is_kept_ = written.has_value();
    if (!written) app::log::warn("silhouettes_not_kept reason=\"{}\"", written.error().message);
}

// What `refine` has to free for a fault.
std::string CoherenceWatcher::options_of(const coherence::Report& report) const {
    if (report.verdict == coherence::Verdict::kLenses) return "--focal ";
    return report.fault ? fmt::format("--camera {} ", cameras_[report.fault->camera].name) : "";
}

std::string CoherenceWatcher::refine_command(const std::string& options) const {
    return command_that_refines(rig_name_, options, is_kept_ ? kept_.folder().string() : "DIR");
}

bus::RigCoherence CoherenceWatcher::newest() const {
    const std::lock_guard lock(newest_mutex_);
    return newest_;
}

void CoherenceWatcher::tell(const coherence::CoherenceWatch::Judgement& judgement) const {
    const coherence::Report& report = judgement.report;
    if (judgement.recovered) {
        app::log::info(
            "camera_coherent camera={} rms_px={:.2f} coherence_px={:.2f} reason=\"its silhouettes "
            "agree with the rig again\"",
            cameras_[*judgement.recovered].name,
            report.cameras[*judgement.recovered].rms_px,
            report.rms_px);
    }
    if (judgement.is_told) app::log::warn("{}", text_of(report));
}

std::string CoherenceWatcher::text_of(const coherence::Report& report) const {
    const char* const walk = is_kept_ ? "let somebody walk through the room for a minute and a half"
                                      : "record a person who walks through the room";
    const std::string mend = refine_command(options_of(report));
    if (report.lenses)
        return fmt::format(
            "other_lenses factor={:.2f} coherence_px={:.2f} reason=\"{}, or {}, and mend the rig "
            "with `{}`\"",
            report.lenses->factor,
            report.rms_px,
            coherence::other_lenses_text(report.lenses->before_px,
                                         report.lenses->after_px,
                                         coherence::lenses_text(report.lenses->factor)),
            walk,
            mend);
    if (!report.fault)
        return fmt::format(
            "rig_incoherent coherence_px={:.2f} reason=\"the silhouettes contradict the rig, and "
            "no single camera explains it: cure what cameras_contradict names, if it does; else "
            "look at them with --preview; if they are good, do all cameras or videos show the same "
            "instant? If so, {}, and "
            "mend cameras that are off by up to 1 degree and 3 cm with `{}`, or calibrate again\"",
            report.rms_px,
            walk,
            mend);
    const coherence::NamedFault& fault = *report.fault;
    const std::string& name = cameras_[fault.camera].name;
    if (report.verdict == coherence::Verdict::kLate)
        return fmt::format("camera_late camera={} instants={:.1f} reason=\"{}\"",
                           name,
                           fault.late_instants,
                           coherence::late_text(fault, name, rate_hz_));
    return fmt::format(
        "camera_moved camera={} effect_px={:.1f} coherence_px={:.2f} reason=\"{} {} since the "
        "calibration: fix it, {}, and mend the rig with `{}`\"",
        name,
        fault.effect_px,
        report.rms_px,
        name,
        coherence::motion_text(fault),
        walk,
        mend);
}

bus::RigCoherence CoherenceWatcher::status_of(const coherence::Report& report) const {
    bus::RigCoherence out;
    static_assert(static_cast<int>(bus::RigVerdict::kLenses) ==
                  static_cast<int>(coherence::Verdict::kLenses));
    out.verdict = static_cast<bus::RigVerdict>(report.verdict);
    out.rms_px = report.rms_px;
    out.num_instants = static_cast<std::uint32_t>(report.num_sights);
    for (std::size_t i = 0; i < report.cameras.size(); ++i) {
        const coherence::CameraCoherence& camera = report.cameras[i];
        out.cameras.push_back({cameras_[i].name,
                               camera.rms_px,
                               camera.share,
                               static_cast<std::uint32_t>(camera.num_tangencies)});
    }
    if (report.fault) {
        const coherence::NamedFault& fault = *report.fault;
        out.fault = {static_cast<std::uint32_t>(fault.camera),
                     fault.turned_deg.value_or(-1.0),
                     fault.moved_mm.value_or(-1.0),
                     fault.is_either,
                     fault.late_instants,
                     fault.effect_px,
                     {}};
    }
    out.fault.cure = cure_of(report);
    return out;
}

std::string CoherenceWatcher::cure_of(const coherence::Report& report) const {
    if (report.verdict == coherence::Verdict::kLate) return coherence::late_cure(*report.fault);
    if (!is_mendable(report.verdict)) return {};
    const std::string options = options_of(report);
    const std::string cure = refine_command(options);
    // a path that no line of the status may hold
    return bus::is_valid_line(cure) ? cure : command_that_refines("RIG.toml", options, "DIR");
}

void CoherenceWatcher::finish() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
    const coherence::CoherenceWatch::Judgement last = watch_.finish();
    const coherence::Report& report = last.report;
    doubts_rig_ = report.verdict > coherence::Verdict::kCoherent ||
                  (report.verdict == coherence::Verdict::kCoherent && report.rms_px > kNotGood_px);
    if (last.is_told && !is_explained_()) keep(last, due_);
    if (!is_explained_()) tell(last);
    if (report.verdict == coherence::Verdict::kTooLittle) return;
    std::size_t worst = 0;
    for (std::size_t i = 0; i < report.cameras.size(); ++i)
        if (report.cameras[i].rms_px > report.cameras[worst].rms_px) worst = i;
    app::log::info("coherence looks={} rms_px={:.2f} worst={}:{:.2f} cpu_s={:.2f}",
                   watch_.num_looks(),
                   report.rms_px,
                   cameras_[worst].name,
                   report.cameras[worst].rms_px,
                   cpu_s_);
}

}  // namespace atrium::site_node
