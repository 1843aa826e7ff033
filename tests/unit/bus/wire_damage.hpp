#pragma once

#include "core/bus/wire.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Visitors of the lists of core/bus/fields.hpp that test the lists.
namespace atrium::bus::testing {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <std::size_t N>
void spoil_text(char (&text)[N], std::string_view value) {
    text[value.copy(text, N - 1)] = '\0';
}

/// Moves one field of a wire struct out of its limits. `which` numbers all the ways to do so with
/// all fields, from 0.
class WireDamage : public FieldVisitor<WireDamage> {
public:
    explicit WireDamage(int which) : which_(which) {}

    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view field, const Member& member, Wire& wire, const Limits& limits) {
        field_ = field;
        if constexpr (kIsVector<Member>)
            damage_sequence(member, wire, limits);
        else if constexpr (std::is_same_v<Member, bool> && !std::is_same_v<Wire, bool>)
            set_each(wire, {2, 255});
        else
            damage(wire, limits);
    }

    std::string name;  // of the damaged field; empty: there are not so many ways

private:
    template <typename Change>
    void may(Change change) {
        if (which_-- != 0) return;
        change();
        name = field_;
    }
    template <typename T>
    void set_each(T& value, std::initializer_list<std::type_identity_t<T>> bad) {
        for (const T replacement : bad) may([&] { value = replacement; });
    }

    template <std::integral T>
    void damage(T&, Unlimited) {}
    template <std::integral T, std::size_t N>
    void damage(T (&)[N], Unlimited) {}
    template <std::integral T>
    void damage(T& value, Range range) {
        using Limit = std::numeric_limits<T>;
        if (range.low > Limit::min()) may([&] { value = static_cast<T>(range.low - 1.0); });
        if (range.high < Limit::max()) may([&] { value = static_cast<T>(range.high + 1.0); });
        set_each(value, {Limit::max()});
    }
    void damage(std::uint32_t& value, AtMost limit) {
        set_each(value, {static_cast<std::uint32_t>(limit.max) + 1, 0xffffffff});
    }
    template <typename Enumerator>
    void damage(std::uint8_t& value, Last<Enumerator> limit) {
        set_each<std::uint8_t>(value, {static_cast<std::uint8_t>(int(limit.last) + 1), 255});
    }
    void damage(double& value, Range range) {
        const double below = range.low - 0.01 * (1.0 + std::abs(range.low));
        const double above = range.high + 0.01 * (1.0 + std::abs(range.high));
        set_each(value, {below, above, kNan, kInfinity, -kInfinity});
    }
    void damage(double& value, const RangeOrNone& limits) {
        set_each(value, {-0.5});
        damage(value, Range{-1e300, limits.range.high});
    }
    void damage(double& value, Positive limit) {
        set_each(value, {0.0, -1.0, 1.01 * limit.high, kNan, kInfinity});
    }
    template <std::size_t N>
    void damage(double (&values)[N], Range range) {
        for (double& value : values) damage(value, range);
    }
    void damage(double (&size)[3], Sizes limit) {
        const bool is_model = limit.shape >= Shape::kConvex;
        for (double& value : size) set_each(value, {kNan, kInfinity, 1.01 * kMaxCoordinate_m});
        set_each(size[1], {is_model ? -1e-9 : 0.0});
    }
    void damage(std::int64_t& time_ns, Unlimited) {
        set_each(time_ns, {-1, kMaxTime_ns + 1, std::numeric_limits<std::int64_t>::max()});
    }
    void damage(atrium_Latency& latency, Unlimited) {
        damage(latency.median_ms, within(kMaxStatistic));
        damage(latency.p99_ms, within(kMaxStatistic));
    }
    void damage(atrium_Pose& pose, Unlimited) {
        damage(pose.translation, within(kMaxCoordinate_m));
        for (double& value : pose.rotation) set_each(value, {kNan, 1.1});
        may([&] { std::memset(pose.rotation, 0, sizeof(pose.rotation)); });
    }
    template <std::size_t N>
    void damage(char (&text)[N], Text kind) {
        if (kind == Text::kLine) {
            for (const char* bad : {"a\nb", "\x7f", "\xc3\xa4"})
                may([&] { spoil_text(text, bad); });
            may([&] { std::memset(text, 'a', N); });  // no terminator
            return;
        }
        const bool is_name = kind == Text::kName || kind == Text::kNameOrNone;
        if (kind == Text::kName || kind == Text::kModelFile) may([&] { spoil_text(text, ""); });
        for (const char* bad : {"a b", "a\nb", "\xff", "*", is_name ? "a/b" : "/a", "../a"})
            may([&] { spoil_text(text, bad); });
        may([&] { std::memset(text, 'a', N); });  // no terminator
    }

