// Runs the work of each program for one metaframe, the same each time: instructions.sh counts its
// instructions. The input is fixed: the demo's site of alice and the demo's world. One thread, no
// network, and no clock that decides anything.
//
//   metaframe_work prepare FOLDER        renders the room, codes its person, keeps both
//   metaframe_work site FOLDER NUM       8 pictures -> coded mesh and textures
//   metaframe_work site-time FOLDER NUM  the same: processor time of one, and a hash of results
//   metaframe_work world FOLDER NUM      coded meshes of two sites -> people -> 4 steps
//   metaframe_work viewer FOLDER NUM     coded frames of two sites -> people -> a drawn picture
//
// NUM metaframes count, measured by valgrind's callgrind with --instr-atstart=no. Some uncounted
// ones come first: they cover startup, caches and shader compilation.
#include "bench/scale/coded_stream.hpp"
#include "core/app/program.hpp"
#include "core/base/executor.hpp"
#include "core/base/fnv1a.hpp"
#include "core/gl/offscreen_context.hpp"
#include "site_node/config.hpp"
#include "site_node/source/open_source.hpp"
#include "site_node/start_check.hpp"
#include "viewer/receive/person_decoder.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "world_server/config.hpp"
#include "world_server/simulation.hpp"
#include "world_server/site_reader.hpp"

#include <fmt/format.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

using namespace std::chrono_literals;

constexpr int kWarmUp = 4;        // metaframes that are not counted
constexpr int kMostCounted = 16;  // maximum NUM for the files of `prepare`
// of the loop: alice's hand moves towards the object that it pushes
constexpr std::size_t kFirst = 30;
constexpr std::size_t kBobLater = 8;  // bob's person is alice's, this many instants later
constexpr auto kPeriod = 33'333'333ns;
constexpr int kTicksPerMetaframe = 4;
constexpr int kPicturesPerRead = 3;  // the demo's video has 10 pictures/s
constexpr const char* kSite = ATRIUM_SOURCE_DIR "/deploy/sites/alice.toml";
constexpr const char* kWorld = ATRIUM_SOURCE_DIR "/deploy/worlds/demo.toml";

[[noreturn]] void fail(const Error& error) { std::exit(app::fail(error)); }

template <typename T>
T value(Expected<T> expected) {
    if (!expected) fail(expected.error());
    return std::move(*expected);
}

void expect(const Expected<void>& done) {
    if (!done) fail(done.error());
}

