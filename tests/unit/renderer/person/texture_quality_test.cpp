// Compares drawn people with the pictures of cameras, at a small size. bench/viewer/texture_quality
// measures the same at full size.
#include "core/config/rig.hpp"
#include "tests/support/pictures/camera_orbit.hpp"
#include "tests/support/pictures/filmed_person.hpp"
#include "tests/support/pictures/person_photographer.hpp"
#include "tests/support/pictures/picture_error.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace atrium::test {
namespace {

constexpr double kTime_s = 0.6;

renderer::PersonModel model_of(const ReceivedPerson& person,
                               const renderer::PersonModelOptions& options = {}) {
    renderer::PersonModelScratch scratch;
    renderer::PersonModel model;
    renderer::build_person_model(person.mesh, person.pictures, options, scratch, model);
    return model;
}

// Mean error of the viewer's pictures against the true pictures from the same places.
PictureError mean_error(const renderer::PersonModel& model,
                        std::span<const TruePicture> truths,
                        Sampling sampling = Sampling::kMean) {
    auto photographer = PersonPhotographer::create(sampling);
    EXPECT_TRUE(photographer);
    renderer::PersonDrawing person;
    person.set_model(model);
    PictureError mean{0.0, 0.0, 0.0};
    const auto num = static_cast<double>(truths.size());
    for (const TruePicture& truth : truths) {
        const Photo photo = photographer->take(truth.camera, person);
        const PictureError error = picture_error(truth.bgr, photo.bgr, truth.mask);
        mean.psnr_db += error.psnr_db / num;
        mean.inner_psnr_db += error.inner_psnr_db / num;
        mean.ssim += error.ssim / num;
    }
    return mean;
}

// The rig of eight megapixel cameras with pictures of half the width and height, filmed once.
class SimulatedRoom : public testing::Test {
protected:
    static void SetUpTestSuite() {
        rig_ = config::load_rig(atrium::test::source_dir() + "/deploy/rigs/full_body_1mp.toml")
                   .value()
                   .cameras;
        for (geometry::CalibratedCamera& camera : rig_) {
            auto& lens = camera.intrinsics;
            lens = {.width = 500,
                    .height = 500,
                    .fx = lens.fx / 2,
                    .fy = lens.fy / 2,
                    .cx = (lens.cx - 0.5) / 2,
                    .cy = (lens.cy - 0.5) / 2};
        }
        auto cameras = rig_;
        for (const auto& camera : free_viewpoints(6, 500, 400.0)) cameras.push_back(camera);
        pictures_ = film_room(cameras, {}, kTime_s).value();
        auto photos = photograph_truth(rig_, {}, kTime_s, cameras).value();
        for (std::size_t i = 0; i < cameras.size(); ++i) pictures_[i].bgr.swap(photos[i].bgr);
    }
    // the person alone in its true colours, for comparison
    static std::span<const TruePicture> own() { return std::span(pictures_).first(rig_.size()); }
    static std::span<const TruePicture> free() { return std::span(pictures_).subspan(rig_.size()); }

