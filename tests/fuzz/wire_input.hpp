#pragma once

#include "tests/fuzz/byte_reader.hpp"
#include "tests/fuzz/wire_parts.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

namespace atrium::test {

/// Fills the fields of wire structs from a fuzzer's bytes: valid values for zeros, and any value of
/// the type otherwise. Owns the memory of their sequences.
class WireFiller {
public:
    static constexpr bool kWithIgnored = true;

    explicit WireFiller(ByteReader& reader) : reader_(reader) {}

    template <typename... Parts>
    void operator()(Parts&... parts) {
        (fill(parts), ...);
    }

private:
    void fill(double& value);
    void fill(atrium_Name& name);
    void fill(OptionalName& optional);
    void fill(atrium_ModelFile& file);
    void fill(atrium_Pose& pose);
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

    template <typename Wire>
    void fill(Wire& wire) {
        if constexpr (requires { wire._buffer; }) {
            fill_sequence(wire);
        } else {
            visit_parts(wire, *this);
        }
    }

    template <typename Sequence>
    void fill_sequence(Sequence& sequence) {
        using Element = std::remove_pointer_t<decltype(sequence._buffer)>;
        const std::size_t length = count();
        const auto elements = std::make_shared<std::vector<Element>>(length);
        for (Element& element : *elements) fill(element);
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
