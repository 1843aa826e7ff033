// Compares drawn people with the pictures of real cameras, and with simpler ways to texture them.
// Writes rows of comma-separated values, one per picture and method. texture_quality.sh keeps them
// and makes the table of docs/measurements/viewer.md.
#include "bench/value_of.hpp"
#include "bench/viewer/texture_baselines.hpp"
#include "bench/viewer/texture_pictures.hpp"
#include "core/app/program.hpp"
#include "core/config/rig.hpp"
#include "tests/support/pictures/camera_orbit.hpp"
#include "tests/support/pictures/filmed_person.hpp"
#include "tests/support/pictures/person_photographer.hpp"
#include "tests/support/pictures/picture_error.hpp"
#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/needed_cameras.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace atrium::bench {
namespace {

using test::Photo;
using test::TruePicture;

constexpr double kTime_s = 0.6;  // instant of the simulated motion

struct Options {
    std::filesystem::path recording = ATRIUM_SOURCE_DIR "/../shared/data/recordings/ring20";
    std::filesystem::path rig = ATRIUM_SOURCE_DIR "/deploy/rigs/full_body_1mp.toml";
    std::filesystem::path pictures;
    std::string look = "ada";
    std::string publishing = "half";
    std::string only;
    int orbit_steps = 360;
    bool even_colours = true;
    bool needed_only = true;
    bool soft_outlines = true;
    std::uint64_t repeats = 1;
    std::string refine = "off";
};

const std::array kWays{"viewer", "nearest camera", "nearest that sees", "equal", "its texture"};

template <typename Work>
double shortest_ms(std::uint64_t repeats, const Work& work) {
    double best_ms = 1e9;
    for (std::uint64_t i = 0; i < repeats; ++i) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::milli> taken =
            std::chrono::steady_clock::now() - start;
        best_ms = std::min(best_ms, taken.count());
    }
    return best_ms;
}

renderer::PersonModelOptions model_options_of(const Options& options) {
    renderer::PersonModelOptions model_options;
    if (!options.even_colours) model_options.gain_compensation.max_points = 0;
    return model_options;
}

renderer::PersonModel model_of(const test::ReceivedPerson& person, const Options& options) {
    renderer::PersonModelScratch scratch;
    renderer::PersonModel model;
    const renderer::PersonModelOptions model_options = model_options_of(options);
    const double prepared_ms = shortest_ms(options.repeats, [&] {
        renderer::build_person_model(person.mesh, person.pictures, model_options, scratch, model);
    });
    renderer::BlendScratch blend_scratch;
    renderer::BlendedMesh blended;
    const double blended_ms = shortest_ms(options.repeats, [&] {
        renderer::blend_for_view(model, Eigen::Vector3f(2.0F, 1.5F, 1.5F), blend_scratch, blended);
    });
    fmt::print(stderr,
               "{} cameras, {} triangles: prepared in {:.2f} ms, blended in {:.2f} ms\n",
               model.cameras.size(),
               model.triangles.size(),
               prepared_ms,
               blended_ms);
    return model;
}

// One scene: a person from some cameras, shown from the places of others.
class Comparison {
public:
    Comparison(std::string scene,
               const test::ReceivedPerson& person,
               const Options& options,
               test::Sampling sampling = test::Sampling::kMean)
        : scene_(std::move(scene) + (options.refine == "off" ? "" : " " + options.refine) +
                 (options.soft_outlines ? "" : " hard")),
          options_(options),
          photographer_(value_of(test::PersonPhotographer::create(sampling))),
          received_(person),
          model_(model_of(person, options)),
          weighted_(model_) {
        person_.set_model(model_);
        photographer_.set_soft_outlines(options.soft_outlines);
    }

