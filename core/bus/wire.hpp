#pragma once

#include "core/base/expected.hpp"
#include "core/bus/checks.hpp"
#include "core/bus/fields.hpp"
#include "core/bus/names.hpp"
#include "core/bus/topics.hpp"
#include "core/bus/wire_values.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Converts messages to and from the structs that idlc generates from idl/, by the lists of
/// fields.hpp. Private to core/bus and its tests.
namespace atrium::bus {

template <typename Message>
using WireOf = typename Topic<Message>::Wire;

/// Memory for the elements of wire sequences.
using WireScratch = std::tuple<std::vector<atrium_Camera>,
                               std::vector<atrium_ObjectState>,
                               std::vector<atrium_CameraStatus>,
                               std::vector<atrium_CameraCoherence>,
                               std::vector<atrium_FrameKey>,
                               std::vector<atrium_HostStatus>,
                               std::vector<atrium_RegionHull>,
                               std::vector<atrium_SavedWorld>,
                               std::vector<atrium_ProxyPoint>,
                               std::vector<atrium_Touch>>;

/// Stands for the wire struct when only the message is visited.
template <typename Wire>
inline const Wire kNoWire{};

class WireWriter : public FieldVisitor<WireWriter> {
public:
    static constexpr bool kWithUnused = true;

    explicit WireWriter(WireScratch& scratch) : scratch_(scratch) {}

    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view /*name*/, const Member& member, Wire& wire, const Limits&) {
        if constexpr (!kIsVector<Member>) {
            put(member, wire);
        } else if constexpr (std::is_same_v<typename Member::value_type, ElementOf<Wire>>) {
            lend(member.data(), member.size(), wire);
        } else if constexpr (kGroupSize<typename Member::value_type> > 0) {
            using Group = typename Member::value_type;
            static_assert(sizeof(Group) == kGroupSize<Group> * sizeof(ElementOf<Wire>));
            lend(member.empty() ? nullptr : member.front().data(),
                 kGroupSize<Group> * member.size(),
                 wire);
        } else {
            auto& elements = std::get<std::vector<ElementOf<Wire>>>(scratch_);
            elements.resize(member.size());
            for (std::size_t i = 0; i < member.size(); ++i) fields(*this, member[i], elements[i]);
            lend(elements.data(), elements.size(), wire);
        }
    }

private:
    WireScratch& scratch_;
};

/// Copies all fields before their limits are checked, but no sequence with too many elements.
class WireReader : public FieldVisitor<WireReader> {
public:
    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view name, Member& member, const Wire& wire, const Limits& limits) {
        if constexpr (kIsVector<Member>) {
            read_sequence(name, member, wire, limits.max);
        } else {
            if constexpr (std::is_same_v<Member, bool> && !std::is_same_v<Wire, bool>) {
                if (wire > 1) fail(name, "must be 0 or 1");
            }
            get(wire, member);
        }
    }
    const std::string& fault() const { return fault_; }

private:
    template <typename Element, typename Sequence>
    void read_sequence(std::string_view name,
                       std::vector<Element>& out,
                       const Sequence& wire,
                       std::size_t max) {
        constexpr std::size_t kGroup = kGroupSize<Element>;
        constexpr std::size_t kPerElement = kGroup > 0 ? kGroup : 1;
        if (wire._length > kPerElement * max) return fail(name, "too many elements");
        if (wire._length % kPerElement != 0) return fail(name, "its last element is incomplete");
        if constexpr (std::is_same_v<Element, ElementOf<Sequence>>) {
            out.assign(wire._buffer, wire._buffer + wire._length);
        } else {
            out.resize(wire._length / kPerElement);
            for (std::size_t i = 0; i < out.size(); ++i) {
                if constexpr (kGroup > 0)
                    std::copy_n(wire._buffer + kGroup * i, kGroup, out[i].data());
                else
                    fields(*this, out[i], wire._buffer[i]);
            }
        }
    }
    void fail(std::string_view name, std::string_view why) {
        if (fault_.empty()) fault_.append(name).append(": ").append(why);
    }

    std::string fault_;
};

class KeyWriter : public FieldVisitor<KeyWriter> {
public:
    void field(auto&&...) {}
    void part(auto&&...) {}
    void key(std::string_view /*name*/, const auto& member, auto& wire, const auto&... /*limits*/) {
        put(member, wire);
    }
};

class KeyReader : public FieldVisitor<KeyReader> {
public:
    void field(auto&&...) {}
    void part(auto&&...) {}
    void key(std::string_view /*name*/, auto& member, const auto& wire) { get(wire, member); }
    void key(std::string_view /*name*/, std::string& member, const auto& wire, Text /*kind*/) {
        get(wire, member);
        if (!is_valid_name(member)) fault_ = "key: invalid name";
    }
    void key(std::string_view /*name*/, std::uint32_t& camera, const auto& wire, Range range) {
        get(wire, camera);
        if (camera > range.high) fault_ = "key: camera index out of range";
    }
    template <typename Kind>
    void key(std::string_view /*name*/, Kind& member, const auto& wire, Last<Kind> limit) {
        get(wire, member);
        if (member > limit.last) fault_ = "key: unknown program kind";
    }
    const std::string& fault() const { return fault_; }

private:
    std::string fault_;
};

class PayloadCounter : public FieldVisitor<PayloadCounter> {
public:
    static constexpr bool kWithUnused = true;

    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view /*name*/, const Member& member, const Wire&, const Limits&) {
        if constexpr (std::is_same_v<Member, std::string>) {
            bytes += member.size();
        } else if constexpr (!kIsVector<Member>) {
            bytes += sizeof(Wire);
        } else if constexpr (std::is_same_v<typename Member::value_type, ElementOf<Wire>> ||
                             (kGroupSize<typename Member::value_type> > 0)) {
            bytes += member.size() * sizeof(typename Member::value_type);
        } else {
            for (const auto& element : member) fields(*this, element, kNoWire<ElementOf<Wire>>);
        }
    }

    std::size_t bytes = 0;
};

/// Points the sequences of `out` into the message and into `scratch`, which must outlive `out`.
template <typename Message>
void to_wire(const Message& message, WireScratch& scratch, WireOf<Message>& out) {
    WireWriter writer(scratch);
    fields(writer, message, out);
}

/// Copies. Safe for untrusted input: the result has passed `check`, and quaternions within the
/// tolerance are normalised.
template <typename Message>
Expected<Message> from_wire(const WireOf<Message>& wire) {
    Expected<Message> message;
    WireReader reader;
    fields(reader, *message, wire);
    if (!reader.fault().empty()) return make_error(ErrorKind::kInvalidData, reader.fault());
    if (auto result = check(*message); !result) return tl::unexpected(std::move(result.error()));
    return message;
}

/// Converts only the key fields.
template <typename Message>
void key_to_wire(const Message& message, WireOf<Message>& out) {
    KeyWriter writer;
    fields(writer, message, out);
}

template <typename Message>
Expected<Message> key_from_wire(const WireOf<Message>& wire) {
    Expected<Message> key;
    KeyReader reader;
    fields(reader, *key, wire);
    if (!reader.fault().empty()) return make_error(ErrorKind::kInvalidData, reader.fault());
    return key;
}

/// Counts names, numbers and coded bytes, without the padding and headers of the protocol.
template <typename Message>
std::size_t payload_bytes(const Message& message) {
    PayloadCounter counter;
    fields(counter, message, kNoWire<WireOf<Message>>);
    return counter.bytes;
}

}  // namespace atrium::bus
