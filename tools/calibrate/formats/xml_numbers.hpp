#pragma once

#include "core/base/expected.hpp"

#include <pugixml.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Parses a file of at most 16 MiB. pugixml neither follows references nor recurses.
Expected<void> load_xml(const std::filesystem::path& file, pugi::xml_document& document);

/// The `count` finite numbers, separated by spaces, of an attribute. nullopt if there are others.
std::optional<std::vector<double>> attribute_numbers(const pugi::xml_node& node,
                                                     const char* name,
                                                     std::size_t count);
/// The same, of one number.
std::optional<double> attribute_number(const pugi::xml_node& node, const char* name);

/// The first attribute with a number that has a decimal comma, for messages:
/// "<transform> r11: '0,98' is not a number; decimals have a point". Empty: there is none.
std::string comma_in_attributes(const pugi::xml_node& node);

}  // namespace atrium::calibrate
