#include "tools/export/formats/numbered_writer.hpp"

#include "core/base/write_check.hpp"
#include "tools/export/atlas/bake.hpp"
#include "tools/export/formats/output_file.hpp"
#include "tools/export/formats/place_mesh.hpp"
#include "tools/export/formats/texture_bytes.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>

namespace atrium::exporting {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is written as it lies");

// Lines that say what the file is, each after `mark`.
std::string facts_text(const ExportFacts& facts, const FrameTime& time, const char* mark) {
    return fmt::format(
        "{0}{1}\n{0}frame_of_reference: {2}\n{0}units: m\n{0}axes: {3}\n{0}rate_hz: {4:g}\n"
        "{0}frame: {5}\n{0}time_s: {6:.6f}\n{0}recording_s: {7:.6f}\n{0}capture_time_ns: {8}\n"
        "{0}source: {9}\n{0}colours_for: {10}\n",
        mark,
        facts.generator,
        facts.frame_of_reference,
        kOwnAxes,
        facts.rate_hz,
        time.number,
        time.time_s,
        time.recording_s,
        time.capture_time.ns,
        facts.source,
        facts.colours_for);
}

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

class NumberedWriter : public FrameWriter {
public:
    NumberedWriter(NumberedOptions options, ExportFacts facts)
        : options_(std::move(options)), facts_(std::move(facts)) {}

    Expected<void> add(EncodedFrame frame) override {
        std::error_code failure;
        if (!options_.folder.empty()) std::filesystem::create_directories(options_.folder, failure);
        if (failure) {
            return tl::unexpected(cannot_write(options_.folder, "create", failure.value()));
        }
        return write_frame(frame);
    }
    Expected<Written> finish() override { return written_; }

protected:
    virtual Expected<void> write_frame(const EncodedFrame& frame) = 0;

    std::string name(const FrameTime& time) const {
        return options_.is_single ? options_.stem
                                  : fmt::format("{}_{:06}", options_.stem, time.number);
    }
    Expected<void> write_one(const std::string& name, std::span<const std::uint8_t> bytes) {
        const std::filesystem::path file = options_.folder / name;
        if (auto done = write_file(file, bytes); !done) return done;
        written_.files.push_back(file);
        written_.bytes += bytes.size();
        return {};
    }
    const NumberedOptions& options() const { return options_; }
    const ExportFacts& facts() const { return facts_; }

private:
    NumberedOptions options_;
    ExportFacts facts_;
    Written written_;
};

class ObjWriter final : public NumberedWriter {
public:
    using NumberedWriter::NumberedWriter;

    Expected<EncodedFrame> encode(const PosedPerson& person, const FrameTime& time) const override {
        EncodedFrame frame;
        frame.time = time;
        TexturedMesh baked = bake(person.model, person.eye_site);
        std::string text = facts_text(facts(), time, "# ");
        if (!baked.triangles.empty()) {
            place(person.frame_from_site, baked.positions);
            write_mesh(baked, name(time), text);
            auto jpeg = texture_bytes(baked.texture, options().jpeg_quality);
            if (!jpeg) return tl::unexpected(jpeg.error());
            frame.picture = std::move(*jpeg);
        }
        frame.mesh = bytes_of(text);
        return frame;
    }

private:
    static void write_mesh(const TexturedMesh& mesh, const std::string& name, std::string& text) {
        auto out = std::back_inserter(text);
        fmt::format_to(out, "mtllib {0}.mtl\no {0}\nusemtl {0}\n", name);
        for (const Eigen::Vector3f& p : mesh.positions)
            fmt::format_to(out, "v {:.5f} {:.5f} {:.5f}\n", p.x(), p.y(), p.z());
        for (const Eigen::Vector2f& uv : mesh.uvs)
            fmt::format_to(out, "vt {:.6f} {:.6f}\n", uv.x(), 1.0f - uv.y());
        for (const auto& [a, b, c] : mesh.triangles) {
            fmt::format_to(out,
                           "f {}/{} {}/{} {}/{}\n",
                           mesh.position_of[a] + 1,
                           a + 1,
                           mesh.position_of[b] + 1,
                           b + 1,
                           mesh.position_of[c] + 1,
                           c + 1);
        }
    }

