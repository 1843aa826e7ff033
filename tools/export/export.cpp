#include "tools/export/export.hpp"

#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/app/progress.hpp"
#include "core/base/write_check.hpp"
#include "tools/export/camera_path.hpp"
#include "tools/export/formats/glb_writer.hpp"
#include "tools/export/formats/numbered_writer.hpp"
#include "tools/export/formats/usd_writer.hpp"
#include "tools/export/frame_source.hpp"
#include "tools/export/ordered_workers.hpp"
#include "viewer/receive/person_decoder.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>
#include <new>
#include <utility>

namespace atrium::exporting {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kFramesForRate = 31;  // a second, to know the rate of a single frame
constexpr std::uint64_t kLeastDiskBytes = 1U << 20U;

// What to export, and how.
struct Plan {
    Selection selection;
    Survey survey;
    std::size_t num_frames = 0;
    std::optional<CameraPath> camera;  // a key per frame
    std::unique_ptr<FrameWriter> writer;
};

tl::unexpected<Error> refuse(const std::string& message) {
    return make_error(ErrorKind::kConfiguration, message);
}

Expected<std::string> site_of(const ExportConfig& config, const recording::WorldFile& world) {
    if (!config.site.empty()) return config.site;
    if (world.sites().size() == 1) return world.sites().front();
    return refuse(fmt::format("site: {} has {}; give one with --site",
                              config.file.string(),
                              world.sites().empty()
                                  ? "no site"
                                  : fmt::format("sites {}", fmt::join(world.sites(), ", "))));
}

// Points of the site into the frame of reference of the export.
geometry::RigidTransform frame_from_site(
    const ExportConfig& config, const std::optional<geometry::RigidTransform>& world_from_site) {
    return config.frame == "world" ? *world_from_site : geometry::RigidTransform{};
}

ExportFacts facts_of(const ExportConfig& config,
                     const recording::WorldFile& world,
                     const Plan& plan) {
    ExportFacts facts;
    facts.site = plan.selection.site;
    facts.frame_of_reference =
        config.frame == "world" ? "world " + world.world() : "site " + plan.selection.site;
    facts.rate_hz = plan.survey.rate_hz;
    facts.source = config.file.filename().string();
    const auto begin =
        static_cast<std::time_t>(plan.survey.frames.front().capture_time.ns / 1'000'000'000);
    facts.begin_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(begin));
    facts.colours_for = config.eye == "path" ? "camera path" : "surface normals";
    facts.generator = "Atrium " + app::version();
    return facts;
}

Expected<std::optional<CameraPath>> camera_path_of(const ExportConfig& config,
                                                   const recording::WorldFile& world,
                                                   const Survey& survey) {
    if (config.path.empty()) return std::nullopt;
    auto path = recording::ViewPath::load(config.path);
    if (!path) return tl::unexpected(path.error());
    const bool zooms = std::ranges::any_of(path->keys(), [&](const recording::ViewKey& key) {
        return key.fov_deg != path->keys().front().fov_deg;
    });
    if (zooms) {
        app::log::warn(
            "camera_path zooms: glTF's cameras do not; the field of view is that of the "
            "first frame");
    }
    const geometry::RigidTransform frame_from_world =
        frame_from_site(config, survey.placement) * survey.placement->inverse();
    return sample_path(*path, survey, world.begin(), frame_from_world);
}

Expected<std::unique_ptr<FrameWriter>> writer_of(const ExportConfig& config,
                                                 const recording::WorldFile& world,
                                                 const Plan& plan) {
    const auto format = format_of(config);
    if (!format) return tl::unexpected(format.error());
    const ExportFacts facts = facts_of(config, world, plan);
    if (*format == "glb") {
        return make_glb_writer({config.output,
                                config.draco,
                                config.quality,
                                std::uint64_t{config.chunk_mb} * 1'000'000,
                                config.chunk_frames},
                               facts,
                               plan.camera);
    }
    if (*format == "usd") {
        return make_usd_writer(
            {config.output, config.quality, plan.survey.time_s(plan.num_frames - 1)}, facts);
    }
    NumberedOptions options;
    options.is_single = is_single_frame(config);
    options.folder = options.is_single ? config.output.parent_path() : config.output;
    options.stem = options.is_single ? config.output.stem().string() : plan.selection.site;
    options.jpeg_quality = config.quality;
    options.num_points = config.points;
    if (*format == "obj") return make_obj_writer(options, facts);
    if (*format == "ply") return make_ply_writer(options, facts);
    return make_points_writer(options, facts);
}

Expected<Plan> make_plan(const ExportConfig& config,
                         const std::shared_ptr<const recording::WorldFile>& world) {
    Plan plan;
    auto site = site_of(config, *world);
    if (!site) return tl::unexpected(site.error());
    const auto time = [&](double value_s) {
        return world->begin() + from_milliseconds(value_s * 1e3);
    };
    plan.selection = {std::move(*site),
                      time(config.from_s),
                      config.to_s > 0.0 ? time(config.to_s) : world->end(),
                      config.every};
    const bool is_single = is_single_frame(config);
    auto seen = survey(world,
                       plan.selection,
                       is_single ? kFramesForRate : std::numeric_limits<std::size_t>::max());
    if (!seen) return tl::unexpected(seen.error());
    plan.survey = std::move(*seen);
    plan.num_frames = is_single ? 1 : plan.survey.frames.size();
    if (!plan.survey.placement && (config.frame == "world" || !config.path.empty())) {
        return refuse(
            fmt::format("{}: {} does not say where site '{}' is in the world; a world "
                        "server places it",
                        config.path.empty() ? "frame" : "path",
                        config.file.string(),
                        plan.selection.site));
    }
    auto camera = camera_path_of(config, *world, plan.survey);
    if (!camera) return tl::unexpected(camera.error());
    plan.camera = std::move(*camera);
    auto writer = writer_of(config, *world, plan);
    if (!writer) return tl::unexpected(writer.error());
    plan.writer = std::move(*writer);
    return plan;
}

// Decodes and encodes one frame, on a worker.
struct Scratch {
    viewer::PersonDecodeScratch decode;
    renderer::PersonModel model;
};
Expected<EncodedFrame> encode_frame(const ExportConfig& config,
                                    const Plan& plan,
                                    const recording::SiteFrame& frame,
                                    const FrameTime& time,
                                    Scratch& scratch) {
    if (frame.mesh.draco.empty()) {
        scratch.model = {};
    } else {
        auto decoded = viewer::decode_person({frame.mesh, frame.textures},
                                             *frame.description,
                                             {},
                                             {},
                                             scratch.decode,
                                             scratch.model);
        if (!decoded) return tl::unexpected(decoded.error());
    }
    std::optional<geometry::RigidTransform> world_from_site;
    if (frame.placement) world_from_site = frame.placement->world_from_site;
    if (config.frame == "world" && !world_from_site)
        return make_error(ErrorKind::kInvalidData, "the site has no place in the world");
    PosedPerson person{scratch.model, frame_from_site(config, world_from_site), {}};
    if (config.eye == "path") {
        const CameraKey& key = plan.camera->keys[time.number - 1];
        person.eye_site =
            (person.frame_from_site.inverse() * key.frame_from_camera.translation).cast<float>();
    }
    return plan.writer->encode(person, time);
}

struct Counts {
    std::size_t frames = 0;
    std::uint64_t refused = 0;
};

class Export {
public:
    Export(const ExportConfig& config, Plan& plan, Timestamp recording_begin)
        : config_(config),
          plan_(plan),
          recording_begin_(recording_begin),
          scratches_(config.threads > 0 ? config.threads
                                        : std::max(1U, std::thread::hardware_concurrency())),
          workers_(scratches_.size()) {}

