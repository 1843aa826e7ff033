#pragma once

#include "core/bus/checks.hpp"
#include "core/bus/wire.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Converts the fields that several messages share. Private to the wire_*.cpp files.
namespace atrium::bus {

// Payload sizes: a pose has a quaternion and a translation.
inline constexpr std::size_t kPoseBytes = 7 * sizeof(double);
inline constexpr std::size_t kVectorBytes = 3 * sizeof(double);
inline constexpr std::size_t kLatencyBytes = 3 * sizeof(double);

inline void put_name(std::string_view name, atrium_Name& out) {
    const std::size_t size = std::min(name.size(), sizeof(out) - 1);
    std::memcpy(out, name.data(), size);
    out[size] = '\0';
}

inline std::string get_name(const atrium_Name& name) { return {name, strnlen(name, sizeof(name))}; }

inline void put_model_file(std::string_view file, atrium_ModelFile& out) {
    const std::size_t size = std::min(file.size(), sizeof(out) - 1);
    std::memcpy(out, file.data(), size);
    out[size] = '\0';
}

inline std::string get_model_file(const atrium_ModelFile& file) {
    return {file, strnlen(file, sizeof(file))};
}

inline void put_vector(const Eigen::Vector3d& vector, double (&out)[3]) {
    std::copy_n(vector.data(), 3, out);
}

inline Eigen::Vector3d get_vector(const double (&vector)[3]) {
    return {vector[0], vector[1], vector[2]};
}

inline void put_pose(const geometry::RigidTransform& pose, atrium_Pose& out) {
    std::copy_n(pose.rotation.coeffs().data(), 4, out.rotation);  // x, y, z, w
    put_vector(pose.translation, out.translation);
}

/// Copies the quaternion as sent. Call `normalise_rotation` after the check to normalise it.
inline geometry::RigidTransform get_pose(const atrium_Pose& pose) {
    const auto& [x, y, z, w] = pose.rotation;
    return {Eigen::Quaterniond(w, x, y, z), get_vector(pose.translation)};
}

/// Normalises the rotation, unless its length is 1 up to rounding: a message of ours thus arrives
/// bit for bit.
inline void normalise_rotation(geometry::RigidTransform& pose) {
    constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
    if (std::abs(pose.rotation.squaredNorm() - 1.0) > kRounding) pose.rotation.normalize();
}

inline atrium_Latency put_latency(const LatencySummary& latency) {
    return {latency.median_ms, latency.p99_ms, latency.num_samples};
}

inline LatencySummary get_latency(const atrium_Latency& latency) {
    return {latency.median_ms, latency.p99_ms, latency.num_samples};
}

/// Points a wire sequence at a vector's elements. The sequence only reads them.
template <typename Sequence, typename Element>
void lend(const std::vector<Element>& elements, Sequence& out) {
    out._maximum = out._length = static_cast<std::uint32_t>(elements.size());
    out._buffer = const_cast<Element*>(elements.data());
    out._release = false;
}

template <typename Sequence>
auto elements_of(const Sequence& sequence) {
    return std::span(sequence._buffer, sequence._length);
}

inline tl::unexpected<Error> too_many(std::string_view field) {
    return make_error(ErrorKind::kInvalidData, std::string(field) + ": too many elements");
}

/// Like `lend`, for elements of N numbers that become one sequence of numbers.
template <typename Sequence, std::size_t N>
void lend_groups(const std::vector<std::array<std::uint16_t, N>>& groups, Sequence& out) {
    static_assert(sizeof(std::array<std::uint16_t, N>) == N * sizeof(std::uint16_t));
    out._maximum = out._length = static_cast<std::uint32_t>(N * groups.size());
    out._buffer = groups.empty() ? nullptr : const_cast<std::uint16_t*>(groups.front().data());
    out._release = false;
}

/// Splits a sequence of numbers into elements of N. Fails with kInvalidData if there are more than
/// `max` elements or the last one is incomplete.
template <std::size_t N, typename Sequence>
Expected<std::vector<std::array<std::uint16_t, N>>> groups_of(const Sequence& sequence,
                                                              std::size_t max,
                                                              std::string_view field) {
    if (sequence._length > N * max) return too_many(field);
    if (sequence._length % N != 0) {
        return make_error(ErrorKind::kInvalidData,
                          std::string(field) + ": its last element is incomplete");
    }
    std::vector<std::array<std::uint16_t, N>> groups(sequence._length / N);
    for (std::size_t i = 0; i < sequence._length; ++i) {
        groups[i / N][i % N] = sequence._buffer[i];
    }
    return groups;
}

/// Returns the message if it passes `check`: the last step of each `from_wire`.
template <typename Message>
Expected<Message> checked(Message&& message) {
    if (auto result = check(message); !result) return tl::unexpected(std::move(result.error()));
    return std::forward<Message>(message);
}

/// Returns the message if its key is a valid name: the last step of most `key_from_wire`.
template <typename Message>
Expected<Message> with_checked_name(Message&& message, const std::string& name) {
    if (!is_valid_name(name)) return make_error(ErrorKind::kInvalidData, "key: invalid name");
    return std::forward<Message>(message);
}

}  // namespace atrium::bus