    // `own` is the texture made of `truth`, if there is one.
    void compare(const TruePicture& truth, const renderer::CameraPicture* own) {
        std::vector<Photo> photos;
        photos.push_back(take(truth.camera));
        const Eigen::Vector3d eye = truth.camera.centre_site();
        for (const CameraWeights& weights : {nearest_camera(model_, eye),
                                             nearest_seeing_camera(model_, eye),
                                             all_facing_cameras(model_)}) {
            photos.push_back(photographer_.take(
                truth.camera,
                [&](const Eigen::Matrix4d& clip_from_site, const Eigen::Vector3d& eye_site) {
                    weighted_.draw(weights, clip_from_site, eye_site);
                }));
        }
        if (own != nullptr) photos.push_back(enlarged(*own, truth.width(), truth.height()));
        for (std::size_t i = 0; i < photos.size(); ++i) report(truth, photos[i], kWays[i]);
        if (!options_.pictures.empty()) {
            write_side_by_side(
                options_.pictures / fmt::format("{}-{:02}.png", scene_, num_views_), truth, photos);
        }
        ++num_views_;
    }

    Photo take(const geometry::CalibratedCamera& camera) {
        if (options_.needed_only) use_needed(camera.centre_site().cast<float>());
        return photographer_.take(camera, person_);
    }

    ~Comparison() {
        if (num_taken_ > 0) {
            fmt::print(stderr,
                       "{:24} {:.1f} of {} cameras needed\n",
                       scene_,
                       static_cast<double>(num_used_) / num_taken_,
                       received_.pictures.size());
        }
        for (const auto& [way, sum] : sums_)
            fmt::print(stderr,
                       "{:24} {:18} {:6.2f} dB  inside {:6.2f} dB  ssim {:.4f}\n",
                       scene_,
                       way,
                       sum.psnr_db / num_views_,
                       sum.inner_psnr_db / num_views_,
                       sum.ssim / num_views_);
    }
    Comparison(const Comparison&) = delete;
    Comparison& operator=(const Comparison&) = delete;

private:
    // The person that a viewer decodes, from these cameras alone.
    void use_needed(const Eigen::Vector3f& eye_site) {
        std::vector<Eigen::Vector3f> centres;
        for (const renderer::CameraPicture& picture : received_.pictures)
            centres.push_back(picture.camera.centre_site().cast<float>());
        const std::vector<bool> needed =
            renderer::needed_cameras(centres, model_.bounds_site, {&eye_site, 1});
        std::vector<renderer::CameraPicture> pictures;
        for (std::size_t i = 0; i < needed.size(); ++i)
            if (needed[i]) pictures.push_back(received_.pictures[i]);
        renderer::PersonModel model;
        renderer::build_person_model(
            received_.mesh, pictures, model_options_of(options_), scratch_, model);
        person_.set_model(std::move(model));
        num_used_ += pictures.size();
        ++num_taken_;
    }

    void report(const TruePicture& truth, const Photo& photo, const std::string& way) {
        const test::PictureError error = test::picture_error(truth.bgr, photo.bgr, truth.mask);
        const OutlineError outline = outline_error(truth, photo);
        fmt::print("{},{},{},{:.3f},{:.3f},{:.5f},{:.5f},{:.5f}\n",
                   scene_,
                   num_views_,
                   way,
                   error.psnr_db,
                   error.inner_psnr_db,
                   error.ssim,
                   outline.bare,
                   outline.beyond);
        std::fflush(stdout);
        test::PictureError& sum = sums_.try_emplace(way, kNoError).first->second;
        sum.psnr_db += error.psnr_db;
        sum.inner_psnr_db += error.inner_psnr_db;
        sum.ssim += error.ssim;
    }

    static constexpr test::PictureError kNoError{0.0, 0.0, 0.0};

    std::string scene_;
    const Options& options_;
    test::PersonPhotographer photographer_;  // destroyed last: it owns the context
    test::ReceivedPerson received_;
    renderer::PersonModel model_;
    renderer::PersonModelScratch scratch_;
    std::size_t num_used_ = 0;
    int num_taken_ = 0;
    renderer::PersonDrawing person_;
    WeightedDrawing weighted_;
    std::map<std::string, test::PictureError> sums_;
    int num_views_ = 0;
};

