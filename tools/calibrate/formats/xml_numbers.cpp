#include "tools/calibrate/formats/xml_numbers.hpp"

#include "tools/calibrate/formats/data_tree.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>

namespace atrium::calibrate {
namespace {

// Also nan and inf, and as Windows writes them: "-1.#IND".
bool is_some_number(std::string_view word) {
    if (word.find("1.#") != std::string_view::npos) return true;
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0.0;
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
    return failure != std::errc::invalid_argument && end == word.data() + word.size();
}

}  // namespace

Expected<void> load_xml(const std::filesystem::path& file, pugi::xml_document& document) {
    const auto text = read_bytes(file, kMaxTextBytes);
    if (!text) return tl::unexpected(text.error());
    const pugi::xml_parse_result result = document.load_buffer(text->data(), text->size());
    if (result) return {};
    return make_error(ErrorKind::kInvalidData,
                      fmt::format("{}: not valid XML at byte {}: {}; the file may be cut off",
                                  file.string(),
                                  result.offset,
                                  result.description()));
}

std::optional<std::vector<double>> attribute_numbers(const pugi::xml_node& node,
                                                     const char* name,
                                                     std::size_t count) {
    std::string_view text = node.attribute(name).value();
    std::vector<double> values;
    while (values.size() < count) {
        while (!text.empty() && (text.front() == ' ' || text.front() == '\t' ||
                                 text.front() == '\n' || text.front() == '+'))
            text.remove_prefix(1);
        double value = 0.0;
        const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (failure != std::errc{} || !std::isfinite(value)) return std::nullopt;
        values.push_back(value);
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        // "0,98" and "1.5px" are no numbers
        if (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) == 0)
            return std::nullopt;
    }
    return values;
}

std::optional<double> attribute_number(const pugi::xml_node& node, const char* name) {
    const auto values = attribute_numbers(node, name, 1);
    return values ? std::optional(values->front()) : std::nullopt;
}

std::string unreadable_number(const pugi::xml_node& node,
                              std::initializer_list<const char*> names) {
    for (const pugi::xml_attribute& attribute : node.attributes()) {
        const std::string word = decimal_comma(attribute.value());
        if (!word.empty())
            return fmt::format(
                "<{}> {}: {}", node.name(), attribute.name(), comma_is_no_point(word));
    }
    for (const char* name : names) {
        std::istringstream words(node.attribute(name).value());
        for (std::string word; words >> word;) {
            if (is_some_number(word)) continue;
            return fmt::format(
                "<{}> {}: '{}' is not a number; copy the file again, or export it again",
                node.name(),
                name,
                word);
        }
    }
    return {};
}

}  // namespace atrium::calibrate