    // False: stopped before the end.
    Expected<bool> run(FrameSource& source, const std::stop_token& stop) {
        app::Progress progress("frame", plan_.num_frames);
        for (std::size_t number = 1; number <= plan_.num_frames; ++number) {
            auto frame = source.next();
            if (!frame) break;
            submit(std::move(*frame), number);
            while (workers_.num_open() > scratches_.size() + 1) {
                if (auto done = take(); !done) return tl::unexpected(done.error());
            }
            if (stop.stop_requested()) return false;
            if (const auto line = progress.update(number - workers_.num_open()))
                app::log::info("{}", *line);
        }
        while (workers_.num_open() > 0) {
            if (auto done = take(); !done) return tl::unexpected(done.error());
            if (stop.stop_requested()) return false;
        }
        return true;
    }
    const Counts& counts() const { return counts_; }

private:
    void submit(recording::SiteFrame frame, std::size_t number) {
        const FrameTime time{number,
                             plan_.survey.time_s(number - 1),
                             std::chrono::duration<double>(frame.time - recording_begin_).count(),
                             frame.mesh.capture_time};
        workers_.submit(
            [this, time, frame = std::make_shared<recording::SiteFrame>(std::move(frame))](
                std::size_t worker) {
                return encode_frame(config_, plan_, *frame, time, scratches_[worker]);
            });
    }
    Expected<EncodedFrame> taken() {
        try {
            return workers_.take();
        } catch (const std::bad_alloc&) {
            return make_error(ErrorKind::kInternal,
                              "out of memory; use fewer --threads, or a smaller --chunk_mb");
        }
    }
    Expected<void> take() {
        Expected<EncodedFrame> frame = taken();
        if (!frame) {
            if (frame.error().kind != ErrorKind::kInvalidData) return tl::unexpected(frame.error());
            ++counts_.refused;
            refusals_.warn("frame_refused reason=\"" + frame.error().message + "\"");
            return {};
        }
        ++counts_.frames;
        return plan_.writer->add(std::move(*frame));
    }

