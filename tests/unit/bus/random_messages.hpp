#pragma once

#include "core/bus/wire.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Random valid messages, and their comparison, by the lists of core/bus/fields.hpp.
namespace atrium::bus::testing {

using Random = std::mt19937_64;

/// Sets each field to a value within its limits. Only rules on several fields may be broken.
class RandomFiller : public FieldVisitor<RandomFiller> {
public:
    explicit RandomFiller(Random& random) : random_(random) {}

    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view /*name*/, Member& member, const Wire&, const Limits& limits) {
        if constexpr (kIsVector<Member>)
            fill_elements<ElementOf<Wire>>(member, limits);
        else
            fill(member, limits);
    }

private:
    std::uint64_t below(std::uint64_t end) { return random_() % end; }
    double number(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }

    template <std::integral T>
    void fill(T& value, Unlimited) {
        value = static_cast<T>(random_());
    }
    void fill(bool& value, Unlimited) { value = below(2) == 0; }
    template <std::integral T, std::size_t N>
    void fill(std::array<T, N>& values, Unlimited none) {
        for (T& value : values) fill(value, none);
    }
    template <std::integral T>
    void fill(T& value, Range range) {
        const auto count = static_cast<std::uint64_t>(std::max(1.0, range.high - range.low + 1.0));
        value = static_cast<T>(range.low + static_cast<double>(below(count)));
    }
    template <std::integral T>
    void fill(T& value, AtMost limit) {
        value = static_cast<T>(below(limit.max + 1));
    }
    template <typename Enumerator>
    void fill(Enumerator& value, Last<Enumerator> limit) {
        value = static_cast<Enumerator>(below(static_cast<std::uint64_t>(limit.last) + 1));
    }
    void fill(double& value, Range range) { value = number(range.low, range.high); }
    void fill(double& value, Positive limit) { value = limit.high * number(1e-6, 1.0); }
    void fill(double& value, const RangeOrNone& limits) {
        value = below(4) == 0 ? limits.none : number(limits.range.low, limits.range.high);
    }
    template <std::size_t N>
    void fill(std::array<double, N>& values, Range range) {
        for (double& value : values) fill(value, range);
    }
    void fill(Eigen::Vector3d& vector, Range range) {
        for (double& value : vector) fill(value, range);
    }
    void fill(Eigen::Vector3d& size, Sizes) {
        for (double& value : size) fill(value, Positive{kMaxCoordinate_m});
    }
    void fill(Timestamp& time, Unlimited) { time.ns = static_cast<std::int64_t>(random_() >> 2U); }
    void fill(std::chrono::nanoseconds& time, Unlimited) {
        time = std::chrono::nanoseconds(random_() >> 2U);
    }
    void fill(LatencySummary& latency, Unlimited none) {
        fill(latency.median_ms, within(kMaxStatistic));
        fill(latency.p99_ms, within(kMaxStatistic));
        fill(latency.num_samples, none);
    }
    void fill(geometry::RigidTransform& pose, Unlimited) {
        fill(pose.translation, within(kMaxCoordinate_m));
        const double w = number(0.1, 1.0);
        const Range any = within(1.0);
        fill(pose.rotation.x(), any);
        fill(pose.rotation.y(), any);
        fill(pose.rotation.z(), any);
        pose.rotation.w() = w;
        pose.rotation.normalize();
    }
    void fill(std::string& text, Text kind) {
        constexpr std::string_view kLetters =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
        text.clear();
        const bool may_be_empty = kind == Text::kNameOrNone || kind == Text::kModelFileOrNone;
        if (may_be_empty && below(2) == 0) return;
        if (kind == Text::kLine) {
            text.resize(below(kMaxTextLength + 1));
            for (char& c : text) c = static_cast<char>(' ' + below('~' - ' ' + 1));
            return;
        }
        text.resize(1 + below(kMaxNameLength));
        for (char& c : text) c = kLetters[below(kLetters.size())];
        if (kind == Text::kName || kind == Text::kNameOrNone) return;
        if (text[0] == '.') text[0] = '_';  // no part of a model's file begins with a dot
        text.insert(0, "models/");
    }

