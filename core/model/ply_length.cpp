#include "core/model/ply_length.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

namespace atrium::model {
namespace {

constexpr std::size_t kMostHeaderBytes = 65536;

struct Property {
    std::size_t num_bytes = 0;        // of a value
    std::size_t num_count_bytes = 0;  // of a list's length; 0: no list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    std::string format;
    std::vector<Element> elements;
    bool is_known = true;  // whether every line was understood
};

// 0: no type of the format.
std::size_t bytes_of(std::string_view type) {
    if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
    if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
    if (type == "int" || type == "uint" || type == "int32" || type == "uint32") return 4;
    if (type == "float" || type == "float32") return 4;
    if (type == "double" || type == "float64") return 8;
    return 0;
}

bool read_property(std::istringstream& words, Header& header) {
    std::string type;
    words >> type;
    Property property;
    if (type == "list") {
        std::string count;
        words >> count >> type;
        property.num_count_bytes = bytes_of(count);
        if (property.num_count_bytes == 0) return false;
    }
    property.num_bytes = bytes_of(type);
    if (property.num_bytes == 0 || header.elements.empty()) return false;
    header.elements.back().properties.push_back(property);
    return true;
}

Header read_header(std::string text) {
    Header header;
    std::replace(text.begin(), text.end(), '\r', '\n');
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "format") {
            words >> header.format;
        } else if (word == "element") {
            Element element;
            if (!(words >> element.name >> element.count)) header.is_known = false;
            header.elements.push_back(std::move(element));
        } else if (word == "property") {
            if (!read_property(words, header)) header.is_known = false;
        }
    }
    return header;
}

std::string cut_off(const Element& element, std::uint64_t num_there) {
    return fmt::format("is cut off: has {} of {} entries of '{}'; copy it again",
                       num_there,
                       element.count,
                       element.name);
}

// A line for each entry.
std::string what_text_lacks(const Header& header, std::string_view data) {
    std::size_t at = 0;
    const auto skip_line = [&] {
        while (at < data.size() && (data[at] == '\n' || data[at] == '\r' || data[at] == ' ')) ++at;
        if (at >= data.size()) return false;
        at = std::min(data.find_first_of("\r\n", at), data.size());
        return true;
    };
    for (const Element& element : header.elements) {
        for (std::uint64_t i = 0; i < element.count; ++i)
            if (!skip_line()) return cut_off(element, i);
    }
    return {};
}

// Bytes of the entry at `at`; none: it does not end within `data`.
std::optional<std::size_t> bytes_of_entry(const Element& element,
                                          bool is_big_endian,
                                          std::string_view data,
                                          std::size_t at) {
    const std::size_t begin = at;
    for (const Property& property : element.properties) {
        std::uint64_t num_values = 1;
        if (property.num_count_bytes > 0) {
            if (data.size() - at < property.num_count_bytes) return std::nullopt;
            num_values = 0;
            for (std::size_t i = 0; i < property.num_count_bytes; ++i) {
                const std::size_t from = is_big_endian ? i : property.num_count_bytes - 1 - i;
                num_values = num_values << 8U | static_cast<std::uint8_t>(data[at + from]);
            }
            at += property.num_count_bytes;
        }
        if ((data.size() - at) / property.num_bytes < num_values) return std::nullopt;
        at += num_values * property.num_bytes;
    }
    return at - begin;
}

std::string what_binary_lacks(const Header& header, std::string_view data) {
    const bool is_big_endian = header.format == "binary_big_endian";
    std::size_t at = 0;
    for (const Element& element : header.elements) {
        if (element.properties.empty()) continue;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const auto num_bytes = bytes_of_entry(element, is_big_endian, data, at);
            if (!num_bytes) return cut_off(element, i);
            at += *num_bytes;
        }
    }
    return {};
}

}  // namespace

std::string what_ply_lacks(const std::filesystem::path& file) {
    constexpr std::string_view kEnd = "end_header";
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    const std::string_view all = bytes;
    const std::size_t end = all.substr(0, kMostHeaderBytes).find(kEnd);
    std::size_t data = end + kEnd.size();
    if (end == std::string_view::npos || data >= all.size() ||
        (all[data] != '\n' && all[data] != '\r'))
        return "is cut off, or no .ply file: its header does not end; copy it again";
    const Header header = read_header(bytes.substr(0, end));
    if (!header.is_known) return {};  // for Assimp to judge
    data += all.substr(data).starts_with("\r\n") ? 2 : 1;
    if (header.format == "ascii") return what_text_lacks(header, all.substr(data));
    if (header.format.starts_with("binary_")) return what_binary_lacks(header, all.substr(data));
    return {};
}

}  // namespace atrium::model
