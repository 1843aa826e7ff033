#include "bench/scale/coded_stream.hpp"

#include "bench/scenes/site_scene.hpp"
#include "core/base/executor.hpp"
#include "site_node/pipeline.hpp"

#include <fstream>
#include <string>
#include <type_traits>

namespace atrium::bench {
namespace {

// One function for both directions, which therefore cannot differ.
class Saver {
public:
    explicit Saver(const std::filesystem::path& file) : stream_(file, std::ios::binary) {}
    template <typename T>
    void number(const T& value) {
        static_assert(std::is_arithmetic_v<T>);
        stream_.write(reinterpret_cast<const char*>(&value), sizeof value);
    }
    template <typename Sequence>
    void resize(const Sequence& sequence) {
        number(sequence.size());
    }
    bool good() { return stream_.flush().good(); }

private:
    std::ofstream stream_;
};

class Loader {
public:
    explicit Loader(const std::filesystem::path& file) : stream_(file, std::ios::binary) {}
    template <typename T>
    void number(T& value) {
        static_assert(std::is_arithmetic_v<T>);
        stream_.read(reinterpret_cast<char*>(&value), sizeof value);
    }
    template <typename Sequence>
    void resize(Sequence& sequence) {
        constexpr std::size_t kMost = 1U << 24U;  // of a foreign file
        std::size_t size = 0;
        number(size);
        if (size > kMost) stream_.setstate(std::ios::failbit);
        sequence.resize(stream_.good() ? size : 0);
    }
    bool good() const { return stream_.good(); }

private:
    std::ifstream stream_;
};

void pass_numbers(auto& file, auto& sequence) {
    file.resize(sequence);
    for (auto& value : sequence) file.number(value);
}

void pass_vector(auto& file, auto& vector) {
    for (Eigen::Index i = 0; i < 3; ++i) file.number(vector[i]);
}

void pass_camera(auto& file, auto& camera) {
    pass_numbers(file, camera.name);
    auto& k = camera.intrinsics;
    file.number(k.width);
    file.number(k.height);
    for (auto* value : {&k.fx, &k.fy, &k.cx, &k.cy, &k.skew}) file.number(*value);
    for (auto& value : k.distortion) file.number(value);
    auto& rotation = camera.camera_from_site.rotation.coeffs();
    for (Eigen::Index i = 0; i < 4; ++i) file.number(rotation[i]);
    pass_vector(file, camera.camera_from_site.translation);
}

void pass_texture(auto& file, auto& texture) {
    file.number(texture.camera);
    auto& crop = texture.crop_px;
    for (auto* value : {&crop.x, &crop.y, &crop.width, &crop.height}) file.number(*value);
    pass_numbers(file, texture.colour);
    pass_numbers(file, texture.mask);
}

void pass(auto& file, auto& stream) {
    auto& description = stream.description;
    file.resize(description.cameras);
    for (auto& camera : description.cameras) pass_camera(file, camera);
    pass_vector(file, description.bounds_site.min);
    pass_vector(file, description.bounds_site.max);
    file.resize(stream.frames);
    for (auto& frame : stream.frames) {
        pass_numbers(file, frame.mesh.textured_cameras);
        pass_numbers(file, frame.mesh.draco);
        file.resize(frame.textures);
        for (auto& texture : frame.textures) pass_texture(file, texture);
    }
}

}  // namespace

CodedStream::Frame to_frame(const site_node::SiteFrame& coded) {
    CodedStream::Frame frame;
    frame.mesh.draco = coded.draco;
    for (const site_node::CodedCamera& camera : coded.cameras) {
        frame.mesh.textured_cameras.push_back(camera.camera);
        bus::CameraTexture texture;
        texture.camera = camera.camera;
        texture.crop_px = camera.crop_px;
        texture.colour = camera.texture.colour;
        texture.mask = camera.texture.mask;
        frame.textures.push_back(std::move(texture));
    }
    return frame;
}

Expected<CodedStream> code_simulated_person() {
    const SiteSceneOptions options;
    auto scene = SiteScene::create(options);
    if (!scene) return tl::unexpected(scene.error());
    auto pipeline = site_node::Pipeline::create(*scene, {}, {});
    if (!pipeline) return tl::unexpected(pipeline.error());
    CodedStream stream;
    stream.description.cameras = scene->rig().cameras;
    stream.description.bounds_site = scene->rig().bounds_site;
    SerialExecutor executor;
    for (int instant = 0; instant < options.num_instants; ++instant) {
        capture::Metaframe metaframe;
        for (std::size_t camera = 0; camera < scene->rig().cameras.size(); ++camera) {
            const auto& picture = scene->picture(static_cast<std::size_t>(instant), camera);
            metaframe.frames.push_back({camera, {}, picture, nullptr});
        }
        site_node::SiteFrame coded;
        if (auto ok = pipeline->process(metaframe, executor, coded); !ok)
            return tl::unexpected(ok.error());
        stream.frames.push_back(to_frame(coded));
    }
    return stream;
}

Expected<void> save(const CodedStream& stream, const std::filesystem::path& file) {
    Saver saver(file);
    pass(saver, stream);
    if (!saver.good())
        return make_error(ErrorKind::kUnavailable, file.string() + ": cannot be written");
    return {};
}

Expected<CodedStream> load_coded_stream(const std::filesystem::path& file) {
    Loader loader(file);
    CodedStream stream;
    pass(loader, stream);
    if (!loader.good() || stream.frames.empty())
        return make_error(ErrorKind::kInvalidData, file.string() + ": holds no coded stream");
    return stream;
}

}  // namespace atrium::bench