    template <typename Wire, typename Element>
    void fill_elements(std::vector<Element>& elements, AtMost limit) {
        const std::size_t most = std::is_same_v<Element, std::uint8_t> ? 5000 : 600;
        elements.resize(below(std::min(limit.max, most) + 1));
        for (Element& element : elements) {
            if constexpr (std::is_integral_v<Element> || kGroupSize < Element >> 0)
                fill(element, Unlimited{});
            else
                fields(*this, element, kNoWire<Wire>);
        }
    }
    template <typename Wire, std::size_t N>
    void fill_elements(std::vector<std::array<std::uint16_t, N>>& groups, const Indices& limits) {
        groups.resize(limits.end == 0 ? 0 : below(std::min<std::size_t>(limits.max, 2000)));
        for (auto& group : groups)
            for (auto& index : group) index = static_cast<std::uint16_t>(below(limits.end));
    }
    template <typename Wire, typename Element>
    void fill_elements(std::vector<Element>& elements, EachOrNone limit) {
        elements.resize(below(2) == 0 ? 0 : limit.max);
        for (Element& element : elements) fields(*this, element, kNoWire<Wire>);
    }
    template <typename Wire>
    void fill_elements(std::vector<std::uint32_t>& sizes, ContourSizes limit) {
        sizes.resize(
            limit.counts == nullptr
                ? below(std::min<std::size_t>(limit.max, 8))
                : std::accumulate(limit.counts->begin(), limit.counts->end(), std::size_t{0}));
        for (std::uint32_t& size : sizes) size = static_cast<std::uint32_t>(below(40));
    }
    template <typename Wire>
    void fill_elements(std::vector<std::uint32_t>& counts, ContourCounts limit) {
        counts.resize(limit.num);
        for (std::uint32_t& count : counts) count = static_cast<std::uint32_t>(below(4));
    }
    template <typename Wire>
    void fill_elements(std::vector<std::uint32_t>& sizes, PartSizes limit) {
        sizes.assign(below(3), 0);
        for (std::size_t left = limit.total, i = 0; i < sizes.size(); ++i) {
            sizes[i] = static_cast<std::uint32_t>(i + 1 < sizes.size() ? below(left + 1) : left);
            left -= sizes[i];
        }
    }
    template <typename Wire>
    void fill_elements(std::vector<RegionHull>& regions, MeshesOf limit) {
        std::vector<std::uint32_t> sizes;
        fill_elements<Wire>(sizes, PartSizes{limit.max, limit.total});
        if (sizes.empty()) sizes.push_back(static_cast<std::uint32_t>(limit.total));
        for (const std::uint32_t size : sizes)
            regions.push_back({static_cast<std::uint32_t>(regions.size()),
                               size > 0 ? RegionOutcome::kMesh : RegionOutcome::kNobody,
                               size});
    }
    template <typename Wire>
    void fill_elements(std::vector<std::array<double, 2>>& vertices, const Vertices& limits) {
        vertices.resize(std::accumulate(limits.sizes.begin(), limits.sizes.end(), std::size_t{0}));
        for (auto& vertex : vertices) fill(vertex, within(kMaxVertex_px));
    }
    template <typename Wire>
    void fill_elements(std::vector<std::uint32_t>& cameras, CameraSet set) {
        cameras.clear();
        const std::uint64_t chosen = random_();
        for (std::uint32_t camera = 0; camera < set.max; ++camera)
            if ((chosen >> camera & 1U) != 0) cameras.push_back(camera);
    }

    Random& random_;
};

template <typename Message>
Message random_message(Random& random) {
    while (true) {
        Message message;
        RandomFiller filler(random);
        fields(filler, message, kNoWire<WireOf<Message>>);
        if (check(message)) return message;
    }
}

/// The bytes of all fields, without padding.
class Content : public FieldVisitor<Content> {
public:
    static constexpr bool kWithUnused = true;

    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view /*name*/, const Member& member, const Wire&, const Limits&) {
        if constexpr (std::is_same_v<Member, std::string>) {
            add(member);
        } else if constexpr (std::is_same_v<Member, geometry::RigidTransform>) {
            add(member.rotation.coeffs());
            add(member.translation);
        } else if constexpr (kIsVector<Member>) {
            using Element = typename Member::value_type;
            append(member.size());
            if constexpr (std::is_integral_v<Element> || kGroupSize < Element >> 0) {
                for (const Element& element : member) append(element);
            } else {
                for (const Element& element : member)
                    fields(*this, element, kNoWire<ElementOf<Wire>>);
            }
        } else {
            static_assert(std::has_unique_object_representations_v<Member> ||
                          sizeof(Member) % sizeof(double) == 0);
            append(member);
        }
    }

    std::string bytes;

private:
    template <typename Value>
    void append(const Value& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    }
    void add(const std::string& text) {
        append(text.size());
        bytes += text;
    }
    template <int kRows>
    void add(const Eigen::Matrix<double, kRows, 1>& vector) {
        for (const double value : vector) append(value);
    }
};

template <typename Message>
bool same(const Message& a, const Message& b) {
    Content of_a;
    Content of_b;
    fields(of_a, a, kNoWire<WireOf<Message>>);
    fields(of_b, b, kNoWire<WireOf<Message>>);
    return of_a.bytes == of_b.bytes;
}

}  // namespace atrium::bus::testing