// Only one context exists at a time: each comparison ends before the next begins.
void compare_all(const std::string& scene,
                 const test::ReceivedPerson& person,
                 std::span<const TruePicture> truths,
                 const Options& options) {
    Comparison comparison(scene, person, options);
    for (const TruePicture& truth : truths) comparison.compare(truth, nullptr);
}

// At the poses of the texturing cameras, at their resolution and at the textures'.
void compare_own(const std::string& scene,
                 const test::ReceivedPerson& person,
                 std::span<const TruePicture> texturing,
                 const Options& options) {
    {
        Comparison comparison(scene + " own", person, options, test::Sampling::kCentre);
        for (std::size_t i = 0; i < texturing.size(); ++i)
            comparison.compare(texturing[i], &person.pictures[i]);
    }
    Comparison comparison(scene + " own half", person, options, test::Sampling::kCentre);
    for (std::size_t i = 0; i < texturing.size(); ++i) {
        renderer::CameraPicture own = person.pictures[i];
        for (int* size : {&own.crop_px.x, &own.crop_px.y, &own.crop_px.width, &own.crop_px.height})
            *size /= 2;
        comparison.compare(halved(texturing[i]), &own);
    }
}

// The same for a site that sends textures at full resolution (codec.texture_resolution).
void compare_full(const std::string& scene,
                  std::span<const TruePicture> texturing,
                  std::span<const TruePicture> truths,
                  const Options& options) {
    if (options.publishing != "half" || options.refine != "off") return;
    const auto person = value_of(test::receive_person(texturing, test::Publishing::kFull));
    compare_all(scene + " full", person, truths, options);
    Comparison comparison(scene + " full own", person, options, test::Sampling::kCentre);
    for (std::size_t i = 0; i < texturing.size(); ++i)
        comparison.compare(texturing[i], &person.pictures[i]);
}

test::Publishing publishing(const Options& options) {
    if (options.publishing == "full") return test::Publishing::kFull;
    return options.publishing == "half" ? test::Publishing::kAsSites
                                        : test::Publishing::kAsTheyWere;
}

bool wants(const Options& options, const std::string& scene) {
    return options.only.empty() || scene.starts_with(options.only);
}

void compare_recording(const Options& options) {
    const std::string name = options.recording.filename().string();
    if (!wants(options, name)) return;
    if (!std::filesystem::exists(options.recording)) {
        fmt::print(stderr, "{} is not here: left out\n", options.recording.string());
        return;
    }
    const auto pictures = value_of(test::load_pictures(options.recording));
    std::vector<TruePicture> texturing;
    std::vector<TruePicture> held_back;
    for (std::size_t i = 0; i < pictures.size(); ++i)
        (i % 2 == 0 ? texturing : held_back).push_back(pictures[i]);
    const auto person = value_of(test::receive_person(
        texturing, publishing(options), test::refinement_named(options.refine)));
    compare_all(name, person, held_back, options);
    compare_own(name, person, texturing, options);
    compare_full(name, texturing, held_back, options);
}

void compare_orbit(const Options& options,
                   const std::vector<geometry::CalibratedCamera>& rig,
                   const simulation::RoomOptions& room,
                   const test::ReceivedPerson& person) {
    auto cameras = test::orbit(options.orbit_steps, 2.6, 1.3, 360, 480, 560.0);
    cameras.push_back(cameras.front());
    const test::PictureChanges true_changes =
        test::changes(value_of(test::photograph_truth(rig, room, kTime_s, cameras)));
    Comparison comparison("orbit", person, options);
    std::vector<Photo> photos;
    for (const auto& camera : cameras) photos.push_back(comparison.take(camera));
    const test::PictureChanges shown = test::changes(photos);
    fmt::print("orbit,0,viewer,{:.4f},{:.4f},{:.4f}\norbit,0,truth,{:.4f},{:.4f},{:.4f}\n",
               shown.largest,
               shown.largest_block,
               shown.mean,
               true_changes.largest,
               true_changes.largest_block,
               true_changes.mean);
    fmt::print(stderr,
               "orbit: largest change {:.3f} of the truth's; of blocks {:.3f}; mean {:.3f}\n",
               shown.largest / true_changes.largest,
               shown.largest_block / true_changes.largest_block,
               shown.mean / true_changes.mean);
}

