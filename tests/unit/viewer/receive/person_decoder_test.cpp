#include "viewer/receive/person_decoder.hpp"

#include "tests/unit/viewer/test_site.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

class PersonDecoderTest : public testing::Test {
protected:
    const bus::SiteDescription description_ = test_site::description("a");
    FramePair pair_ = [] {
        test_site::Frame frame = test_site::frame("a", 5, 150);
        return FramePair{std::move(frame.mesh), std::move(frame.textures)};
    }();
    std::vector<Eigen::Vector3f> eyes_site_;
    PersonDecodeScratch scratch_;
    renderer::PersonModel model_;

    std::string decode_error(const PersonLimits& limits = {}) {
        const auto decoded =
            decode_person(pair_, description_, limits, eyes_site_, scratch_, model_);
        if (decoded) return "";
        EXPECT_EQ(decoded.error().kind, ErrorKind::kInvalidData);
        return decoded.error().message;
    }
};

TEST_F(PersonDecoderTest, DecodesShapeAndColour) {
    EXPECT_EQ(decode_error(), "");
    EXPECT_EQ(model_.cameras.size(), 4u);
    ASSERT_GT(model_.vertices_site.size(), 400u);
    for (const Eigen::Vector3f& p : model_.vertices_site)
        EXPECT_NEAR((p - Eigen::Vector3f(0.0f, 0.0f, 1.2f)).norm(), 0.4f, 1e-3f);
    for (const Eigen::Vector3f& colour : model_.fallback)
        EXPECT_LT((colour - Eigen::Vector3f::Constant(150.0f / 255.0f)).norm(), 0.03f);
}

TEST_F(PersonDecoderTest, DecodesOnlyWhatTheEyesNeed) {
    // a colour stream that is no JPEG does not matter in a picture that no eye needs
    const bus::SiteDescription description = description_;
    const auto centre = [&](std::size_t camera) {
        return Eigen::Vector3f(description.cameras[camera].centre_site().cast<float>());
    };
    for (std::uint32_t i = 4; i < 8; ++i) {
        bus::CameraTexture copy = pair_.textures[0];
        copy.camera = 0;
        pair_.textures.push_back(copy);
    }
    eyes_site_ = {Eigen::Vector3f(1.5F * centre(0))};
    eyes_site_.front().z() = centre(0).z();
    EXPECT_EQ(decode_error(), "");
    const std::size_t num_needed = model_.cameras.size();
    EXPECT_GE(num_needed, 5U);
    EXPECT_LT(num_needed, 8U) << "the camera on the far side must not be needed";
    for (const auto& camera : model_.cameras)
        EXPECT_GT((camera.centre_site - centre(2)).norm(), 0.1F);
    pair_.textures[2].colour = {1, 2, 3};
    EXPECT_EQ(decode_error(), "") << "unneeded textures must not be decoded";
    eyes_site_.clear();
    EXPECT_NE(decode_error(), "");
}

TEST_F(PersonDecoderTest, RefusesATextureOfAnUnknownCamera) {
    pair_.textures[2].camera = 4;
    EXPECT_THAT(decode_error(), testing::HasSubstr("camera 4"));
}

TEST_F(PersonDecoderTest, RefusesATextureThatDiffersFromItsCropsSize) {
    pair_.textures[1].crop_px.width += 2;
    EXPECT_THAT(decode_error(), testing::HasSubstr("crop"));
}

// Textures as large as the crops, as sites send them with codec.texture_resolution = "full".
TEST_F(PersonDecoderTest, AcceptsTexturesAtFullResolution) {
    ASSERT_EQ(decode_error(), "");
    const renderer::PersonModel half = model_;
    for (bus::CameraTexture& texture : pair_.textures) {
        texture.crop_px.width /= 2;
        texture.crop_px.height /= 2;
    }
    EXPECT_EQ(decode_error(), "");
    // the same picture on half of the width: coordinates within the crop are twice as large
    const auto across = [](const renderer::PersonModel& model) {
        const Eigen::Vector3f& st = model.cameras[0].layer_coordinates[0];
        return st.x() / st.z() * static_cast<float>(model.layer_width) - 1.0f;  // a border of 1
    };
    EXPECT_EQ(model_.layer_width, half.layer_width);
    EXPECT_NEAR(across(model_), 2.0f * across(half), 0.01f);
}

TEST_F(PersonDecoderTest, RefusesMoreThanItsLimits) {
    EXPECT_THAT(decode_error({.max_layer_bytes = 1000}), testing::HasSubstr("exceed the limit"));
    EXPECT_NE(decode_error({.max_triangles = 100}), "");
    EXPECT_EQ(decode_error(), "");  // the scratch still works
}

TEST_F(PersonDecoderTest, RefusesEveryTruncation) {
    const FramePair whole = pair_;
    for (std::size_t n = 0; n < whole.textures[0].colour.size(); n += 97) {
        pair_.textures[0].colour.resize(n);
        EXPECT_NE(decode_error(), "") << n;
        pair_.textures[0].colour = whole.textures[0].colour;
    }
    for (std::size_t n = 1; n < whole.mesh.draco.size(); n += 211) {
        pair_.mesh.draco.resize(n);
        EXPECT_NE(decode_error(), "") << n;
        pair_.mesh.draco = whole.mesh.draco;
    }
}

}  // namespace
}  // namespace atrium::viewer
