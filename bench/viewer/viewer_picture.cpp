// Processor time of a viewer's picture in software, part by part: two coded people among a few
// objects, drawn with OSMesa. Each row adds one kind of work to the previous row.
#include "bench/scale/coded_stream.hpp"
#include "core/app/program.hpp"
#include "core/gl/offscreen_context.hpp"
#include "viewer/receive/person_decoder.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <glad/gl.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace atrium::bench {
namespace {

using renderer::ObjectLook;
using renderer::PersonModel;
using renderer::SceneRenderer;
using renderer::ShapeKind;

struct Options {
    std::filesystem::path stream = "build/viewer_picture.coded";
    int width = 0;
    int height = 0;
    std::uint64_t pictures = 24;
    std::uint64_t rounds = 5;
    std::string only;
};

template <typename T>
T value_of(Expected<T> result) {
    if (result) return std::move(*result);
    std::exit(app::fail(result.error()));
}

// Processor time of all threads of this process, including llvmpipe's [ms].
double processor_ms() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double wall_ms() {
    return std::chrono::duration<double, std::milli>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

constexpr std::array<const char*, 2> kSites = {"alice", "bob"};

geometry::RigidTransform placed(const Eigen::Vector3d& at_m, double yaw_rad = 0.0) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), at_m};
}

// The view of deploy/viewer.toml.
renderer::ViewCamera demo_camera(double turn_rad) {
    renderer::ViewCamera camera{
        .position_m = {1.9, -3.7, 1.75}, .target_m = {0.0, 0.0, 0.92}, .fov_deg = 36.0};
    camera.position_m = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()) * camera.position_m;
    return camera;
}

renderer::TexturePicture checks() {
    constexpr int kSide = 64;
    renderer::TexturePicture picture{.width = kSide, .height = kSide, .rgba = {}};
    for (int i = 0; i < kSide * kSide; ++i) {
        const bool is_light = (i / 8 + i / (8 * kSide)) % 2 == 0;
        const std::uint8_t grey = is_light ? 220 : 60;
        picture.rgba.insert(picture.rgba.end(), {grey, grey, grey, 255});
    }
    return picture;
}

// A floor, and as many objects as the demo's world, of every shape, some with a texture.
constexpr std::uint32_t kNumThings = 12;

ObjectLook thing(std::uint32_t i) {
    constexpr std::array kShapes = {
        ShapeKind::kBox, ShapeKind::kSphere, ShapeKind::kCylinder, ShapeKind::kCapsule};
    ObjectLook look{.shape = kShapes[i % kShapes.size()], .size_m = {0.16, 0.16, 0.3}};
    if (look.shape == ShapeKind::kSphere) look.size_m.z() = 0.16;
    look.colour = {0.2 + 0.05 * i, 0.5, 0.8 - 0.05 * i};
    if (i % 3 == 1) look.texture = "checks";
    look.world_from_object = placed({0.3 * (i % 4) - 0.45, 0.4 * (i / 4) - 0.4, 0.3}, 0.3 * i);
    return look;
}

class Pictures {
public:
    Pictures(const CodedStream& stream, int width, int height)
        : stream_(stream),
          renderer_(value_of(SceneRenderer::create({.width = width, .height = height}))) {
        renderer_.set_site_pose(kSites[0], placed({-0.9, 0.0, 0.0}));
        renderer_.set_site_pose(kSites[1], placed({0.9, 0.0, 0.0}, M_PI));
        for (std::size_t person = 0; person < kSites.size(); ++person) {
            for (std::size_t frame = 0; frame < stream.frames.size(); ++frame) {
                models_[person].emplace_back();
                decode(person, frame, models_[person].back());
            }
        }
        renderer_.set_texture("checks", checks());
    }

    struct Work {
        bool things = false;
        bool people = false;
        bool view_moves = false;
        bool new_people = false;
        bool decode = false;
        bool read = false;
    };

    void begin(const Work& work) {
        for (std::uint32_t i = 0; i < kNumThings; ++i) {
            if (work.things)
                renderer_.set_object(i, thing(i));
            else
                renderer_.remove_object(i);
        }
        renderer_.remove_object(kNumThings);
        if (work.things) {
            renderer_.set_object(kNumThings,
                                 {.shape = ShapeKind::kPlane,
                                  .size_m = {8.0, 8.0, 0.0},
                                  .colour = {0.42, 0.4, 0.38}});
        }
        for (std::size_t person = 0; person < kSites.size(); ++person) {
            if (work.people)
                show(person, 0);
            else
                take_back(person);
        }
    }

    void draw(const Work& work) {
        ++num_drawn_;
        if (work.things) {
            for (std::uint32_t i = 0; i < kNumThings; ++i) {
                geometry::RigidTransform pose = thing(i).world_from_object;
                pose.translation.z() += 0.01 * std::sin(0.3 * static_cast<double>(num_drawn_));
                renderer_.move_object(i, pose);
            }
        }
        for (std::size_t person = 0; person < kSites.size(); ++person) {
            const std::size_t frame = (num_drawn_ + 5 * person) % stream_.frames.size();
            if (work.decode) decode(person, frame, spare_);
            if (work.new_people) show(person, frame);
        }
        renderer_.draw(demo_camera(work.view_moves ? 0.02 * (num_drawn_ % 8) : 0.0));
        if (work.read)
            renderer_.read_pixels(picture_);
        else
            glFinish();
    }

