#include "core/codec/mesh_codec.hpp"

#include "core/codec/edgebreaker_writer.hpp"

#include <draco/compression/encode.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace atrium::codec {

namespace {

using geometry::TriangleMesh;

tl::unexpected<Error> invalid(std::string_view what) {
    return make_error(ErrorKind::kInvalidData, fmt::format("mesh: {}", what));
}

double step_m(double side_m, int position_bits) {
    return side_m / static_cast<double>((1U << static_cast<unsigned>(position_bits)) - 1U);
}

std::optional<std::string_view> find_fault(const TriangleMesh& mesh) {
    const std::size_t num_vertices = mesh.vertices.size();
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        if (!vertex.cast<float>().allFinite()) return "a vertex is not finite";
    }
    for (const auto& triangle : mesh.triangles) {
        if (std::any_of(
                triangle.begin(), triangle.end(), [&](auto v) { return v >= num_vertices; }))
            return "a triangle's index is out of range";
    }
    return std::nullopt;
}

void fill_draco_mesh(const TriangleMesh& mesh, draco::Mesh& out) {
    const auto num_vertices = static_cast<std::uint32_t>(mesh.vertices.size());
    out.set_num_points(num_vertices);
    draco::GeometryAttribute layout;
    layout.Init(draco::GeometryAttribute::POSITION,
                nullptr,
                3,
                draco::DT_FLOAT32,
                false,
                sizeof(float) * 3,
                0);
    const int id = out.AddAttribute(layout, true, num_vertices);
    draco::PointAttribute& positions = *out.attribute(id);
    for (std::uint32_t i = 0; i < num_vertices; ++i) {
        const Eigen::Vector3f position = mesh.vertices[i].cast<float>();
        positions.SetAttributeValue(draco::AttributeValueIndex(i), position.data());
    }
    out.SetNumFaces(mesh.triangles.size());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        out.SetFace(
            draco::FaceIndex(i),
            draco::Mesh::Face{draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
    }
}

draco::Status encode_with_draco(const TriangleMesh& mesh,
                                const MeshCodecOptions& options,
                                draco::EncoderBuffer& out) {
    draco::Mesh draco_mesh;
    fill_draco_mesh(mesh, draco_mesh);
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    // The decoder accepts this one way of writing the symbols, whatever the speed.
    encoder.options().SetGlobalInt("edgebreaker_method", draco::MESH_EDGEBREAKER_STANDARD_ENCODING);
    encoder.SetSpeedOptions(options.speed, options.speed);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, options.position_bits);
    return encoder.EncodeMeshToBuffer(draco_mesh, &out);
}

/// Draco's decoder with a stop after every stage in which a stream declares how much memory the
/// next one takes: one position attribute of three floats and a bounded number of points.
class GuardedDecoder : public draco::MeshEdgebreakerDecoder {
public:
    explicit GuardedDecoder(const MeshLimits& limits) : limits_(limits) {}

protected:
    bool CreateAttributesDecoder(std::int32_t decoder_id) override {
        return decoder_id == 0 && mesh()->num_faces() <= limits_.max_triangles &&
               mesh()->num_points() <= limits_.max_vertices &&
               MeshEdgebreakerDecoder::CreateAttributesDecoder(decoder_id);
    }

    bool DecodeAllAttributes() override {
        if (point_cloud()->num_attributes() != 1) return false;
        const draco::PointAttribute& only = *point_cloud()->attribute(0);
        return only.attribute_type() == draco::GeometryAttribute::POSITION &&
               only.data_type() == draco::DT_FLOAT32 && only.num_components() == 3 &&
               MeshEdgebreakerDecoder::DecodeAllAttributes();
    }

private:
    MeshLimits limits_;
};

