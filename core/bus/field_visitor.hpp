#pragma once

#include "core/bus/limits.hpp"
#include "core/bus/messages.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <vector>

/// Defines the limits of fields, and the base of the visitors of the lists in fields.hpp. Private
/// to core/bus and its tests.
namespace atrium::bus {

template <typename T, typename Message>
concept Of = std::same_as<std::remove_const_t<T>, Message>;

// Limits of fields. Times, poses and latencies have their own and get none here. Every other
// floating-point field needs one: NaN and infinities are outside of all of them.

struct Unlimited {};
/// In [low, high]; each component of a vector.
struct Range {
    double low = 0.0;
    double high = 0.0;
};
constexpr Range within(double limit) { return {-limit, limit}; }
inline constexpr Range kStatistic{0.0, kMaxStatistic};
/// In the range, or the value that stands for none.
struct RangeOrNone {
    Range range;
    double none = 0.0;
};
/// In (0, high].
struct Positive {
    double high = 0.0;
};
/// A number or a count of elements.
struct AtMost {
    std::size_t max = 0;
};
/// At most `max` groups of indices below `end`.
struct Indices {
    std::size_t max = 0;
    std::size_t end = 0;
};
/// One element for each of `max` others, or none.
struct EachOrNone {
    std::size_t max = 0;
};
/// Numbers of vertices of contours; with `counts` as many as these say.
struct ContourSizes {
    std::size_t max = 0;
    const std::vector<std::uint32_t>* counts = nullptr;
};
/// Points of contours, as many as these sizes say.
struct Vertices {
    std::size_t max = 0;
    const std::vector<std::uint32_t>& sizes;
};
/// Sizes of consecutive parts of `total` bytes; none: it is one part.
struct PartSizes {
    std::size_t max = 0;
    std::size_t total = 0;
};
/// Outcomes of different regions, whose meshes have `total` bytes.
struct MeshesOf {
    std::size_t max = 0;
    std::size_t total = 0;
};
/// Numbers of contours, one for each of `num` cameras.
struct ContourCounts {
    std::size_t num = 0;
    std::size_t max = kMaxCamerasPerSite;
};
/// Indices of different cameras.
struct CameraSet {
    std::size_t max = kMaxCamerasPerSite;
};
/// Extents of a shape.
struct Sizes {
    Shape shape = Shape::kBox;
};
template <typename Enumerator>
struct Last {
    Enumerator last;
};
template <typename Enumerator>
Last(Enumerator) -> Last<Enumerator>;  // clang 14 does not deduce it
/// kLine: printable ASCII, may be empty.
enum class Text { kName, kNameOrNone, kModelFile, kModelFileOrNone, kLine };

/// Forwards the entries of a list to `field`. A visitor defines it as
/// `field(name, member, wire, limits)`, and hides what it treats in another way.
template <typename Visitor>
class FieldVisitor {
public:
    static constexpr bool kWithUnused = false;  // visits fields that readers ignore

    template <std::integral Integer, typename Wire>
    requires(!std::same_as<Integer, bool>) void operator()(Integer& member, Wire& wire) {
        self().field(std::string_view{}, member, wire, Unlimited{});
    }
    template <typename Member, typename Wire, typename Limits = Unlimited>
    void operator()(std::string_view name, Member& member, Wire& wire, const Limits& limits = {}) {
        self().field(name, member, wire, limits);
    }
    template <typename Member, typename Wire, typename Limits = Unlimited>
    void key(std::string_view name, Member& member, Wire& wire, const Limits& limits = {}) {
        self().field(name, member, wire, limits);
    }
    template <typename Member, typename Wire>
    void part(Member& member, Wire& wire) {
        fields(self(), member, wire);
    }
    void rule(std::string_view /*name*/, bool /*holds*/, std::string_view /*why*/) {}

private:
    Visitor& self() { return static_cast<Visitor&>(*this); }
};

}  // namespace atrium::bus