    const ExportConfig& config_;
    Plan& plan_;
    Timestamp recording_begin_;
    std::vector<Scratch> scratches_;
    Counts counts_;
    app::log::OncePerSecond refusals_;
    OrderedWorkers<Expected<EncodedFrame>> workers_;  // last: its threads use the members above
};

Expected<void> check_place(const ExportConfig& config) {
    const std::filesystem::path folder = is_single_frame(config) || config.output.has_extension()
                                             ? config.output.parent_path()
                                             : config.output;
    return check_folder_writable(folder.empty() ? "." : folder, kLeastDiskBytes, "output");
}

}  // namespace

Expected<void> run_export(const ExportConfig& config, std::stop_token stop) {
    auto world = recording::WorldFile::open(config.file);
    if (!world) return tl::unexpected(world.error());
    for (const std::string& line : (*world)->warnings()) app::log::warn("{}", line);
    auto plan = make_plan(config, *world);
    if (!plan) return tl::unexpected(plan.error());
    if (auto writable = check_place(config); !writable) return writable;
    const Survey& survey = plan->survey;
    if (survey.num_refused + survey.num_damaged > 0) {
        app::log::warn("left_out refused={} damaged={} reason=\"{}\": their frames are missing",
                       survey.num_refused,
                       survey.num_damaged,
                       survey.num_damaged > 0 ? survey.damage : "samples that cannot be read");
    }
    auto source = FrameSource::open(*world, plan->selection);
    if (!source) return tl::unexpected(source.error());
    const Clock::time_point begin = Clock::now();
    Export work(config, *plan, (*world)->begin());
    const auto complete = work.run(*source, stop);
    if (!complete) return tl::unexpected(complete.error());
    const Counts& counts = work.counts();
    if (!*complete) {
        return make_error(
            ErrorKind::kInternal,
            fmt::format("stopped after {} of {} frames; what is not whole was removed",
                        counts.frames,
                        plan->num_frames));
    }
    if (counts.frames == 0) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: no frame of site '{}' could be read (refused {})",
                                      config.file.string(),
                                      plan->selection.site,
                                      counts.refused));
    }
    const auto written = plan->writer->finish();
    if (!written) return tl::unexpected(written.error());
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    const auto num_frames = static_cast<double>(counts.frames);
    app::log::info(
        "exported site={} frames={} files={} mb={:.1f} mb_per_frame={:.3f} seconds={:.1f} "
        "s_per_frame={:.3f} incomplete={} refused={} damaged={} output={}",
        plan->selection.site,
        counts.frames,
        written->files.size(),
        static_cast<double>(written->bytes) / 1e6,
        static_cast<double>(written->bytes) / 1e6 / num_frames,
        seconds,
        seconds / num_frames,
        source->num_left_out(),
        counts.refused + survey.num_refused,
        survey.num_damaged,
        // several .glb have numbers in their names
        (config.output.extension() == ".glb" ? written->files.front() : config.output).string());
    return {};
}

}  // namespace atrium::exporting
