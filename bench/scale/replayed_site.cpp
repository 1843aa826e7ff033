#include "bench/scale/coded_stream.hpp"
#include "bench/scale/viewer_guests.hpp"
#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "core/presence/join_world.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <optional>

// A site without cameras. It writes a coded stream at 30 Hz in a loop, through the same writers and
// with the same samples as a real site. It receives the viewers' reports, but always sends at full
// quality. At its end it prints its published frames, "published ID CAPTURE_NS". A capture is the
// instant before the first write of its frame.
namespace {

using namespace atrium;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPeriod = std::chrono::nanoseconds(1s) / 30;

template <typename T>
T value(Expected<T> expected) {
    if (expected) return std::move(*expected);
    std::exit(app::fail(expected.error()));
}

struct Published {
    std::uint64_t id;
    std::int64_t capture_ns;
};

class ReplayedSite {
public:
    ReplayedSite(const bus::Participant& participant,
                 const std::string& name,
                 bench::CodedStream stream)
        : stream_(std::move(stream)),
          description_(value(bus::Writer<bus::SiteDescription>::create(participant))),
          mesh_(value(bus::Writer<bus::SiteMesh>::create(participant))),
          status_(value(bus::Writer<bus::SiteStatus>::create(participant))),
          feedback_(value(bus::Reader<bus::StreamFeedback>::create(participant))) {
        for (std::size_t i = 0; i < stream_.description.cameras.size(); ++i)
            textures_.push_back(value(bus::Writer<bus::CameraTexture>::create(participant)));
        stream_.description.site = site_status_.site = name;
        for (auto& frame : stream_.frames) {
            frame.mesh.site = name;
            for (auto& texture : frame.textures) texture.site = name;
        }
        published_.reserve(1U << 14U);
    }

    void run(std::stop_token stop) {
        static_cast<void>(value(description_.write(stream_.description)));
        std::mutex mutex;
        std::condition_variable_any never;
        auto due = Clock::now();
        auto status_due = due + 1s;
        for (std::uint64_t id = 1; !stop.stop_requested(); ++id) {
            feedback_.take([this](bus::StreamFeedback&&) { ++num_feedback_; });
            publish(id);
            if (Clock::now() >= status_due) {
                status_due += 1s;
                tell();
            }
            // skips late metaframes, as a site does
            for (due += kPeriod; due < Clock::now(); due += kPeriod) ++num_late_;
            std::unique_lock lock(mutex);
            never.wait_until(lock, stop, due, [] { return false; });
        }
    }

    void report() const {
        for (const Published& frame : published_)
            fmt::print("published {} {}\n", frame.id, frame.capture_ns);
        fmt::print("failed {}\nlate {}\nfeedback {}\n", num_failed_, num_late_, num_feedback_);
    }

private:
    void publish(std::uint64_t id) {
        auto& frame = stream_.frames[id % stream_.frames.size()];
        const Timestamp now = Timestamp::now();
        bool all_written = true;
        for (auto& texture : frame.textures) {
            texture.frame_id = id;
            texture.capture_time = now;
            all_written = write(textures_[texture.camera], texture) && all_written;
        }
        frame.mesh.frame_id = id;
        frame.mesh.capture_time = now;
        if (write(mesh_, frame.mesh) && all_written) published_.push_back({id, now.ns});
    }

    bool write(auto& writer, const auto& message) {
        const auto written = writer.write(message);
        if (written) {
            site_status_.num_bytes_published += *written;
        } else {
            ++num_failed_;
            complaints_.warn(written.error().message);
        }
        return written.has_value();
    }

    void tell() {
        site_status_.time = Timestamp::now();
        site_status_.num_metaframes_captured = site_status_.num_metaframes_published =
            published_.size();
        site_status_.resident_bytes = app::resident_bytes();
        if (const auto written = status_.write(site_status_); !written)
            complaints_.warn(written.error().message);
    }

    bench::CodedStream stream_;
    bus::Writer<bus::SiteDescription> description_;
    bus::Writer<bus::SiteMesh> mesh_;
    bus::Writer<bus::SiteStatus> status_;
    bus::Reader<bus::StreamFeedback> feedback_;
    std::vector<bus::Writer<bus::CameraTexture>> textures_;  // one per camera
    bus::SiteStatus site_status_;
    std::vector<Published> published_;
    std::uint64_t num_failed_ = 0;
    std::uint64_t num_late_ = 0;
    std::uint64_t num_feedback_ = 0;
    app::log::OncePerSecond complaints_;
};

}  // namespace

int main(int argc, char** argv) {
    const app::StopOnSignal stop;
    bus::BusOptions bus_options;
    std::string name = "replayed";
    std::filesystem::path file = "stream.coded";
    bool code = false;
    int num_cameras = 0;
    int subdivide = 0;
    bool absurd = false;
    config::OptionSet options;
    bus::declare(bus_options, options);
    options.add("name", name, "name of the site");
    options.add("stream", file, "coded stream, as --code makes it");
    options.add("code", code, "code the simulated room and keep it, instead of publishing");
    options.add("cameras", num_cameras, "the textures again until there are so many", {0, 64});
    options.add("subdivide", subdivide, "each triangle cut into four, so many times over", {0, 3});
    options.add("absurd", absurd, "cameras and meshes that nothing real is like");
    const app::Start start =
        app::start({.name = "replayed_site",
                    .summary = "Publishes a coded stream again and again, as a site would.",
                    .examples = "  replayed_site --stream F --code true\n"
                                "  replayed_site --stream F --name a\n"},
                   options,
                   argc,
                   argv);
    if (!start.go_on) return start.exit_code;
    if (code) {
        const auto saved = bench::save(value(bench::code_simulated_person()), file);
        return saved ? 0 : app::fail(saved.error());
    }
    auto stream = value(bench::load_coded_stream(file));
    bench::repeat_cameras(static_cast<std::size_t>(num_cameras), stream);
    if (subdivide > 0)
        if (const auto done = bench::subdivide_meshes(subdivide, stream); !done)
            return app::fail(done.error());
    if (absurd)
        if (const auto done = bench::make_absurd(stream); !done) return app::fail(done.error());
    const auto participant = value(bus::Participant::create(bus_options));
    ReplayedSite site(participant, name, std::move(stream));
    const auto membership = value(presence::join_world(
        participant,
        bus::ProgramKind::kSiteNode,
        name,
        [](const Error& lost) { app::log::warn("{}", lost.message); },
        stop.token()));
    fmt::print("ready\n");
    std::fflush(stdout);
    site.run(stop.token());
    site.report();
    return 0;
}
