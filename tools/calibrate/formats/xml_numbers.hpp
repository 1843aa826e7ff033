#pragma once

#include "core/base/expected.hpp"

#include <pugixml.hpp>

#include <cstddef>
#include <filesystem>
#include <initializer_list>
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

/// Why an attribute cannot be read, for messages: the first with a decimal comma, else the first of
/// `names` that is given and not as numbers: "<transform> r11: '0,98' is not a number; decimals
/// have a point". Empty: there is none. nan and inf are numbers here: programs write them for
/// cameras that are not calibrated.
std::string unreadable_number(const pugi::xml_node& node, std::initializer_list<const char*> names);

}  // namespace atrium::calibrate
