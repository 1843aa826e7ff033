#include "tests/property/draco_reference.hpp"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace atrium::test {

using geometry::TriangleMesh;
using Point = std::array<float, 3>;

Bytes draco_bytes(const TriangleMesh& mesh, const codec::MeshCodecOptions& options) {
    draco::Mesh coded;
    coded.set_num_points(static_cast<std::uint32_t>(mesh.vertices.size()));
    draco::GeometryAttribute layout;
    layout.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    draco::PointAttribute& positions =
        *coded.attribute(coded.AddAttribute(layout, true, coded.num_points()));
    for (std::uint32_t i = 0; i < coded.num_points(); ++i) {
        const Eigen::Vector3f position = mesh.vertices[i].cast<float>();
        positions.SetAttributeValue(draco::AttributeValueIndex(i), position.data());
    }
    for (const auto& [a, b, c] : mesh.triangles)
        coded.AddFace({draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    encoder.options().SetGlobalInt("edgebreaker_method", draco::MESH_EDGEBREAKER_STANDARD_ENCODING);
    encoder.SetSpeedOptions(options.speed, options.speed);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, options.position_bits);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(coded, &buffer).ok()) return {};
    return {buffer.data(), buffer.data() + buffer.size()};
}

namespace {

Triangles canonical(const std::vector<std::array<Point, 3>>& triangles) {
    Triangles out;
    for (const auto& [a, b, c] : triangles)
        out.insert(std::min({std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}));
    return out;
}

}  // namespace

Triangles triangles_of(const Bytes& bytes) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    EXPECT_TRUE(decoded.ok()) << decoded.status().error_msg_string();
    if (!decoded.ok()) return {};
    const draco::Mesh& mesh = *decoded.value();
    const draco::PointAttribute& positions =
        *mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
    std::vector<std::array<Point, 3>> triangles(mesh.num_faces());
    for (std::uint32_t t = 0; t < mesh.num_faces(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const draco::PointIndex point = mesh.face(draco::FaceIndex(t))[k];
            positions.GetValue(positions.mapped_index(point), &triangles[t][k]);
        }
    }
    return canonical(triangles);
}

Triangles quantised(const TriangleMesh& mesh, int position_bits) {
    Eigen::Vector3f low = mesh.vertices[0].cast<float>();
    Eigen::Vector3f high = low;
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        low = low.cwiseMin(vertex.cast<float>());
        high = high.cwiseMax(vertex.cast<float>());
    }
    const float range = (high - low).maxCoeff() > 0.0F ? (high - low).maxCoeff() : 1.0F;
    const auto most = static_cast<float>((1 << position_bits) - 1);
    std::vector<Point> points;
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        Point point{};
        for (int i = 0; i < 3; ++i) {
            const float offset = static_cast<float>(vertex[i]) - low[i];
            const float step = std::floor(offset * (most / range) + 0.5F);
            point[static_cast<std::size_t>(i)] = step * (range / most) + low[i];
        }
        points.push_back(point);
    }
    std::vector<std::array<Point, 3>> triangles;
    for (const auto& [a, b, c] : mesh.triangles)
        triangles.push_back({points[a], points[b], points[c]});
    return canonical(triangles);
}

}  // namespace atrium::test
