// What people look like beside what cameras saw of them, at a small size: bench/texture_quality
// measures the same at full size.
#include "core/config/rig.hpp"
#include "tests/support/camera_orbit.hpp"
#include "tests/support/filmed_person.hpp"
#include "tests/support/person_photographer.hpp"
#include "tests/support/picture_error.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>

namespace atrium::test {
namespace {

constexpr double kTime_s = 0.6;

renderer::PersonModel model_of(const ReceivedPerson& person) {
    renderer::PersonModelScratch scratch;
    renderer::PersonModel model;
    renderer::build_person_model(person.mesh, person.pictures, {}, scratch, model);
    return model;
}

// Mean over the true pictures of what the viewer shows from where they were taken.
double mean_psnr_db(const ReceivedPerson& received, std::span<const TruePicture> truths) {
    auto photographer = PersonPhotographer::create();
    EXPECT_TRUE(photographer);
    renderer::PersonDrawing person;
    person.set_model(model_of(received));
    double sum = 0.0;
    for (const TruePicture& truth : truths) {
        const Photo photo = photographer->take(truth.camera, person);
        sum += picture_error(truth.bgr, photo.bgr, truth.mask).psnr_db;
    }
    return sum / static_cast<double>(truths.size());
}

// The rig of eight megapixel cameras with pictures of half their width and height, filmed once.
class SimulatedRoom : public testing::Test {
protected:
    static void SetUpTestSuite() {
        rig_ =
            config::load_rig(ATRIUM_SOURCE_DIR "/deploy/rigs/full_body_1mp.toml").value().cameras;
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
    EXPECT_GT(mean_psnr_db(*person, free()), 26.0);
}

TEST_F(SimulatedRoom, ATexturingCameraIsShownItsOwnPicture) {
    const auto person = receive_person(own(), Publishing::kAsTheyWere);
    ASSERT_TRUE(person) << person.error().message;
    const double own_db = mean_psnr_db(*person, own());
    RecordProperty("psnr_db", std::to_string(own_db));
    EXPECT_GT(own_db, 32.0);
}

TEST_F(SimulatedRoom, NothingPopsOnAWayAround) {
    const auto person = receive_person(own(), Publishing::kAsSites);
    ASSERT_TRUE(person) << person.error().message;
    // a sixth of a turn in steps of one degree, past a camera and between two
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

TEST(RecordedPerson, IsShownWhereOtherCamerasStood) {
    const std::filesystem::path folder = ATRIUM_SOURCE_DIR "/../shared/data/recordings/ring20";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
    const auto pictures = load_pictures(folder);
    ASSERT_TRUE(pictures) << pictures.error().message;
    std::vector<TruePicture> texturing;
    std::vector<TruePicture> others;
    for (std::size_t i = 0; i < pictures->size(); ++i)
        (i % 2 == 0 ? texturing : others).push_back((*pictures)[i]);
    others.resize(4);
    const auto person = receive_person(texturing, Publishing::kAsSites);
    ASSERT_TRUE(person) << person.error().message;
    EXPECT_GT(mean_psnr_db(*person, others), 21.0);
}

}  // namespace
}  // namespace atrium::test