    const PersonModel& model(std::size_t person) const { return models_[person].front(); }
    const renderer::RenderedPicture& picture() const { return picture_; }

private:
    void decode(std::size_t person, std::size_t frame, PersonModel& out) {
        const Eigen::Isometry3d world_from_site(renderer_.world_from_site(kSites[person]));
        const Eigen::Vector3f eye_site =
            (world_from_site.inverse() * demo_camera(0.0).position_m).cast<float>();
        const auto ok =
            viewer::decode_person({stream_.frames[frame].mesh, stream_.frames[frame].textures},
                                  stream_.description,
                                  {},
                                  {&eye_site, 1},
                                  scratch_,
                                  out);
        if (!ok) std::exit(app::fail(ok.error()));
    }
    void take_back(std::size_t person) {
        if (shown_[person] < 0) return;
        models_[person][static_cast<std::size_t>(shown_[person])] =
            renderer_.set_person(kSites[person], {});
        renderer_.remove_person(kSites[person]);
        shown_[person] = -1;
    }
    void show(std::size_t person, std::size_t frame) {
        if (shown_[person] == static_cast<int>(frame)) return;
        PersonModel former =
            renderer_.set_person(kSites[person], std::move(models_[person][frame]));
        if (shown_[person] >= 0)
            models_[person][static_cast<std::size_t>(shown_[person])] = std::move(former);
        shown_[person] = static_cast<int>(frame);
    }

    const CodedStream& stream_;
    SceneRenderer renderer_;
    viewer::PersonDecodeScratch scratch_;
    std::array<std::vector<PersonModel>, 2> models_;
    std::array<int, 2> shown_{-1, -1};
    PersonModel spare_;
    renderer::RenderedPicture picture_;
    std::uint64_t num_drawn_ = 0;
};

struct Row {
    std::string name;
    Pictures::Work work;
    double core_ms = 1e9;
    double wall_ms = 1e9;
};

void measure(const CodedStream& stream, int width, int height, const Options& options) {
    auto context = value_of(gl::OffscreenContext::create(16, 16));
    Pictures pictures(stream, width, height);
    using Work = Pictures::Work;
    std::vector<Row> rows = {
        {"ground and sky", Work{}},
        {"floor and 12 moving things", Work{.things = true}},
        {"two people", Work{.things = true, .people = true}},
        {"the viewpoint moves", Work{.things = true, .people = true, .view_moves = true}},
        {"new people in each picture",
         Work{.things = true, .people = true, .view_moves = true, .new_people = true}},
        {"their decoding and preparing",
         Work{.things = true,
              .people = true,
              .view_moves = true,
              .new_people = true,
              .decode = true}},
        {"reading the picture back",
         Work{.things = true,
              .people = true,
              .view_moves = true,
              .new_people = true,
              .decode = true,
              .read = true}}};
    if (!options.only.empty())
        std::erase_if(rows, [&](const Row& row) { return row.name != options.only; });
    // the least of several interleaved runs: other programs only add to it
    for (std::uint64_t round = 0; round < options.rounds; ++round) {
        for (Row& row : rows) {
            pictures.begin(row.work);
            for (int i = 0; i < 3; ++i) pictures.draw(row.work);
            const double before_wall_ms = wall_ms();
            const double before_ms = processor_ms();
            for (std::uint64_t i = 0; i < options.pictures; ++i) pictures.draw(row.work);
            const double ms = processor_ms() - before_ms;
            const auto num = static_cast<double>(options.pictures);
            row.core_ms = std::min(row.core_ms, ms / num);
            row.wall_ms = std::min(row.wall_ms, (wall_ms() - before_wall_ms) / num);
        }
    }
    fmt::print("{}x{}, {} triangles of {} cameras twice; ms of one core\n",
               width,
               height,
               stream.frames.empty() ? 0 : pictures.model(1).triangles.size(),
               pictures.model(1).cameras.size());
    double former_ms = 0.0;
    for (const Row& row : rows) {
        fmt::print("{:32} +{:6.2f} = {:6.2f}   {:6.1f} pictures/s\n",
                   row.name,
                   row.core_ms - former_ms,
                   row.core_ms,
                   1e3 / row.wall_ms);
        former_ms = row.core_ms;
    }
}

CodedStream load_or_code(const std::filesystem::path& file) {
    if (!std::filesystem::exists(file)) {
        const auto saved = save(value_of(code_simulated_person()), file);
        if (!saved) std::exit(app::fail(saved.error()));
    }
    return value_of(load_coded_stream(file));
}

int run(int argc, char** argv) {
    Options options;
    config::OptionSet set;
    set.add("stream", options.stream, "coded stream; is made where it is missing");
    set.add("width", options.width, "of the picture; 0: 960x540 and 1280x720", {0, 4096});
    set.add("height", options.height, "of the picture", {0, 4096});
    set.add("pictures", options.pictures, "per round", {1, 10000});
    set.add("rounds", options.rounds, "of which the least counts", {1, 1000});
    set.add("only", options.only, "the row of this name alone");
    const app::Start started =
        app::start({"viewer_picture",
                    "Measures what a picture of two people costs the viewer in software.",
                    "  viewer_picture --width 960 --height 540\n"},
                   set,
                   argc,
                   argv);
    if (!started.go_on) return started.exit_code;
    const CodedStream stream = load_or_code(options.stream);
    if (options.width > 0 && options.height > 0) {
        measure(stream, options.width, options.height, options);
        return 0;
    }
    measure(stream, 960, 540, options);
    measure(stream, 1280, 720, options);
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
