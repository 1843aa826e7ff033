#include "core/codec/textured_mesh_codec.hpp"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace atrium::codec {
namespace {

int add_attribute(draco::GeometryAttribute::Type type,
                  std::int8_t num_components,
                  std::uint32_t num_values,
                  draco::Mesh& mesh) {
    draco::GeometryAttribute layout;
    layout.Init(type,
                nullptr,
                num_components,
                draco::DT_FLOAT32,
                false,
                static_cast<std::int64_t>(sizeof(float)) * num_components,
                0);
    return mesh.AddAttribute(layout, true, num_values);
}

Expected<void> check_textured(const TexturedTriangles& mesh) {
    if (mesh.positions.size() != mesh.uvs.size() || mesh.triangles.empty())
        return make_error(ErrorKind::kInvalidData, "a textured mesh without triangles or texture");
    const bool is_finite =
        std::ranges::all_of(mesh.positions, [](const auto& p) { return p.allFinite(); }) &&
        std::ranges::all_of(mesh.uvs, [](const auto& uv) { return uv.allFinite(); });
    if (!is_finite) return make_error(ErrorKind::kInvalidData, "a vertex is not finite");
    const std::size_t num_vertices = mesh.positions.size();
    for (const auto& triangle : mesh.triangles) {
        if (std::ranges::any_of(triangle, [&](auto v) { return v >= num_vertices; }))
            return make_error(ErrorKind::kInvalidData, "a triangle's index is out of range");
    }
    return {};
}

}  // namespace

Expected<std::vector<std::uint8_t>> encode_textured(const TexturedTriangles& mesh,
                                                    const TexturedCodecOptions& options) {
    if (auto good = check_textured(mesh); !good) return tl::unexpected(good.error());
    const auto num_vertices = static_cast<std::uint32_t>(mesh.positions.size());
    draco::Mesh out;
    out.set_num_points(num_vertices);
    const int positions = add_attribute(draco::GeometryAttribute::POSITION, 3, num_vertices, out);
    const int uvs = add_attribute(draco::GeometryAttribute::TEX_COORD, 2, num_vertices, out);
    for (std::uint32_t i = 0; i < num_vertices; ++i) {
        const draco::AttributeValueIndex value(i);
        out.attribute(positions)->SetAttributeValue(value, mesh.positions[i].data());
        out.attribute(uvs)->SetAttributeValue(value, mesh.uvs[i].data());
    }
    for (const auto& [a, b, c] : mesh.triangles) {
        if (a == b || b == c || c == a) continue;
        out.AddFace({draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
    }
    if (out.num_faces() == 0)
        return make_error(ErrorKind::kInvalidData, "no triangle has three different vertices");
    // charts meet at equal positions: the connectivity then goes across their borders
    if (!out.DeduplicateAttributeValues())
        return make_error(ErrorKind::kInternal, "Draco cannot merge equal positions");
    out.attribute(positions)->set_unique_id(kDracoPositionId);
    out.attribute(uvs)->set_unique_id(kDracoUvId);
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    encoder.SetSpeedOptions(options.speed, options.speed);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, options.position_bits);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, options.uv_bits);
    draco::EncoderBuffer buffer;
    if (const draco::Status status = encoder.EncodeMeshToBuffer(out, &buffer); !status.ok())
        return make_error(ErrorKind::kInternal, std::string("Draco: ") + status.error_msg());
    const auto* begin = reinterpret_cast<const std::uint8_t*>(buffer.data());
    return std::vector<std::uint8_t>(begin, begin + buffer.size());
}

Expected<TexturedTriangles> decode_textured(std::span<const std::uint8_t> bytes) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) {
        return make_error(ErrorKind::kInvalidData,
                          std::string("Draco: ") + decoded.status().error_msg());
    }
    const draco::Mesh& mesh = *decoded.value();
    const draco::PointAttribute* positions = mesh.GetAttributeByUniqueId(kDracoPositionId);
    const draco::PointAttribute* uvs = mesh.GetAttributeByUniqueId(kDracoUvId);
    if (positions == nullptr || uvs == nullptr || positions->num_components() != 3 ||
        uvs->num_components() != 2)
        return make_error(ErrorKind::kInvalidData, "Draco: no positions or texture coordinates");
    TexturedTriangles out;
    out.positions.resize(mesh.num_points());
    out.uvs.resize(mesh.num_points());
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        const draco::PointIndex point(i);
        positions->ConvertValue<float>(positions->mapped_index(point), out.positions[i].data());
        uvs->ConvertValue<float>(uvs->mapped_index(point), out.uvs[i].data());
    }
    for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
        const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
        out.triangles.push_back({face[0].value(), face[1].value(), face[2].value()});
    }
    return out;
}

}  // namespace atrium::codec