/// Reads the counts that stand in front of an edgebreaker stream. Draco allocates tables for them
/// before it looks at the data that should back them up.
std::optional<std::string> find_header_fault(std::span<const std::uint8_t> bytes,
                                             const MeshLimits& limits) {
    // "DRACO", version 2.2, triangular mesh, edgebreaker, no flags (no metadata), standard symbols
    constexpr std::array<std::uint8_t, 12> kStart{'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0, 0};
    if (bytes.size() < kStart.size() || !std::equal(kStart.begin(), kStart.end(), bytes.begin()))
        return "not a Draco 2.2 edgebreaker mesh";
    draco::DecoderBuffer rest;
    rest.Init(reinterpret_cast<const char*>(bytes.data()) + kStart.size(),
              bytes.size() - kStart.size(),
              DRACO_BITSTREAM_VERSION(2, 2));
    std::uint32_t num_vertices = 0;
    std::uint32_t num_triangles = 0;
    if (!draco::DecodeVarint(&num_vertices, &rest) || !draco::DecodeVarint(&num_triangles, &rest))
        return "ends within its header";
    if (num_vertices > limits.max_vertices)
        return fmt::format("{} vertices, at most {} are read", num_vertices, limits.max_vertices);
    if (num_triangles > limits.max_triangles)
        return fmt::format(
            "{} triangles, at most {} are read", num_triangles, limits.max_triangles);
    return std::nullopt;
}

Expected<TriangleMesh> from_draco_mesh(const draco::Mesh& coded, const MeshLimits& limits) {
    const draco::PointAttribute* positions =
        coded.GetNamedAttribute(draco::GeometryAttribute::POSITION);
    if (positions == nullptr) return invalid("no positions");
    TriangleMesh mesh;
    const std::uint32_t num_points = coded.num_points();
    mesh.vertices.reserve(num_points);
    for (std::uint32_t i = 0; i < num_points; ++i) {
        const draco::AttributeValueIndex value = positions->mapped_index(draco::PointIndex(i));
        Eigen::Vector3f position;
        if (value.value() >= positions->size() ||
            !positions->ConvertValue<float, 3>(value, position.data()))
            return invalid("a vertex has no position");
        // Written so that NaN fails as well.
        if (!(position.cwiseAbs().maxCoeff() <= limits.max_coordinate_m) || !position.allFinite())
            return invalid("a coordinate is not finite or too large");
        mesh.vertices.push_back(position.cast<double>());
    }
    mesh.triangles.reserve(coded.num_faces());
    for (std::uint32_t i = 0; i < coded.num_faces(); ++i) {
        const draco::Mesh::Face& face = coded.face(draco::FaceIndex(i));
        const std::array triangle{face[0].value(), face[1].value(), face[2].value()};
        if (std::any_of(triangle.begin(), triangle.end(), [&](auto v) { return v >= num_points; }))
            return invalid("a triangle's index is out of range");
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

}  // namespace

double quantisation_step_m(const TriangleMesh& mesh, const MeshCodecOptions& options) {
    if (mesh.vertices.empty()) return 0.0;
    return step_m(geometry::bounds(mesh).size().maxCoeff(), options.position_bits);
}

int position_bits_for(const TriangleMesh& mesh,
                      std::span<const geometry::CalibratedCamera> cameras) {
    constexpr int kFewestBits = 8;
    constexpr int kMostBits = 16;
    constexpr int kUnseenBits = 14;
    double most_sq = 0.0;  // [px^2 / m^2]
    for (const geometry::CalibratedCamera& camera : cameras) {
        const Eigen::Matrix3d rotation = camera.camera_from_site.rotation.toRotationMatrix();
        const Eigen::Vector3d& translation = camera.camera_from_site.translation;
        const double focal_px = std::max(camera.intrinsics.fx, camera.intrinsics.fy);
        double widest = 0.0;  // distance^2 / depth^4
        for (const Eigen::Vector3d& vertex : mesh.vertices) {
            const Eigen::Vector3d seen = rotation * vertex + translation;
            const double depth_sq = seen.z() * seen.z();
            // the division is rare
            if (seen.squaredNorm() > widest * (depth_sq * depth_sq) && seen.z() > 0.0)
                widest = seen.squaredNorm() / (depth_sq * depth_sq);
        }
        most_sq = std::max(most_sq, focal_px * focal_px * widest);
    }
    if (most_sq == 0.0) return kUnseenBits;
    const double longest_step_m = 2.0 * kStepInTexturePixels / std::sqrt(most_sq);
    const double side_m = geometry::bounds(mesh).size().maxCoeff();
    int bits = kFewestBits;
    while (bits < kMostBits && step_m(side_m, bits) > longest_step_m) ++bits;
    return bits;
}

struct MeshEncoder::State {
    EdgebreakerWriter writer;
    draco::EncoderBuffer buffer;
};

MeshEncoder::MeshEncoder() : state_(std::make_unique<State>()) {}
MeshEncoder::~MeshEncoder() = default;
MeshEncoder::MeshEncoder(MeshEncoder&&) noexcept = default;
MeshEncoder& MeshEncoder::operator=(MeshEncoder&&) noexcept = default;

Expected<std::size_t> MeshEncoder::encode(const TriangleMesh& mesh,
                                          const MeshCodecOptions& options,
                                          std::vector<std::uint8_t>& out) {
    assert(options.position_bits >= 8 && options.position_bits <= 20);
    assert(options.speed >= 0 && options.speed <= 10);
    out.clear();
    if (mesh.empty()) return 0;
    if (const auto fault = find_fault(mesh)) return invalid(*fault);
    draco::EncoderBuffer& buffer = state_->buffer;
    try {
        buffer.Clear();
        if (!EdgebreakerWriter::takes_speed(options.speed) ||
            !state_->writer.write(mesh, options.position_bits, options.speed, buffer)) {
            const draco::Status status = encode_with_draco(mesh, options, buffer);
            if (!status.ok()) return invalid(status.error_msg_string());
        }
        // sizes differ a little each time
        if (out.capacity() < buffer.size()) out.reserve(std::bit_ceil(buffer.size()));
        out.assign(buffer.data(), buffer.data() + buffer.size());
        return out.size();
    } catch (const std::exception& error) {
        buffer = {};  // it may be in the middle of something
        return make_error(ErrorKind::kInternal, fmt::format("mesh encoder: {}", error.what()));
    }
}

Expected<std::size_t> encode_mesh(const TriangleMesh& mesh,
                                  const MeshCodecOptions& options,
                                  std::vector<std::uint8_t>& out) {
    return MeshEncoder().encode(mesh, options, out);
}

Expected<TriangleMesh> decode_mesh(std::span<const std::uint8_t> bytes, const MeshLimits& limits) {
    if (bytes.empty()) return TriangleMesh{};
    if (const auto fault = find_header_fault(bytes, limits)) return invalid(*fault);
    try {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        draco::Mesh coded;
        const draco::DecoderOptions no_options;
        GuardedDecoder decoder(limits);
        const draco::Status status = decoder.Decode(no_options, &buffer, &coded);
        if (!status.ok()) return invalid(status.error_msg_string());
        return from_draco_mesh(coded, limits);
    } catch (const std::exception& error) {
        return invalid(error.what());
    }
}

}  // namespace atrium::codec