Timestamp time_of(std::size_t metaframe) {
    return Timestamp{1'000'000'000} + static_cast<std::int64_t>(metaframe) * kPeriod;
}

std::string coded_file(const std::filesystem::path& folder) { return folder / "person.coded"; }

void read_options(const char* program,
                  const config::OptionSet& options,
                  const char* file,
                  const app::ReadMore& read_more) {
    std::array<std::string, 3> words{program, "--config", file};
    std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
    const app::ProgramInfo info{program, "", ""};
    const app::Start start = app::start(info, options, 3, arguments.data(), read_more);
    if (!start.go_on) std::exit(start.exit_code);
}

// As in site_node.
site_node::SiteNodeConfig site_config(const std::filesystem::path& folder) {
    site_node::SiteNodeConfig config;
    config::OptionSet options;
    site_node::declare(config, options);
    read_options("site_node", options, kSite, [&](config::TableReader& reader) {
        site_node::read_hull(reader, config);
        site_node::read_segmentation(reader, config.pipeline);
        site_node::read_cameras(reader, config.capture.cameras);
    });
    site_node::resolve(config);
    config.simulation.cache = folder / "rooms";
    return config;
}

// As in world_server.
world_server::WorldServerConfig world_config() {
    world_server::WorldServerConfig config;
    config::OptionSet options;
    world_server::declare(config, options);
    read_options("world_server", options, kWorld, [&](config::TableReader& reader) {
        world_server::read_world(reader, config);
    });
    expect(world_server::check(config));
    return config;
}

/// Counts instructions between its construction and its end.
class Counted {
public:
    Counted() { CALLGRIND_START_INSTRUMENTATION; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    ~Counted() { CALLGRIND_STOP_INSTRUMENTATION; }
};

// Calls work(metaframe) for the warm-up, then for `num` counted metaframes.
template <typename Work>
void count(int num, Work&& work) {
    for (std::size_t i = 0; i < kWarmUp; ++i) work(i);
    const Counted counted;
    for (std::size_t i = 0; i < static_cast<std::size_t>(num); ++i) work(kWarmUp + i);
}

struct Site {
    explicit Site(const std::filesystem::path& folder)
        : config(site_config(folder)),
          source(value(site_node::open_source(config.capture, config.simulation, {}))),
          pipeline(create_pipeline()) {}

    site_node::Pipeline create_pipeline() {
        site_node::take_bounds(source->rig(), config.pipeline.hull);
        return value(site_node::Pipeline::create(*source, config.pipeline, {}));
    }

    // `num` metaframes of the loop, from kFirst on
    std::vector<capture::Metaframe> metaframes(std::size_t num) {
        const std::size_t num_cameras = source->rig().cameras.size();
        std::vector<capture::Metaframe> metaframes(num);
        std::size_t num_pictures = 0;
        std::stop_source stop;
        expect(source->run(stop.get_token(), [&](capture::CameraFrame frame) {
            const std::size_t instant = num_pictures++ / num_cameras;
            if (instant < kFirst) return;
            if (instant - kFirst == num) return stop.request_stop(), void();
            if (instant - kFirst > num) return;
            capture::Metaframe& metaframe = metaframes[instant - kFirst];
            metaframe.frame_id = instant;
            frame.capture_time = metaframe.capture_time = time_of(instant);
            metaframe.frames.push_back(std::move(frame));
        }));
        return metaframes;
    }

    site_node::SiteNodeConfig config;
    std::unique_ptr<capture::FrameSource> source;
    site_node::Pipeline pipeline;
};

void prepare(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    Site site(folder);
    CodedStream stream;
    stream.description.cameras = site.source->rig().cameras;
    stream.description.bounds_site = site.source->rig().bounds_site;
    SerialExecutor executor;
    site_node::SiteFrame coded;
    for (const auto& metaframe : site.metaframes(kWarmUp + kMostCounted + kBobLater)) {
        expect(site.pipeline.process(metaframe, executor, coded));
        stream.frames.push_back(to_frame(coded));
    }
    expect(save(stream, coded_file(folder)));
}

void run_site(const std::filesystem::path& folder, int num) {
    Site site(folder);
    const auto metaframes = site.metaframes(static_cast<std::size_t>(kWarmUp + num));
    SerialExecutor executor;
    site_node::SiteFrame coded;
    std::size_t num_triangles = 0;
    std::size_t num_bytes = 0;
    count(num, [&](std::size_t i) {
        expect(site.pipeline.process(metaframes[i], executor, coded));
        num_triangles += coded.hull.mesh.triangles.size();
        num_bytes += coded.draco.size();
    });
    fmt::print("triangles {} mesh_bytes {}\n", num_triangles, num_bytes);
}

double processor_ms() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

template <typename Value>
void add(const std::vector<Value>& values, Fnv1a& hash) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(Value); ++i) hash.add(bytes[i]);
}

// The least time of a metaframe, over rounds of the same ones: other programs disturb it.
void time_site(const std::filesystem::path& folder, int num) {
    constexpr int kRounds = 12;
    Site site(folder);
    const auto metaframes = site.metaframes(static_cast<std::size_t>(num));
    SerialExecutor executor;
    site_node::SiteFrame coded;
    Fnv1a meshes;
    Fnv1a textures;
    double least_ms = 1e9;
    for (int round = 0; round < kRounds; ++round) {
        double ms = 0.0;
        for (const capture::Metaframe& metaframe : metaframes) {
            const double begin_ms = processor_ms();
            expect(site.pipeline.process(metaframe, executor, coded));
            ms += processor_ms() - begin_ms;
            add(coded.hull.mesh.vertices, meshes);
            add(coded.hull.mesh.triangles, meshes);
            add(coded.draco, meshes);
            for (const site_node::CodedCamera& camera : coded.cameras) {
                add(camera.texture.colour, textures);
                add(camera.texture.mask, textures);
            }
        }
        least_ms = std::min(least_ms, ms / num);
    }
    fmt::print("processor_ms {:.3f} meshes {:016x} textures {:016x}\n",
               least_ms,
               meshes.value(),
               textures.value());
}

// The messages of both sites for one metaframe.
bus::SiteMesh mesh_of(const CodedStream& stream, const std::string& site, std::size_t metaframe) {
    const std::size_t at = metaframe + (site == "bob" ? kBobLater : 0);
    bus::SiteMesh mesh = stream.frames[at].mesh;
    mesh.site = site;
    mesh.frame_id = metaframe + 1;
    mesh.capture_time = time_of(metaframe);
    return mesh;
}

void run_world(const std::filesystem::path& folder, int num) {
    const CodedStream stream = value(load_coded_stream(coded_file(folder)));
    const world_server::WorldServerConfig config = world_config();
    std::map<std::string, world_server::SiteReader> readers;
    for (const world_server::NamedPlacement& placement : config.placements)
        readers.try_emplace(placement.site, placement.world_from_site, config.person);
    world_server::Simulation simulation(
        config, value(world_server::Scene::create(config)), [](const std::string&) {});
    count(num, [&](std::size_t i) {
        for (auto& [site, reader] : readers)
            simulation.people().put(site, value(reader.read(mesh_of(stream, site, i))));
        for (int tick = 0; tick < kTicksPerMetaframe; ++tick)
            simulation.step(time_of(i) + tick * kPeriod / kTicksPerMetaframe);
    });
    bus::WorldStatus status;
    simulation.fill(status);
    fmt::print("steps {} contacts {}\n", status.num_steps, status.num_contacts);
}

