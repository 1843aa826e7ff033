#pragma once

#include "core/bus/limits.hpp"
#include "core/bus/messages.hpp"

#include <common.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

/// Converts single values to (`put`) and from (`get`) their wire types. Private to core/bus.
namespace atrium::bus {

template <typename T>
concept Number = std::is_arithmetic_v<T>;
template <typename T>
concept Enumeration = std::is_enum_v<T>;

template <Number T>
void put(const T& value, T& out) {
    out = value;
}
template <Number T>
void get(const T& wire, T& out) {
    out = wire;
}

template <Enumeration T>
void put(const T& value, std::uint8_t& out) {
    out = static_cast<std::uint8_t>(value);
}
/// Any octet: `check` rejects unknown enumerators.
template <Enumeration T>
void get(const std::uint8_t& wire, T& out) {
    out = static_cast<T>(wire);
}

inline void put(const bool& value, std::uint8_t& out) { out = value ? 1 : 0; }
inline void get(const std::uint8_t& wire, bool& out) { out = wire != 0; }

// Numbers of pixels.
inline void put(const int& value, std::uint32_t& out) { out = static_cast<std::uint32_t>(value); }
/// Clamps to the range of int. `check` rejects such sizes anyway.
inline void get(const std::uint32_t& wire, int& out) {
    out = static_cast<int>(std::min<std::uint32_t>(wire, std::numeric_limits<int>::max()));
}

inline void put(const Timestamp& time, std::int64_t& out) { out = time.ns; }
inline void get(const std::int64_t& wire, Timestamp& out) { out.ns = wire; }

inline void put(const std::chrono::nanoseconds& duration, std::int64_t& out) {
    out = duration.count();
}
inline void get(const std::int64_t& wire, std::chrono::nanoseconds& out) {
    out = std::chrono::nanoseconds(wire);
}

template <std::size_t N>
void put(const std::string& text, char (&out)[N]) {
    const std::size_t size = std::min(text.size(), N - 1);
    std::memcpy(out, text.data(), size);
    out[size] = '\0';
}
template <std::size_t N>
void get(const char (&wire)[N], std::string& out) {
    out.assign(wire, strnlen(wire, N));
}

template <Number T, std::size_t N>
void put(const std::array<T, N>& values, T (&out)[N]) {
    std::copy_n(values.data(), N, out);
}
template <Number T, std::size_t N>
void get(const T (&wire)[N], std::array<T, N>& out) {
    std::copy_n(wire, N, out.data());
}

inline void put(const Eigen::Vector3d& vector, double (&out)[3]) {
    std::copy_n(vector.data(), 3, out);
}
inline void get(const double (&wire)[3], Eigen::Vector3d& out) { std::copy_n(wire, 3, out.data()); }

inline void put(const LatencySummary& latency, atrium_Latency& out) {
    out = {latency.median_ms, latency.p99_ms, latency.num_samples};
}
inline void get(const atrium_Latency& wire, LatencySummary& out) {
    out = {wire.median_ms, wire.p99_ms, wire.num_samples};
}

inline bool is_unit(const Eigen::Quaterniond& rotation) {
    return std::abs(rotation.norm() - 1.0) <= kQuaternionTolerance;  // false for NaN
}

inline void put(const geometry::RigidTransform& pose, atrium_Pose& out) {
    std::copy_n(pose.rotation.coeffs().data(), 4, out.rotation);  // x, y, z, w
    put(pose.translation, out.translation);
}
/// Normalises a rotation within the tolerance, unless its length is 1 up to rounding: our own
/// messages thus arrive bit for bit. `check` rejects the others.
inline void get(const atrium_Pose& wire, geometry::RigidTransform& out) {
    constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
    std::copy_n(wire.rotation, 4, out.rotation.coeffs().data());
    get(wire.translation, out.translation);
    if (is_unit(out.rotation) && std::abs(out.rotation.squaredNorm() - 1.0) > kRounding)
        out.rotation.normalize();
}

// Sequences. A vector's elements have the type of the wire elements, are groups of such numbers, or
// are structs with a list in fields.hpp.

template <typename T>
inline constexpr bool kIsVector = false;
template <typename Element>
inline constexpr bool kIsVector<std::vector<Element>> = true;
template <typename T>
inline constexpr std::size_t kGroupSize = 0;  // 0: not a group
template <typename Value, std::size_t N>
inline constexpr std::size_t kGroupSize<std::array<Value, N>> = N;

template <typename Sequence>
using ElementOf = std::remove_pointer_t<decltype(Sequence::_buffer)>;

/// Points a wire sequence at elements. The sequence only reads them.
template <typename Sequence>
void lend(const ElementOf<Sequence>* elements, std::size_t count, Sequence& out) {
    out._maximum = out._length = static_cast<std::uint32_t>(count);
    out._buffer = const_cast<ElementOf<Sequence>*>(elements);
    out._release = false;
}

}  // namespace atrium::bus
