#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Files of named numbers, whatever their syntax. The bytes may be hostile.
namespace atrium::calibrate {

/// Maps, lists, strings and numbers of a YAML, XML (of OpenCV), JSON or TOML file.
using Tree = nlohmann::json;

inline constexpr std::size_t kMaxTextBytes = std::size_t{16} << 20;

/// Reads a whole file. Errors: kNotFound, or kInvalidData beyond `max_bytes`.
Expected<std::string> read_bytes(const std::filesystem::path& file, std::size_t max_bytes);

/// `name` stands for the file in errors, which are kInvalidData.
Expected<Tree> parse_toml(const std::string& text, const std::string& name);
Expected<Tree> parse_json(const std::string& text, const std::string& name);
/// YAML, or the XML of OpenCV, by OpenCV's FileStorage. Block sequences may start in the column of
/// their key, as Kalibr writes them.
Expected<Tree> parse_file_storage(const std::string& text, const std::string& name);

/// The numbers of a list, of nested lists row by row, or of an OpenCV matrix. nullopt if something
/// else is in there, a number is not finite, or there are more than 64.
std::optional<std::vector<double>> numbers(const Tree& value);

/// The number of a value that is one, or a list of one; nullopt for anything else.
std::optional<double> number(const Tree& value);

/// The first word of a text that is a number but for its decimal comma, as "0,98"; else empty.
std::string decimal_comma(std::string_view text);

/// The same, of the strings in a tree.
std::string decimal_comma_in(const Tree& tree);

/// "'0,98' is not a number; decimals have a point: 0.98".
std::string comma_is_no_point(const std::string& word);
/// "0.98" of "0,98".
std::string with_points(std::string word);
/// For files that are no valid TOML or YAML: 0,05 makes 0 and 05, which is no number.
inline constexpr const char* kCutOffOrComma =
    "the file may be cut off, or have a decimal comma: decimals have a point";

/// The first of `keys` in a map, compared without case; nullptr if there is none.
const Tree* find(const Tree& map, std::initializer_list<const char*> keys);

/// A rotation matrix of 9 numbers, row by row, or of a Rodrigues vector of 3. The matrix is made
/// exactly orthonormal. nullopt if it is not a right-handed rotation to 1e-2.
std::optional<Eigen::Matrix3d> rotation_of(const std::vector<double>& values);

}  // namespace atrium::calibrate