    // the .obj last: what it names is then there
    Expected<void> write_frame(const EncodedFrame& frame) override {
        const std::string stem = name(frame.time);
        if (!frame.picture.empty()) {
            if (auto done = write_one(stem + ".jpg", frame.picture); !done) return done;
            const std::string material = fmt::format(
                "{1}newmtl {0}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 0\nmap_Kd {0}.jpg\n",
                stem,
                facts_text(facts(), frame.time, "# "));
            if (auto done = write_one(stem + ".mtl", bytes_of(material)); !done) return done;
        }
        return write_one(stem + ".obj", frame.mesh);
    }
};

template <typename T>
void put(const T& value, std::vector<std::uint8_t>& out) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&value);
    out.insert(out.end(), begin, begin + sizeof(T));
}
void put_vector(const Eigen::Vector3f& value, std::vector<std::uint8_t>& out) {
    for (int i = 0; i < 3; ++i) put(value[i], out);
}
void put_colour(const Eigen::Vector3f& colour, std::vector<std::uint8_t>& out) {
    for (int i = 0; i < 3; ++i) out.push_back(static_cast<std::uint8_t>(colour[i] * 255.0f + 0.5f));
}

constexpr const char* kPosition = "property float x\nproperty float y\nproperty float z\n";
constexpr const char* kColour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

class PlyWriter final : public NumberedWriter {
public:
    using NumberedWriter::NumberedWriter;

    Expected<EncodedFrame> encode(const PosedPerson& person, const FrameTime& time) const override {
        EncodedFrame frame;
        frame.time = time;
        ColouredMesh mesh = colour_vertices(person.model, person.eye_site);
        place(person.frame_from_site, mesh.positions);
        frame.mesh = bytes_of(
            fmt::format("ply\nformat binary_little_endian 1.0\n{}element vertex {}\n{}{}"
                        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                        facts_text(facts(), time, "comment "),
                        mesh.positions.size(),
                        kPosition,
                        kColour,
                        mesh.triangles.size()));
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            put_vector(mesh.positions[v], frame.mesh);
            put_colour(mesh.colours[v], frame.mesh);
        }
        for (const auto& triangle : mesh.triangles) {
            frame.mesh.push_back(3);
            for (const std::uint32_t v : triangle) put(static_cast<std::int32_t>(v), frame.mesh);
        }
        return frame;
    }

private:
    Expected<void> write_frame(const EncodedFrame& frame) override {
        return write_one(name(frame.time) + ".ply", frame.mesh);
    }
};

class PointsWriter final : public NumberedWriter {
public:
    using NumberedWriter::NumberedWriter;

    Expected<EncodedFrame> encode(const PosedPerson& person, const FrameTime& time) const override {
        EncodedFrame frame;
        frame.time = time;
        PointCloud cloud = sample(person.model, options().num_points, person.eye_site);
        place(person.frame_from_site, cloud.positions);
        const Eigen::Matrix3f turn =
            person.frame_from_site.rotation.toRotationMatrix().cast<float>();
        frame.mesh =
            bytes_of(fmt::format("ply\nformat binary_little_endian 1.0\n{}element vertex {}\n{}"
                                 "property float nx\nproperty float ny\nproperty float nz\n{}"
                                 "end_header\n",
                                 facts_text(facts(), time, "comment "),
                                 cloud.positions.size(),
                                 kPosition,
                                 kColour));
        for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
            put_vector(cloud.positions[i], frame.mesh);
            put_vector(turn * cloud.normals[i], frame.mesh);
            put_colour(cloud.colours[i], frame.mesh);
        }
        return frame;
    }

private:
    Expected<void> write_frame(const EncodedFrame& frame) override {
        return write_one(name(frame.time) + ".ply", frame.mesh);
    }
};

}  // namespace

std::unique_ptr<FrameWriter> make_obj_writer(const NumberedOptions& options,
                                             const ExportFacts& facts) {
    return std::make_unique<ObjWriter>(options, facts);
}
std::unique_ptr<FrameWriter> make_ply_writer(const NumberedOptions& options,
                                             const ExportFacts& facts) {
    return std::make_unique<PlyWriter>(options, facts);
}
std::unique_ptr<FrameWriter> make_points_writer(const NumberedOptions& options,
                                                const ExportFacts& facts) {
    return std::make_unique<PointsWriter>(options, facts);
}

}  // namespace atrium::exporting
