#include "tools/export/formats/glb_writer.hpp"

#include "core/codec/textured_mesh_codec.hpp"
#include "tools/export/atlas/bake.hpp"
#include "tools/export/formats/gltf_file.hpp"
#include "tools/export/formats/place_mesh.hpp"
#include "tools/export/formats/texture_bytes.hpp"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>

namespace atrium::exporting {
namespace {

namespace fs = std::filesystem;
using Json = GltfFile::Json;

constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;
constexpr int kFloats = 5126;
constexpr int kUnsignedInts = 5125;
constexpr double kNearM = 0.05;

// -90 degrees about x: +Z up becomes +Y up.
const std::array<double, 4> kUpright{-std::numbers::sqrt2 / 2, 0.0, 0.0, std::numbers::sqrt2 / 2};

fs::path numbered(const fs::path& file, std::size_t number) {
    fs::path result = file;
    result.replace_filename(
        fmt::format("{}_{:03}{}", file.stem().string(), number, file.extension().string()));
    return result;
}

template <typename T>
void append(const T& values, std::vector<std::uint8_t>& out) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(values.data());
    out.insert(out.end(), begin, begin + values.size() * sizeof(values[0]));
}

// Positions, texture coordinates, triangles.
std::vector<std::uint8_t> plain_bytes(const codec::TexturedTriangles& mesh) {
    std::vector<std::uint8_t> bytes;
    append(mesh.positions, bytes);
    append(mesh.uvs, bytes);
    append(mesh.triangles, bytes);
    return bytes;
}

class GlbWriter final : public FrameWriter {
public:
    GlbWriter(const GlbOptions& options, const ExportFacts& facts, std::optional<CameraPath> path)
        : options_(options), facts_(facts), path_(std::move(path)) {
        begin_file();
    }

    Expected<EncodedFrame> encode(const PosedPerson& person, const FrameTime& time) const override {
        EncodedFrame frame;
        frame.time = time;
        TexturedMesh baked = bake(person.model, person.eye_site);
        if (baked.triangles.empty()) return frame;
        place(person.frame_from_site, baked.positions);
        codec::TexturedTriangles mesh;
        for (const std::uint32_t position : baked.position_of)
            mesh.positions.push_back(baked.positions[position]);
        mesh.uvs = std::move(baked.uvs);
        mesh.triangles = std::move(baked.triangles);
        if (options_.has_draco) {
            auto coded = codec::encode_textured(mesh, {});
            if (!coded) return tl::unexpected(coded.error());
            auto decoded = codec::decode_textured(*coded);
            if (!decoded) return tl::unexpected(decoded.error());
            frame.mesh = std::move(*coded);
            mesh = std::move(*decoded);
        } else {
            frame.mesh = plain_bytes(mesh);
        }
        frame.num_vertices = static_cast<std::uint32_t>(mesh.positions.size());
        frame.num_triangles = static_cast<std::uint32_t>(mesh.triangles.size());
        frame.low = frame.high = mesh.positions.front();
        for (const Eigen::Vector3f& p : mesh.positions) {
            frame.low = frame.low.cwiseMin(p);
            frame.high = frame.high.cwiseMax(p);
        }
        auto jpeg = texture_bytes(baked.texture, options_.jpeg_quality);
        if (!jpeg) return tl::unexpected(jpeg.error());
        frame.picture = std::move(*jpeg);
        return frame;
    }

    Expected<void> add(EncodedFrame frame) override {
        const std::uint64_t bytes = file_.num_bytes() + frame.mesh.size() + frame.picture.size();
        const bool is_full = (options_.file_bytes > 0 && bytes > options_.file_bytes) ||
                             (options_.file_frames > 0 && shown_.size() >= options_.file_frames);
        if (is_full && !shown_.empty()) {
            if (auto done = end_file(frame.time.time_s, true); !done) return done;
            begin_file();
        }
        Json node{{"name", fmt::format("{}_{:06}", facts_.site, frame.time.number)},
                  {"extras",
                   {{"time_s", frame.time.time_s},
                    {"recording_s", frame.time.recording_s},
                    {"capture_time_ns", std::to_string(frame.time.capture_time.ns)}}}};
        if (!frame.mesh.empty()) node["mesh"] = add_mesh(frame);
        if (!shown_.empty()) node["scale"] = {0, 0, 0};
        shown_.push_back({file_.add("nodes", std::move(node)), frame.time.time_s});
        return {};
    }

    Expected<Written> finish() override {
        if (auto done = end_file(0.0, false); !done) return tl::unexpected(done.error());
        return written_;
    }

private:
    struct Shown {
        int node = 0;
        double time_s = 0.0;
    };