    template <typename Element, typename Sequence, typename Limits>
    void damage_sequence(const std::vector<Element>& elements,
                         Sequence& wire,
                         const Limits& limits) {
        constexpr std::size_t kGroup = kGroupSize < Element >> 0 ? kGroupSize<Element> : 1;
        const auto too_many = static_cast<std::uint32_t>(kGroup * (limits.max + 1));
        set_each(wire._length, {too_many, 0xffffffff / kGroup * kGroup});
        if (kGroup > 1) set_each(wire._length, {1});
        if (elements.empty()) return;
        auto& last = wire._buffer[wire._length - 1];
        if constexpr (std::is_class_v<ElementOf<Sequence>>) {
            fields(*this, elements.back(), last);
        } else if constexpr (std::is_same_v<Limits, Indices>) {
            if (limits.end < 65536) set_each(last, {static_cast<std::uint16_t>(limits.end)});
        } else if constexpr (std::is_same_v<Limits, CameraSet>) {
            set_each(last, {kMaxCamerasPerSite, 0xffffffff});
            if (elements.size() > 1) set_each(last, {elements.front()});
        } else if constexpr (std::is_same_v<Limits, Vertices>) {
            set_each(last, {kNan, kInfinity, 1.01 * kMaxVertex_px});
            may([&] { wire._length -= 2; });
        }
    }

    int which_;
    std::string_view field_;
};

/// The places in memory of the fields of a message and its wire struct.
class Layout : public FieldVisitor<Layout> {
public:
    static constexpr bool kWithUnused = true;

    struct Piece {
        std::string name;
        std::uintptr_t begin = 0;
        std::size_t size = 0;
        std::size_t alignment = 0;
    };
    /// A struct and its pieces, which are structs or fields.
    struct Struct {
        Piece whole;
        std::vector<Piece> pieces;
    };

    template <typename Member, typename Wire>
    void visit(const Member& member, const Wire& wire) {
        Layout inside;
        fields(inside, member, wire);
        if constexpr (requires { member.proven_rights; })  // the reader enters it
            inside.members_.push_back(piece("proven_rights", member.proven_rights));
        structs.push_back({piece("", member), std::move(inside.members_)});
        structs.push_back({piece("", wire), std::move(inside.wires_)});
        structs.insert(structs.end(), inside.structs.begin(), inside.structs.end());
    }
    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view name, const Member& member, const Wire& wire, const Limits&) {
        members_.push_back(piece(name, member));
        wires_.push_back(piece(name, wire));
        if constexpr (kIsVector<Member>) {
            if constexpr (std::is_class_v<ElementOf<Wire>>)
                visit(typename Member::value_type{}, kNoWire<ElementOf<Wire>>);
        }
    }
    template <typename Member, typename Wire>
    void part(const Member& member, const Wire& wire) {
        members_.push_back(piece("part", member));
        wires_.push_back(piece("part", wire));
        visit(member, wire);
    }

    std::vector<Struct> structs;

private:
    template <typename T>
    static Piece piece(std::string_view name, const T& at) {
        return {std::string(name), reinterpret_cast<std::uintptr_t>(&at), sizeof(T), alignof(T)};
    }

    std::vector<Piece> members_;
    std::vector<Piece> wires_;
};

/// A valid wire struct, a change to it, and the field that the refusal must name.
template <typename Message>
struct Damage {
    std::string names;
    std::function<void(WireOf<Message>&)> apply;
};

template <typename Message>
void expect_each_refused(const Message& good, const std::vector<Damage<Message>>& damages) {
    for (const auto& damage : damages) {
        WireScratch scratch;
        WireOf<Message> wire{};
        to_wire(good, scratch, wire);
        ASSERT_TRUE(from_wire<Message>(wire).has_value())
            << from_wire<Message>(wire).error().message;
        damage.apply(wire);
        const auto result = from_wire<Message>(wire);
        ASSERT_FALSE(result.has_value()) << damage.names;
        EXPECT_EQ(result.error().kind, ErrorKind::kInvalidData);
        EXPECT_THAT(result.error().message, ::testing::HasSubstr(damage.names));
    }
}

}  // namespace atrium::bus::testing
