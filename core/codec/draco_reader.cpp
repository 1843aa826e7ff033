#include "core/codec/draco_reader.hpp"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace atrium::codec {

namespace {

using geometry::TriangleMesh;

/// Draco's decoder with a check after each stage in which the stream declares the memory of the
/// next: only one position attribute of three floats and a bounded number of points pass.
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

/// Checks the counts in the header of an edgebreaker stream. Draco allocates tables for them before
/// it reads the data.
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

Expected<void> from_draco_mesh(const draco::Mesh& coded,
                               const MeshLimits& limits,
                               TriangleMesh& mesh) {
    const draco::PointAttribute* positions =
        coded.GetNamedAttribute(draco::GeometryAttribute::POSITION);
    if (positions == nullptr) return invalid_mesh("no positions");
    if (positions->byte_stride() != sizeof(Eigen::Vector3f))
        return invalid_mesh("not three floats");
    mesh.clear();
    const std::uint32_t num_points = coded.num_points();
    mesh.vertices.reserve(num_points);
    const auto max_m = static_cast<float>(
        std::min<double>(limits.max_coordinate_m, std::numeric_limits<float>::max()));
    for (std::uint32_t i = 0; i < num_points; ++i) {
        const draco::AttributeValueIndex value = positions->mapped_index(draco::PointIndex(i));
        if (value.value() >= positions->size()) return invalid_mesh("a vertex has no position");
        Eigen::Vector3f position;
        positions->GetValue(value, position.data());
        // NaN fails this condition as well
        if (!(std::abs(position.x()) <= max_m && std::abs(position.y()) <= max_m &&
              std::abs(position.z()) <= max_m))
            return invalid_mesh(
                fmt::format("a vertex is more than {:.4g} m from the origin along an axis, or not "
                            "finite; is its frame or unit wrong?",
                            max_m));
        mesh.vertices.push_back(position.cast<double>());
    }
    mesh.triangles.reserve(coded.num_faces());
    for (std::uint32_t i = 0; i < coded.num_faces(); ++i) {
        const draco::Mesh::Face& face = coded.face(draco::FaceIndex(i));
        const std::array triangle{face[0].value(), face[1].value(), face[2].value()};
        if (std::any_of(triangle.begin(), triangle.end(), [&](auto v) { return v >= num_points; }))
            return invalid_mesh("a triangle's index is out of range");
        mesh.triangles.push_back(triangle);
    }
    return {};
}

}  // namespace

tl::unexpected<Error> invalid_mesh(std::string_view what) {
    return make_error(ErrorKind::kInvalidData, fmt::format("mesh: {}", what));
}

Expected<void> read_with_draco(std::span<const std::uint8_t> bytes,
                               const MeshLimits& limits,
                               TriangleMesh& out) {
    if (const auto fault = find_header_fault(bytes, limits)) return invalid_mesh(*fault);
    try {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        draco::Mesh coded;
        const draco::DecoderOptions no_options;
        GuardedDecoder decoder(limits);
        const draco::Status status = decoder.Decode(no_options, &buffer, &coded);
        if (!status.ok()) return invalid_mesh(status.error_msg_string());
        return from_draco_mesh(coded, limits, out);
    } catch (const std::exception& error) {
        return invalid_mesh(error.what());
    }
}

}  // namespace atrium::codec