    void begin_file() {
        file_ = GltfFile();
        shown_.clear();
        Json& json = file_.json();
        json["asset"]["generator"] = facts_.generator;
        json["asset"]["extras"] = {{"frame_of_reference", facts_.frame_of_reference},
                                   {"units", "m"},
                                   {"axes", "right-handed, +Y up"},
                                   {"rate_hz", facts_.rate_hz},
                                   {"source", facts_.source},
                                   {"begin_utc", facts_.begin_utc},
                                   {"colours_for", facts_.colours_for}};
        json["scene"] = 0;
        json["scenes"] = Json::array({{{"nodes", {0}}}});
        json["nodes"] = Json::array({{{"name", facts_.site}, {"rotation", kUpright}}});
    }

    int add_mesh(const EncodedFrame& frame) {
        const std::string name = fmt::format("{}_{:06}", facts_.site, frame.time.number);
        const int image = file_.add("images",
                                    {{"name", name},
                                     {"mimeType", "image/jpeg"},
                                     {"bufferView", file_.add_view(frame.picture)}});
        if (!file_.json().contains("samplers")) {
            constexpr int kLinear = 9729;
            constexpr int kLinearMipmapLinear = 9987;
            constexpr int kClamp = 33071;
            file_.add("samplers",
                      {{"magFilter", kLinear},
                       {"minFilter", kLinearMipmapLinear},
                       {"wrapS", kClamp},
                       {"wrapT", kClamp}});
        }
        const int texture = file_.add("textures", {{"sampler", 0}, {"source", image}});
        use("KHR_materials_unlit", false);
        const int material = file_.add("materials",
                                       {{"name", name},
                                        {"pbrMetallicRoughness",
                                         {{"baseColorTexture", {{"index", texture}}},
                                          {"metallicFactor", 0.0},
                                          {"roughnessFactor", 1.0}}},
                                        {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
        Json primitive = options_.has_draco ? draco_primitive(frame) : plain_primitive(frame);
        primitive["material"] = material;
        return file_.add("meshes",
                         {{"name", name}, {"primitives", Json::array({std::move(primitive)})}});
    }

    static Json accessor(int component_type, std::uint64_t count, const char* type) {
        return {{"componentType", component_type}, {"count", count}, {"type", type}};
    }
    static Json positions_accessor(const EncodedFrame& frame) {
        Json result = accessor(kFloats, frame.num_vertices, "VEC3");
        result["min"] = {frame.low.x(), frame.low.y(), frame.low.z()};
        result["max"] = {frame.high.x(), frame.high.y(), frame.high.z()};
        return result;
    }

    Json draco_primitive(const EncodedFrame& frame) {
        use("KHR_draco_mesh_compression", true);
        const int positions = file_.add("accessors", positions_accessor(frame));
        const int uvs = file_.add("accessors", accessor(kFloats, frame.num_vertices, "VEC2"));
        const int indices = file_.add(
            "accessors", accessor(kUnsignedInts, std::uint64_t{frame.num_triangles} * 3, "SCALAR"));
        return {
            {"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
            {"indices", indices},
            {"extensions",
             {{"KHR_draco_mesh_compression",
               {{"bufferView", file_.add_view(frame.mesh)},
                {"attributes",
                 {{"POSITION", codec::kDracoPositionId}, {"TEXCOORD_0", codec::kDracoUvId}}}}}}}};
    }

    Json plain_primitive(const EncodedFrame& frame) {
        const std::size_t positions_bytes = std::size_t{12} * frame.num_vertices;
        const std::size_t uvs_bytes = std::size_t{8} * frame.num_vertices;
        const std::span<const std::uint8_t> bytes(frame.mesh);
        Json positions = positions_accessor(frame);
        positions["bufferView"] = file_.add_view(bytes.first(positions_bytes), kArrayBuffer);
        Json uvs = accessor(kFloats, frame.num_vertices, "VEC2");
        uvs["bufferView"] = file_.add_view(bytes.subspan(positions_bytes, uvs_bytes), kArrayBuffer);
        Json indices = accessor(kUnsignedInts, std::uint64_t{frame.num_triangles} * 3, "SCALAR");
        indices["bufferView"] =
            file_.add_view(bytes.subspan(positions_bytes + uvs_bytes), kElementArrayBuffer);
        const int positions_index = file_.add("accessors", std::move(positions));
        const int uvs_index = file_.add("accessors", std::move(uvs));
        return {{"attributes", {{"POSITION", positions_index}, {"TEXCOORD_0", uvs_index}}},
                {"indices", file_.add("accessors", std::move(indices))}};
    }

    void use(const char* extension, bool is_required) {
        for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
            if (list == std::string("extensionsRequired") && !is_required) continue;
            Json& names = file_.json()[list];
            if (std::find(names.begin(), names.end(), extension) == names.end())
                names.push_back(extension);
        }
    }

    // Shows each frame from its time up to that of the next one.
    void animate_frames(double next_s, bool goes_on) {
        if (shown_.size() < 2 && shown_.front().time_s <= 0.0 && !goes_on) return;
        Json channels = Json::array();
        Json samplers = Json::array();
        for (std::size_t i = 0; i < shown_.size(); ++i) {
            const double begin_s = shown_[i].time_s;
            std::vector<float> times;
            std::vector<float> scales;
            const auto key = [&](double time_s, float scale) {
                times.push_back(static_cast<float>(time_s));
                scales.insert(scales.end(), 3, scale);
            };
            if (begin_s > 0.0) key(0.0, 0.0f);
            key(begin_s, 1.0f);
            if (i + 1 < shown_.size())
                key(shown_[i + 1].time_s, 0.0f);
            else if (goes_on)
                key(next_s, 0.0f);
            samplers.push_back({{"input", file_.add_floats(times, 1)},
                                {"interpolation", "STEP"},
                                {"output", file_.add_floats(scales, 3)}});
            channels.push_back(
                {{"sampler", i}, {"target", {{"node", shown_[i].node}, {"path", "scale"}}}});
        }
        file_.add("animations",
                  {{"name", "frames"},
                   {"channels", std::move(channels)},
                   {"samplers", std::move(samplers)}});
    }

    void add_camera(const CameraPath& path) {
        const int camera = file_.add(
            "cameras",
            {{"name", "path"},
             {"type", "perspective"},
             {"perspective",
              {{"yfov", path.fov_rad}, {"aspectRatio", path.aspect}, {"znear", kNearM}}}});
        std::vector<float> times;
        std::vector<float> places;
        std::vector<float> turns;
        // glTF's cameras look along -Z, +Y is up
        const Eigen::Quaterniond camera_from_gltf(0.0, 1.0, 0.0, 0.0);
        Eigen::Quaterniond last = Eigen::Quaterniond::Identity();
        for (const CameraKey& key : path.keys) {
            Eigen::Quaterniond turn = key.frame_from_camera.rotation * camera_from_gltf;
            if (!times.empty() && turn.dot(last) < 0.0) turn.coeffs() = -turn.coeffs();
            last = turn;
            times.push_back(static_cast<float>(key.time_s));
            for (int i = 0; i < 3; ++i)
                places.push_back(static_cast<float>(key.frame_from_camera.translation[i]));
            for (int i = 0; i < 4; ++i) turns.push_back(static_cast<float>(turn.coeffs()[i]));
        }
        const int node =
            file_.add("nodes",
                      {{"name", "camera_path"},
                       {"camera", camera},
                       {"translation", std::vector<float>(places.begin(), places.begin() + 3)},
                       {"rotation", std::vector<float>(turns.begin(), turns.begin() + 4)}});
        file_.json()["nodes"][0]["children"].push_back(node);
        if (times.size() < 2) return;
        const int input = file_.add_floats(times, 1);
        const auto sampler = [&](const std::vector<float>& values, int num_components) {
            return Json{{"input", input},
                        {"interpolation", "LINEAR"},
                        {"output", file_.add_floats(values, num_components)}};
        };
        Json samplers = Json::array({sampler(places, 3), sampler(turns, 4)});
        file_.add("animations",
                  {{"name", "camera_path"},
                   {"channels",
                    {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}},
                     {{"sampler", 1}, {"target", {{"node", node}, {"path", "rotation"}}}}}},
                   {"samplers", std::move(samplers)}});
    }

    Expected<void> end_file(double next_s, bool goes_on) {
        if (shown_.empty()) return {};
        for (const Shown& shown : shown_)
            file_.json()["nodes"][0]["children"].push_back(shown.node);
        animate_frames(next_s, goes_on);
        if (path_ && !path_->keys.empty() && written_.files.empty()) add_camera(*path_);
        if (goes_on || !written_.files.empty()) is_numbered_ = true;
        const fs::path file =
            is_numbered_ ? numbered(options_.file, written_.files.size() + 1) : options_.file;
        const auto bytes = file_.write(file);
        if (!bytes) return tl::unexpected(bytes.error());
        written_.files.push_back(file);
        written_.bytes += *bytes;
        return {};
    }

    GlbOptions options_;
    ExportFacts facts_;
    std::optional<CameraPath> path_;
    GltfFile file_;
    std::vector<Shown> shown_;  // frames of this file
    bool is_numbered_ = false;
    Written written_;
};

}  // namespace

std::unique_ptr<FrameWriter> make_glb_writer(const GlbOptions& options,
                                             const ExportFacts& facts,
                                             const std::optional<CameraPath>& path) {
    return std::make_unique<GlbWriter>(options, facts, path);
}

}  // namespace atrium::exporting
