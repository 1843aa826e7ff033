#include "core/codec/mesh_codec.hpp"

#include "core/codec/draco_reader.hpp"
#include "core/codec/edgebreaker_reader.hpp"
#include "core/codec/edgebreaker_writer.hpp"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace atrium::codec {

namespace {

using geometry::TriangleMesh;

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
    // The decoder accepts only this coding of the symbols, at every speed.
    encoder.options().SetGlobalInt("edgebreaker_method", draco::MESH_EDGEBREAKER_STANDARD_ENCODING);
    encoder.SetSpeedOptions(options.speed, options.speed);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, options.position_bits);
    return encoder.EncodeMeshToBuffer(draco_mesh, &out);
}

/// Square of the largest motion in the picture per metre of motion of any vertex [px^2 / m^2].
double most_motion_sq(const TriangleMesh& mesh, const geometry::CalibratedCamera& camera) {
    const Eigen::Matrix3d rotation = camera.camera_from_site.rotation.toRotationMatrix();
    const Eigen::Vector3d& translation = camera.camera_from_site.translation;
    const double focal_px = std::max(camera.intrinsics.fx, camera.intrinsics.fy);
    double widest = 0.0;  // distance^2 / depth^4
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        const Eigen::Vector3d seen = rotation * vertex + translation;
        const double depth_sq = seen.z() * seen.z();
        // the comparison avoids most divisions
        if (seen.squaredNorm() > widest * (depth_sq * depth_sq) && seen.z() > 0.0)
            widest = seen.squaredNorm() / (depth_sq * depth_sq);
    }
    return focal_px * focal_px * widest;
}

// A camera in floats: the depth of a point is `depth_axis * point + depth`.
struct DepthCamera {
    explicit DepthCamera(const geometry::CalibratedCamera& camera) {
        const Eigen::Matrix3d rotation = camera.camera_from_site.rotation.toRotationMatrix();
        const Eigen::Vector3d& translation = camera.camera_from_site.translation;
        depth_axis = rotation.row(2).transpose().cast<float>();
        depth = static_cast<float>(translation.z());
        centre_m = (-(rotation.transpose() * translation)).cast<float>();
        const double focal_px = std::max(camera.intrinsics.fx, camera.intrinsics.fy);
        focal_sq = static_cast<float>(focal_px * focal_px);
    }

    Eigen::Vector3f depth_axis;
    float depth = 0.0F;
    Eigen::Vector3f centre_m;
    float focal_sq = 0.0F;
};

// Estimates the maximum of most_motion_sq over all cameras with a relative error of at most
// kEstimateError: in floats, several vertices at once. Returns nullopt if a vertex is so near to a
// camera's plane, or so far away, that the error could be larger.
constexpr double kEstimateError = 1e-3;

std::optional<double> estimate_most_motion_sq(const TriangleMesh& mesh,
                                              std::span<const geometry::CalibratedCamera> cameras) {
    constexpr float kLeastDepth_m = 0.25F;
    constexpr double kFurthest_m = 60.0;
    constexpr std::size_t kLanes = 8;
    constexpr std::size_t kChunk = 512;
    using Lanes = std::array<float, kLanes>;
    const geometry::Aabb box = geometry::bounds(mesh);
    if (!(std::max(-box.min.minCoeff(), box.max.maxCoeff()) < kFurthest_m)) return std::nullopt;
    std::array<std::array<Lanes, kChunk / kLanes>, 3> at;
    Lanes most{};
    Lanes nearest;
    Lanes furthest_sq{};
    nearest.fill(std::numeric_limits<float>::infinity());
    for (std::size_t first = 0; first < mesh.vertices.size(); first += kChunk) {
        const std::size_t num = std::min(kChunk, mesh.vertices.size() - first);
        const std::size_t num_groups = (num + kLanes - 1) / kLanes;
        for (std::size_t i = 0; i < num_groups * kLanes; ++i) {
            // pad the last group with the last vertex
            const Eigen::Vector3d& vertex = mesh.vertices[first + std::min(i, num - 1)];
            for (std::size_t axis = 0; axis < 3; ++axis)
                at[axis][i / kLanes][i % kLanes] =
                    static_cast<float>(vertex[static_cast<Eigen::Index>(axis)]);
        }
        for (const geometry::CalibratedCamera& calibrated : cameras) {
            const DepthCamera camera(calibrated);
            for (std::size_t group = 0; group < num_groups; ++group) {
                const Lanes& x = at[0][group];
                const Lanes& y = at[1][group];
                const Lanes& z = at[2][group];
                for (std::size_t i = 0; i < kLanes; ++i) {
                    const float depth = camera.depth_axis.x() * x[i] +
                                        camera.depth_axis.y() * y[i] +
                                        camera.depth_axis.z() * z[i] + camera.depth;
                    const float dx = x[i] - camera.centre_m.x();
                    const float dy = y[i] - camera.centre_m.y();
                    const float dz = z[i] - camera.centre_m.z();
                    const float distance_sq = dx * dx + dy * dy + dz * dz;
                    const float depth_sq = depth * depth;
                    const float motion_sq = camera.focal_sq * distance_sq / (depth_sq * depth_sq);
                    most[i] = most[i] < motion_sq ? motion_sq : most[i];
                    nearest[i] = depth < nearest[i] ? depth : nearest[i];
                    furthest_sq[i] = furthest_sq[i] < distance_sq ? distance_sq : furthest_sq[i];
                }
            }
        }
    }
    if (*std::min_element(nearest.begin(), nearest.end()) < kLeastDepth_m ||
        *std::max_element(furthest_sq.begin(), furthest_sq.end()) > kFurthest_m * kFurthest_m)
        return std::nullopt;
    return *std::max_element(most.begin(), most.end());
}