void put_things(const world_server::WorldServerConfig& config, renderer::SceneRenderer& scene) {
    using renderer::ShapeKind;
    for (const world_server::WorldObject& object : config.objects) {
        renderer::ObjectLook look;
        switch (object.rigid.shape) {
            case physics::ObjectShape::kSphere:
                look.shape = ShapeKind::kSphere;
                break;
            case physics::ObjectShape::kCylinder:
                look.shape = ShapeKind::kCylinder;
                break;
            case physics::ObjectShape::kCapsule:
                look.shape = ShapeKind::kCapsule;
                break;
            case physics::ObjectShape::kPlane:
                look.shape = ShapeKind::kPlane;
                break;
            default:
                look.shape = ShapeKind::kBox;
        }
        look.size_m = object.rigid.size_m;
        look.colour = object.look.colour;
        look.world_from_object = object.rigid.world_from_object;
        scene.set_object(object.rigid.id, look);
    }
}

viewer::FramePair pair_of(const CodedStream& stream,
                          const std::string& site,
                          std::size_t metaframe) {
    viewer::FramePair pair;
    pair.mesh = mesh_of(stream, site, metaframe);
    pair.textures = stream.frames[metaframe + (site == "bob" ? kBobLater : 0)].textures;
    return pair;
}

void run_viewer(const std::filesystem::path& folder, int num) {
    setenv("LP_NUM_THREADS", "0", 1);  // llvmpipe draws in the calling thread
    const CodedStream stream = value(load_coded_stream(coded_file(folder)));
    const world_server::WorldServerConfig world = world_config();
    const auto context = value(gl::OffscreenContext::create(16, 16));
    auto scene = value(renderer::SceneRenderer::create({.width = 960, .height = 540}));
    // deploy/viewer.toml
    const renderer::ViewCamera camera{
        .position_m = {1.9, -3.7, 1.75}, .target_m = {0.0, 0.0, 0.92}, .fov_deg = 36.0};
    scene.warm_up(camera);
    put_things(world, scene);
    for (const world_server::NamedPlacement& placement : world.placements)
        scene.set_site_pose(placement.site, placement.world_from_site);
    const std::array<std::string, 2> sites{"alice", "bob"};
    std::array<std::array<Eigen::Vector3f, 1>, 2> eyes;
    for (std::size_t k = 0; k < sites.size(); ++k) {
        const Eigen::Isometry3d world_from_site(scene.world_from_site(sites[k]));
        eyes[k] = {Eigen::Vector3f((world_from_site.inverse() * camera.position_m).cast<float>())};
    }
    viewer::PersonDecodeScratch scratch;
    std::array<renderer::PersonModel, 2> spare;
    renderer::RenderedPicture picture;
    count(num, [&](std::size_t i) {
        for (std::size_t k = 0; k < sites.size(); ++k) {
            renderer::PersonModel& model = spare[k];
            expect(viewer::decode_person(
                pair_of(stream, sites[k], i), stream.description, {}, eyes[k], scratch, model));
            model = scene.set_person(sites[k], std::move(model));
        }
        scene.draw(camera);
        if (i % kPicturesPerRead == 0) scene.read_pixels(picture);
    });
    scene.read_pixels(picture);
    std::uint64_t sum = 0;
    for (const std::uint8_t sample : picture.rgba) sum += sample;
    fmt::print("mean_sample {:.2f}\n",
               static_cast<double>(sum) / static_cast<double>(picture.rgba.size()));
}

int run(const std::vector<std::string>& arguments) {
    const bool prepares = arguments.size() == 2 && arguments[0] == "prepare";
    if (prepares) {
        prepare(arguments[1]);
        return 0;
    }
    const int num = arguments.size() == 3 ? std::atoi(arguments[2].c_str()) : 0;
    if (num >= 1 && num <= kMostCounted) {
        if (arguments[0] == "site") return run_site(arguments[1], num), 0;
        if (arguments[0] == "site-time") return time_site(arguments[1], num), 0;
        if (arguments[0] == "world") return run_world(arguments[1], num), 0;
        if (arguments[0] == "viewer") return run_viewer(arguments[1], num), 0;
    }
    fmt::print(
        stderr,
        "usage: metaframe_work prepare FOLDER\n"
        "       metaframe_work site|site-time|world|viewer FOLDER NUM    NUM metaframes, 1 to {}\n",
        kMostCounted);
    return 2;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run({argv + 1, argv + argc}); }