    static inline std::vector<geometry::CalibratedCamera> rig_;
    static inline std::vector<TruePicture> pictures_;
};

TEST_F(SimulatedRoom, FreeViewpointsShowThePerson) {
    const auto person = receive_person(own(), Publishing::kAsTheyWere);
    ASSERT_TRUE(person) << person.error().message;
    EXPECT_GT(mean_error(model_of(*person), free()).psnr_db, 26.0);
}

TEST_F(SimulatedRoom, ViewFromATexturingCameraShowsItsPicture) {
    const auto person = receive_person(own(), Publishing::kAsTheyWere);
    ASSERT_TRUE(person) << person.error().message;
    const PictureError error = mean_error(model_of(*person), own(), Sampling::kCentre);
    RecordProperty("psnr_db", std::to_string(error.psnr_db));
    RecordProperty("inner_psnr_db", std::to_string(error.inner_psnr_db));
    EXPECT_GT(error.psnr_db, 32.0);
}

TEST_F(SimulatedRoom, EvensOutCamerasOfDifferentColours) {
    std::vector<TruePicture> uneven(own().begin(), own().end());
    constexpr std::array<double, 8> kGains = {0.8, 1.1, 0.9, 1.2, 1.0, 0.85, 1.15, 0.95};
    ASSERT_LE(uneven.size(), kGains.size());
    for (std::size_t i = 0; i < uneven.size(); ++i) {
        for (std::size_t at = 0; at < uneven[i].bgr.size(); ++at) {
            // each channel differs, but none of them on average
            const double gain = kGains[(i + 3 * (at % 3)) % kGains.size()];
            std::uint8_t& value = uneven[i].bgr[at];
            value = static_cast<std::uint8_t>(std::min(255.0, value * gain + 0.5));
        }
    }
    const auto person = receive_person(uneven, Publishing::kAsTheyWere);
    ASSERT_TRUE(person) << person.error().message;
    renderer::PersonModelOptions as_they_are;
    as_they_are.gain_compensation.max_points = 0;
    const double uneven_db = mean_error(model_of(*person, as_they_are), free()).psnr_db;
    const double evened_db = mean_error(model_of(*person), free()).psnr_db;
    RecordProperty("uneven_psnr_db", std::to_string(uneven_db));
    RecordProperty("evened_psnr_db", std::to_string(evened_db));
    EXPECT_GT(evened_db, uneven_db + 1.0);
    EXPECT_GT(evened_db, 24.0);
}

TEST_F(SimulatedRoom, DoesNotChangeCamerasOfEqualColours) {
    const auto person = receive_person(own(), Publishing::kAsTheyWere);
    ASSERT_TRUE(person) << person.error().message;
    renderer::PersonModelScratch scratch;
    renderer::PersonModel model;
    renderer::build_person_model(person->mesh, person->pictures, {}, scratch, model);
    // the hull differs from the person, and cameras see different points at the same place
    for (const Eigen::Array3d& log_gain : scratch.gain_compensation.log_gains)
        EXPECT_LT(log_gain.abs().maxCoeff(), 0.03) << log_gain.transpose();
}

TEST_F(SimulatedRoom, HasNoPoppingOnAPathAround) {
    const auto person = receive_person(own(), Publishing::kAsSites);
    ASSERT_TRUE(person) << person.error().message;
    // a sixth of a turn in steps of one degree, past one camera and between two
    auto way = orbit(360, 2.6, 1.3, 180, 240, 280.0);
    way.resize(60);
    const PictureChanges true_changes = changes(photograph_truth(rig_, {}, kTime_s, way).value());
    auto photographer = PersonPhotographer::create();
    ASSERT_TRUE(photographer);
    renderer::PersonDrawing drawing;
    drawing.set_model(model_of(*person));
    std::vector<Photo> photos;
    for (const auto& camera : way) photos.push_back(photographer->take(camera, drawing));
    EXPECT_LT(changes(photos).largest, 1.5 * true_changes.largest);
    EXPECT_LT(changes(photos).largest_block, 1.5 * true_changes.largest_block);
}

TEST(RecordedPerson, MatchesCamerasThatWereLeftOut) {
    const std::filesystem::path folder =
        atrium::test::source_dir() + "/../shared/data/recordings/ring20";
    if (!std::filesystem::exists(folder))
        GTEST_SKIP() << atrium::test::skip::kNoSharedData << folder;
    const auto pictures = load_pictures(folder);
    ASSERT_TRUE(pictures) << pictures.error().message;
    std::vector<TruePicture> texturing;
    std::vector<TruePicture> others;
    for (std::size_t i = 0; i < pictures->size(); ++i)
        (i % 2 == 0 ? texturing : others).push_back((*pictures)[i]);
    others.resize(4);
    const auto person = receive_person(texturing, Publishing::kAsSites);
    ASSERT_TRUE(person) << person.error().message;
    EXPECT_GT(mean_error(model_of(*person), others).psnr_db, 21.0);
}

}  // namespace
}  // namespace atrium::test
