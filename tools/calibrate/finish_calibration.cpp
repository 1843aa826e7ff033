#include "tools/calibrate/finish_calibration.hpp"

#include "tools/calibrate/calibrated_rig.hpp"
#include "tools/calibrate/front.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"
#include "tools/calibrate/report/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string_view>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

// A tape over some metres is good to a hundredth.
constexpr double kTape = 0.01;

void add(std::vector<std::string>& to, const std::vector<std::string>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

config::Rig rig_of(const Bundle& bundle, double rate_hz) {
    config::Rig rig;
    for (const BundleCamera& camera : bundle.cameras)
        rig.cameras.push_back({camera.name, camera.intrinsics(), camera.camera_from_world()});
    rig.rate_hz = rate_hz;
    return rig;
}

class Finish {
public:
    Finish(const WandSolution& solution, Verdict verdict, const FinishOptions& options)
        : solution_(solution), options_(options), said_(options.said) {
        report_.told = std::move(verdict.told);
        report_.checks = std::move(verdict.checks);
        report_.problems = std::move(verdict.problems);
        has_scale_ = solution.bundle.wand.size() > 1;
    }

    Expected<void> run(const std::optional<PreviousRig>& previous) {
        if (auto given = give_frame(previous); !given) return given;
        if (previous && has_scale_) compare(*previous);
        describe();
        print(sentences());
        const auto written = write();
        if (!written) report_.outcome = written.error().message;
        const fs::path page = options_.report.empty()
                                  ? options_.output.parent_path() / "calibration.html"
                                  : options_.report;
        if (auto done = write_report(report_, page); !done) return done;
        fmt::print("report: {}\n", page.string());
        return written;
    }

private:
    // As cameras of another program that are known to be in metres.
    ForeignRig as_foreign(const config::Rig& cameras) const {
        ForeignRig rig;
        rig.format = has_scale_ ? options_.body : options_.body + " with one light";
        rig.is_sure_of_poses = true;
        rig.units = "m";
        rig.has_scale = has_scale_;
        rig.has_frame = false;
        for (const geometry::CalibratedCamera& camera : cameras.cameras) {
            ForeignCamera foreign;
            foreign.name = camera.name;
            foreign.lens = camera.intrinsics;
            foreign.has_lens = true;
            foreign.pose = foreign_pose(camera.camera_from_site, rig.documented);
            rig.cameras.push_back(std::move(foreign));
        }
        return rig;
    }

    Expected<void> give_frame(const std::optional<PreviousRig>& previous) {
        const config::Rig solved = rig_of(solution_.bundle, said_.rate_hz);
        ForeignRig foreign = as_foreign(solved);
        bool keeps_frame = false;
        if (previous && has_scale_) {
            const RigComparison compared = compare_rigs(previous->rig, solved);
            keeps_frame = compared.shares_frame() && said_.up.empty() && said_.heights.empty();
            if (keeps_frame) {
                foreign = as_foreign(in_frame_of_old(solved, compared));
                foreign.has_frame = true;
                foreign.up = "+Z";
                report_.told.push_back(
                    fmt::format("frame: as in {}, in which {} of {} cameras stand where they do",
                                previous->file.filename().string(),
                                compared.num_staying(),
                                compared.moves.size()));
            } else if (!options_.frame_of.empty()) {
                report_.problems.push_back(fmt::format(
                    "the frame of {} cannot be kept: {}",
                    previous->file.string(),
                    compared.shares_frame()
                        ? "--up or --camera-height give another one; leave them out"
                        : "fewer than three, or than half, of its cameras stand where they did; "
                          "leave --frame-of out"));
            }
        }
        if (!has_scale_ && !options_.frame_of.empty())
            report_.problems.push_back(
                fmt::format("the frame of {} cannot be kept: one light gives no scale to compare "
                            "the rigs with; leave --frame-of out",
                            options_.frame_of.string()));
        if (has_scale_) {
            check_tape(solved);
            check_lengths(solved);
        }
        auto conclusion = conclude(foreign, said_);
        if (!conclusion) return tl::unexpected(conclusion.error());
        rig_ = std::move(conclusion->rig);
        if (auto turned = turn_front(keeps_frame); !turned) return turned;
        if (keeps_frame && options_.front.empty() && previous->rig.has_bounds) {
            rig_.bounds_site = previous->rig.bounds_site;
            rig_.has_bounds = true;
        }
        // what poses mean is no question here
        std::erase_if(conclusion->told,
                      [](const std::string& line) { return line.starts_with("poses: "); });
        add(report_.told, conclusion->told);
        add(report_.checks, conclusion->checks);
        add(report_.problems, conclusion->problems);
        return {};
    }

    // Where +X points is chance, unless the frame was there before. People look along it.
    Expected<void> turn_front(bool keeps_frame) {
        if (keeps_frame && options_.front.empty()) return {};
        const std::string& name = options_.front.empty() ? rig_.cameras[0].name : options_.front;
        if (!turn_front_towards(name, rig_.cameras))
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("--front {}: no camera has this name", name));
        const std::string text = front_text(name);
        if (options_.front.empty())
            report_.checks.push_back(text + "; another camera: --front NAME");
        else
            report_.told.push_back(text);
        return {};
    }

    // The file of another wand or board makes a rig of another size, whose errors are as small.
    void check_lengths(const config::Rig& rig) {
        const double distance_m = measure_convergence(rig.cameras).median_distance;
        if (!is_small_room(distance_m)) return;
        report_.checks.push_back(fmt::format(
            "lengths: {} m from the cameras to the place that they look at is small "
            "for a person: is the file of {} that of the one which they saw, in metres?",
            length_text(distance_m),
            options_.body));
    }

    // The wand has a scale, so a measured distance is not needed for one: it checks the wand.
    void check_tape(const config::Rig& rig) {
        if (!said_.distance) return;
        const auto find = [&](const std::string& name) {
            return std::ranges::find(rig.cameras, name, &geometry::CalibratedCamera::name);
        };
        const auto from = find(said_.distance->from), to = find(said_.distance->to);
        if (from == rig.cameras.end() || to == rig.cameras.end()) return;  // `conclude` names it
        const double apart = (from->centre_site() - to->centre_site()).norm();
        const double ratio = apart / said_.distance->metres;
        if (std::abs(ratio - 1.0) > kTape) {
            report_.problems.push_back(fmt::format(
                "{} to {} is {:.3f} m by {}, and {} m as you say: measure the lengths of the wand "
                "or board, and this distance, again",
                said_.distance->from,
                said_.distance->to,
                apart,
                options_.body,
                said_.distance->metres));
        } else {
            report_.told.push_back(fmt::format("{} to {} is {:.3f} m, {:.1f} % off your tape",
                                               said_.distance->from,
                                               said_.distance->to,
                                               apart,
                                               100.0 * std::abs(ratio - 1.0)));
        }
        said_.distance.reset();
    }

    void compare(const PreviousRig& previous) {
        report_.previous = previous.file.string();
        report_.previous_rig = previous.rig;
        report_.comparison = compare_rigs(previous.rig, rig_);
        const ComparisonVerdict verdict =
            judge_against(previous, *report_.comparison, solution_.bundle, rig_);
        add(report_.told, verdict.told);
        add(report_.checks, verdict.checks);
        add(report_.problems, verdict.problems);
        // a measured height, or another direction, is asked for whatever the old rig is worth
        const bool has_new_frame =
            !said_.up.empty() || !said_.heights.empty() || !options_.front.empty();
        is_still_true_ = previous.is_output && verdict.is_still_true && !has_new_frame;
    }

    // What the page shows of each camera, in the frame of the rig.
    void describe() {
        const Bundle& bundle = solution_.bundle;
        // the verdict on the errors alone came before
        constexpr std::string_view kGoodErrors = "good: ";
        if (!report_.problems.empty() && report_.told.front().starts_with(kGoodErrors))
            report_.told.front().replace(
                0, kGoodErrors.size(), "wrong, though its errors are small: ");
        report_.command = options_.command;
        report_.source = options_.source;
        report_.date = fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(std::time(nullptr)));
        report_.grade = !report_.problems.empty()                       ? Grade::kWrong
                        : report_.told.front().starts_with(kGoodErrors) ? Grade::kGood
                                                                        : Grade::kUsable;
        std::vector<std::size_t> place(bundle.cameras.size(), 0);
        for (std::size_t c = 0; c < bundle.cameras.size(); ++c) {
            const auto found = std::ranges::find(
                rig_.cameras, bundle.cameras[c].name, &geometry::CalibratedCamera::name);
            if (found == rig_.cameras.end()) continue;
            const CameraFigures& figures = solution_.cameras[c];
            ReportedCamera one;
            one.camera = *found;
            one.held_out_px = figures.held_out_px;
            one.rms_px = figures.rms_px;
            one.middle_mm = figures.middle_mm;
            one.coverage = figures.coverage;
            one.late_instants = figures.late_instants;
            one.num_used = figures.num_used;
            one.num_outliers = figures.num_outliers;
            place[c] = report_.cameras.size();
            report_.cameras.push_back(std::move(one));
        }
        for (const Sighting& sighting : bundle.sightings) {
            const Eigen::Vector2d error = error_px(bundle, sighting);
            if (error.allFinite())
                report_.cameras[place[sighting.camera]].errors.push_back(
                    {sighting.px, error, !sighting.is_used});
        }
        const auto [site_from_world, scale] = site_of_world();
        for (const WandPose& wand : bundle.wands)
            if (wand.is_placed)
                report_.seen_site.push_back(site_from_world *
                                            (scale * wand.world_from_wand.translation));
    }

    // From the frame of the solution to that of the rig, which may have another scale.
    std::pair<geometry::RigidTransform, double> site_of_world() const {
        const auto& solved = solution_.bundle.cameras;
        double before = 0.0, now = 0.0;
        for (std::size_t c = 1; c < solved.size(); ++c) {
            before += (solved[c].centre_world() - solved[0].centre_world()).norm();
            now += (rig_.cameras[c].centre_site() - rig_.cameras[0].centre_site()).norm();
        }
        const double scale = before > 0.0 ? now / before : 1.0;
        geometry::RigidTransform camera_from_world = solved[0].camera_from_world();
        camera_from_world.translation *= scale;
        return {rig_.cameras[0].camera_from_site.inverse() * camera_from_world, scale};
    }

    Expected<void> write() {
        if (is_still_true_ && report_.problems.empty() && !options_.force) {
            report_.outcome = fmt::format(
                "kept {}: it explains what was seen as well as the new rig; --force replaces it",
                options_.output.string());
        } else {
            auto done = write_rig(sentences(), rig_, options_.output, options_.force);
            if (!done) return tl::unexpected(done.error());
            report_.outcome = std::move(*done);
        }
        fmt::print("{}\n", report_.outcome);
        return {};
    }

    RigReport sentences() const {
        return {fmt::format("Calibrated from {} by `{}`.", options_.source, options_.command),
                report_.told,
                report_.checks,
                report_.problems};
    }

    const WandSolution& solution_;
    const FinishOptions& options_;
    Said said_;
    bool has_scale_ = true;
    config::Rig rig_;
    bool is_still_true_ = false;
    CalibrationReport report_;
};

}  // namespace

Expected<void> finish_calibration(const WandSolution& solution,
                                  Verdict verdict,
                                  const std::optional<PreviousRig>& previous,
                                  const FinishOptions& options) {
    return Finish(solution, std::move(verdict), options).run(previous);
}

}  // namespace atrium::calibrate
