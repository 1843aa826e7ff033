#include "tests/unit/export/ball_person.hpp"

#include "core/codec/mesh_codec.hpp"
#include "core/codec/texture_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

namespace atrium::exporting::testing {

namespace synthetic = renderer::synthetic;

std::vector<synthetic::Sphere> balls() { return {{{0.0, 0.0, 1.0}, 0.5}, {{0.75, 0.1, 1.1}, 0.2}}; }

Eigen::Vector3d colour_at(const Eigen::Vector3d& p) {
    return {0.5 + 0.3 * std::sin(5.0 * p.x()),
            0.5 + 0.3 * std::sin(5.0 * p.y() + 1.0),
            0.5 + 0.3 * std::sin(5.0 * p.z() + 2.0)};
}

std::vector<geometry::CalibratedCamera> ball_cameras() {
    auto cameras = synthetic::ring(8, {0, 0, 1});
    cameras.push_back(synthetic::camera_at({0.3, 0.0, 4.0}, {0, 0, 1}));
    for (std::size_t i = 0; i < cameras.size(); ++i) cameras[i].name = "c" + std::to_string(i);
    return cameras;
}

std::vector<renderer::CameraPicture> ball_pictures() {
    std::vector<renderer::CameraPicture> pictures;
    for (const auto& camera : ball_cameras())
        pictures.push_back(synthetic::picture_of(balls(), camera, colour_at));
    return pictures;
}

renderer::PersonModel ball_model(int num_rings) {
    renderer::PersonModelScratch scratch;
    renderer::PersonModel model;
    renderer::PersonModelOptions options;
    options.gain_compensation.max_points = 0;
    renderer::build_person_model(
        synthetic::mesh_of(balls(), num_rings), ball_pictures(), options, scratch, model);
    return model;
}

double off_surface_m(const Eigen::Vector3d& p) {
    double least = 1e9;
    for (const synthetic::Sphere& ball : balls())
        least = std::min(least, std::abs((p - ball.centre).norm() - ball.radius_m));
    return least;
}

ExportFacts facts() {
    return {"ball",
            "site ball",
            20.0,
            "a \"b\".mcap",
            "2023-11-14T22:13:20Z",
            "surface normals",
            "Atrium test"};
}

FrameTime frame_time(std::size_t number) {
    const double time_s = 0.05 * static_cast<double>(number - 1);
    return {number, time_s, time_s + 2.0, kBegin + from_milliseconds(1e3 * time_s)};
}

namespace {

bus::CameraTexture coded(const renderer::CameraPicture& picture, codec::TextureEncoder& encoder) {
    codec::TextureCrop crop;
    crop.crop_px = picture.crop_px;
    for (image::Plane* plane : {&crop.y, &crop.u, &crop.v, &crop.mask})
        *plane = image::Plane(picture.width, picture.height);
    for (std::size_t i = 0; i < crop.y.data.size(); ++i) {
        const double r = picture.rgba[4 * i], g = picture.rgba[4 * i + 1],
                     b = picture.rgba[4 * i + 2];
        const double y = 0.299 * r + 0.587 * g + 0.114 * b;
        const auto byte = [](double value) {
            return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
        };
        crop.y.data[i] = byte(y);
        crop.u.data[i] = byte(128 + (b - y) / 1.772);
        crop.v.data[i] = byte(128 + (r - y) / 1.402);
        crop.mask.data[i] = picture.rgba[4 * i + 3];
    }
    codec::CodedTexture bytes;
    EXPECT_TRUE(encoder.encode(crop, 95, bytes));
    bus::CameraTexture message;
    message.crop_px = picture.crop_px;
    message.colour = bytes.colour;
    message.mask = bytes.mask;
    return message;
}

template <typename Message>
void record_message(const Message& message, Timestamp time, recording::WorldWriter& writer) {
    const bus::RawTopic* topic = bus::find_raw_topic(bus::topic_name<Message>());
    EXPECT_TRUE(writer.write({topic, bus::RawKind::kSample, time, time, bus::to_cdr(message)}));
}

}  // namespace

void write_balls(const std::filesystem::path& file,
                 const std::string& site,
                 const BallRecording& content) {
    recording::WriterOptions options;
    options.file = file;
    options.world = "studio";
    options.host = "here";
    options.version = "1";
    auto writer = recording::WorldWriter::create(std::move(options));
    ASSERT_TRUE(writer) << writer.error().message;
    bus::SiteDescription description;
    description.site = site;
    description.cameras = ball_cameras();
    description.bounds_site = {{-2, -2, 0}, {2, 2, 3}};
    record_message(description, kBegin, *writer);
    if (content.has_placement) {
        const Eigen::AngleAxisd turn(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
        record_message(
            bus::SitePlacement{site, {Eigen::Quaterniond(turn), {5, 0, 0}}}, kBegin, *writer);
    }
    codec::TextureEncoder textures;
    codec::MeshEncoder meshes;
    std::vector<bus::CameraTexture> pictures;
    for (const auto& picture : ball_pictures()) pictures.push_back(coded(picture, textures));
    for (int i = 1; i <= content.num_frames; ++i) {
        const Timestamp time = kBegin + std::chrono::milliseconds(1000 + 50 * i);
        bus::SiteMesh mesh;
        mesh.site = site;
        mesh.frame_id = static_cast<std::uint64_t>(i);
        mesh.capture_time = kBegin + std::chrono::milliseconds(50 * i);
        if (!(content.is_empty_at_frame_2 && i == 2)) {
            geometry::TriangleMesh body = synthetic::mesh_of(balls(), 12);
            for (Eigen::Vector3d& p : body.vertices) p.z() += 0.01 * (i - 1);
            ASSERT_TRUE(meshes.encode(body, {}, mesh.draco));
            for (std::uint32_t c = 0; c < pictures.size(); ++c) {
                mesh.textured_cameras.push_back(c);
                bus::CameraTexture texture = pictures[c];
                texture.site = site;
                texture.camera = c;
                texture.frame_id = mesh.frame_id;
                texture.capture_time = mesh.capture_time;
                if (!(content.lacks_textures_of_frame_3 && i == 3))
                    record_message(texture, time, *writer);
            }
        }
        record_message(mesh, time, *writer);
    }
    ASSERT_TRUE(writer->finish());
}

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    EXPECT_TRUE(stream) << file;
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
}

}  // namespace atrium::exporting::testing
