#pragma once

#include "core/bus/wire.hpp"
#include "tests/fuzz/byte_reader.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <type_traits>
#include <vector>

namespace atrium::test {

/// Stands for the message when only the wire struct is visited.
template <typename Message>
inline const Message kNoMessage{};

/// Fills the fields of wire structs from a fuzzer's bytes: valid values for zeros, and any value of
/// the type otherwise. Owns the memory of their sequences.
class WireFiller : public bus::FieldVisitor<WireFiller> {
public:
    static constexpr bool kWithUnused = true;

    explicit WireFiller(ByteReader& reader) : reader_(reader) {}

    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view /*name*/, const Member&, Wire& wire, const Limits& limits) {
        if constexpr (bus::kIsVector<Member>)
            fill_sequence<typename Member::value_type>(wire);
        else if constexpr (std::is_same_v<Limits, bus::Text>)
            fill_text(wire, limits);
        else
            fill(wire);
    }

private:
    void fill(double& value);
    void fill_text(atrium_Name& name, bus::Text kind);
    void fill_text(atrium_ModelFile& file, bus::Text kind);
    void fill_text(char (&line)[bus::kMaxTextLength + 1], bus::Text kind);
    void fill(atrium_Pose& pose);
    void fill(atrium_Latency& latency);
    void fill(std::uint8_t& value) { value = reader_.byte() ^ 1U; }
    void fill(bool& value) { value = reader_.below(2) == 1; }
    void fill(std::uint16_t& value) { value = static_cast<std::uint16_t>(reader_.below(4)); }
    void fill(std::int16_t& value) { value = static_cast<std::int16_t>(integer()); }
    void fill(std::uint32_t& value) { value = static_cast<std::uint32_t>(integer()); }
    void fill(std::uint64_t& value) { value = integer(); }
    void fill(std::int64_t& value) { value = static_cast<std::int64_t>(integer()); }

    template <typename Number, std::size_t kSize>
    void fill(Number (&values)[kSize]) {
        for (Number& value : values) fill(value);
    }

    template <typename Member, typename Sequence>
    void fill_sequence(Sequence& sequence) {
        using Element = bus::ElementOf<Sequence>;
        const std::size_t length = count();
        const auto elements = std::make_shared<std::vector<Element>>(length);
        for (Element& element : *elements) {
            if constexpr (std::is_class_v<Element>)
                fields(*this, kNoMessage<Member>, element);
            else
                fill(element);
        }
        owned_.push_back(elements);
        sequence._buffer = elements->data();
        sequence._maximum = sequence._length = static_cast<std::uint32_t>(length);
        // more elements than the reader may look at, without real memory behind them
        if (length == 5) sequence._maximum = sequence._length = ~std::uint32_t{reader_.byte()};
    }

    std::uint64_t integer();
    std::size_t count();

    ByteReader& reader_;
    std::vector<std::shared_ptr<void>> owned_;
};

}  // namespace atrium::test