// Before a green screen, whose colour mixes into the pixels at the outline.
void compare_screen(const Options& options) {
    if (!wants(options, "screen")) return;
    const auto rig = value_of(config::load_rig(options.rig)).cameras;
    simulation::RoomOptions room;
    room.look = options.look;
    const auto texturing = value_of(test::film_before_screen(rig, room, kTime_s, rig));
    const auto person = value_of(test::receive_person(
        texturing, publishing(options), test::refinement_named(options.refine)));
    const auto viewpoints = test::free_viewpoints(20, 1000, 800.0);
    auto views = value_of(test::film_before_screen(rig, room, kTime_s, viewpoints));
    show_person_alone(rig, room, kTime_s, views);
    compare_all("screen", person, views, options);
    compare_full("screen", texturing, views, options);
}

void compare_room(const Options& options) {
    if (!wants(options, "room") && !wants(options, "orbit")) return;
    const auto rig = value_of(config::load_rig(options.rig)).cameras;
    std::vector<geometry::CalibratedCamera> cameras = rig;
    for (const auto& camera : test::free_viewpoints(20, 1000, 800.0)) cameras.push_back(camera);
    simulation::RoomOptions room;
    room.look = options.look;
    std::vector<TruePicture> pictures = value_of(test::film_room(cameras, room, kTime_s));
    const std::span<const TruePicture> texturing(pictures.data(), rig.size());
    const auto person = value_of(test::receive_person(
        texturing, publishing(options), test::refinement_named(options.refine)));
    // at its own pose, though, a camera's picture is the truth itself
    const std::vector<TruePicture> filmed(texturing.begin(), texturing.end());
    show_person_alone(rig, room, kTime_s, pictures);
    if (wants(options, "room")) {
        compare_all("room", person, std::span(pictures).subspan(rig.size()), options);
        compare_own("room", person, filmed, options);
        compare_full("room", filmed, std::span(pictures).subspan(rig.size()), options);
    }
    if (options.orbit_steps > 0 && wants(options, "orbit"))
        compare_orbit(options, rig, room, person);
}

int run(int argc, char** argv) {
    Options options;
    config::OptionSet set;
    set.add("recording",
            options.recording,
            "folder of a recording with masks; every second camera gives textures");
    set.add("rig", options.rig, "cameras of the simulated room, a rig file");
    set.add("look", options.look, "of the simulated person");
    set.add(
        "publishing",
        options.publishing,
        "of textures: at half or full resolution through the codec, or as the cameras have them",
        {"half", "full", "uncoded"});
    set.add("refine",
            options.refine,
            "of the hull, as hull.refine of a site",
            {"off", "round", "photo", "round_photo"});
    set.add("only", options.only, "scenes whose names begin so: ring20, room, orbit, screen");
    set.add("pictures", options.pictures, "folder for pictures side by side: real, viewer, others");
    set.add("orbit-steps",
            options.orbit_steps,
            "pictures of a turn around the simulated person",
            {0, 3600});
    set.add("even-colours", options.even_colours, "cameras' colours are evened out");
    set.add(
        "needed-only", options.needed_only, "of each view only the cameras that a viewer decodes");
    set.add("soft-outlines", options.soft_outlines, "people have soft outlines, as usual");
    set.add("repeats",
            options.repeats,
            "the model is prepared and blended so often; the shortest times are told",
            {1, 1000});
    const app::Start started =
        app::start({"texture_quality",
                    "Compares people as the viewer shows them with what cameras saw: PSNR and SSIM "
                    "inside the true mask, beside simpler ways to texture.",
                    "  texture_quality --only ring20 --pictures /tmp/side_by_side\n"},
                   set,
                   argc,
                   argv);
    if (!started.go_on) return started.exit_code;
    if (!options.pictures.empty()) std::filesystem::create_directories(options.pictures);
    fmt::print("scene,view,way,psnr_db,inner_psnr_db,ssim,bare,beyond\n");
    compare_recording(options);
    compare_room(options);
    compare_screen(options);
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