int position_bits_of(double side_m, double most_motion_sq) {
    constexpr int kFewestBits = 8;
    constexpr int kMostBits = 16;
    const double longest_step_m = 2.0 * kStepInTexturePixels / std::sqrt(most_motion_sq);
    int bits = kFewestBits;
    while (bits < kMostBits && step_m(side_m, bits) > longest_step_m) ++bits;
    return bits;
}

}  // namespace

int position_bits_for(const TriangleMesh& mesh,
                      std::span<const geometry::CalibratedCamera> cameras) {
    constexpr int kUnseenBits = 14;
    const double side_m = geometry::bounds(mesh).size().maxCoeff();
    const std::optional<double> estimate = estimate_most_motion_sq(mesh, cameras);
    if (estimate && *estimate > 0.0) {
        const int bits = position_bits_of(side_m, *estimate * (1.0 - kEstimateError));
        if (bits == position_bits_of(side_m, *estimate * (1.0 + kEstimateError))) return bits;
    }
    double most_sq = 0.0;
    for (const geometry::CalibratedCamera& camera : cameras)
        most_sq = std::max(most_sq, most_motion_sq(mesh, camera));
    return most_sq == 0.0 ? kUnseenBits : position_bits_of(side_m, most_sq);
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
    if (const auto fault = find_fault(mesh)) return invalid_mesh(*fault);
    draco::EncoderBuffer& buffer = state_->buffer;
    try {
        buffer.Clear();
        if (!EdgebreakerWriter::takes_speed(options.speed) ||
            !state_->writer.write(mesh, options.position_bits, options.speed, buffer)) {
            const draco::Status status = encode_with_draco(mesh, options, buffer);
            if (!status.ok()) return invalid_mesh(status.error_msg_string());
        }
        // sizes vary a little: reserve more to avoid repeated allocation
        if (out.capacity() < buffer.size()) out.reserve(std::bit_ceil(buffer.size()));
        out.assign(buffer.data(), buffer.data() + buffer.size());
        return out.size();
    } catch (const std::exception& error) {
        buffer = {};  // its state is undefined
        return make_error(ErrorKind::kInternal, fmt::format("mesh encoder: {}", error.what()));
    }
}

struct MeshDecoder::State {
    EdgebreakerReader reader;
    TriangleMesh part;
};

MeshDecoder::MeshDecoder() : state_(std::make_unique<State>()) {}
MeshDecoder::~MeshDecoder() = default;
MeshDecoder::MeshDecoder(MeshDecoder&&) noexcept = default;
MeshDecoder& MeshDecoder::operator=(MeshDecoder&&) noexcept = default;

Expected<void> MeshDecoder::decode(std::span<const std::uint8_t> bytes,
                                   const MeshLimits& limits,
                                   TriangleMesh& out) {
    if (bytes.empty()) {
        out.clear();
        return {};
    }
    try {
        if (state_->reader.read(bytes, limits, out)) return {};
        return read_with_draco(bytes, limits, out);
    } catch (const std::exception& error) {
        return invalid_mesh(error.what());
    }
}

Expected<void> MeshDecoder::decode(std::span<const std::uint8_t> bytes,
                                   std::span<const std::uint32_t> sizes,
                                   const MeshLimits& limits,
                                   TriangleMesh& out) {
    if (sizes.empty()) return decode(bytes, limits, out);
    out.clear();
    MeshLimits left = limits;
    for (const std::uint32_t size : sizes) {
        if (size > bytes.size()) return invalid_mesh("shorter than the sizes of its parts say");
        if (auto read = decode(bytes.first(size), left, state_->part); !read) return read;
        bytes = bytes.subspan(size);
        geometry::append(out, state_->part);
        left.max_vertices = limits.max_vertices - static_cast<std::uint32_t>(out.vertices.size());
        left.max_triangles =
            limits.max_triangles - static_cast<std::uint32_t>(out.triangles.size());
    }
    if (!bytes.empty()) return invalid_mesh("longer than the sizes of its parts say");
    return {};
}

}  // namespace atrium::codec
