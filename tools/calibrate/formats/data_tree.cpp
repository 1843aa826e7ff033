#include "tools/calibrate/formats/data_tree.hpp"

#include "core/base/looked_up.hpp"
#include "core/base/readable.hpp"
#include "core/config/toml_nesting.hpp"
#include "core/geometry/alignment.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>
#include <toml.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMaxNumbers = 64;
constexpr int kMaxDepth = 32;
constexpr double kMaxRotationError = 1e-2;  // files with few digits exist

tl::unexpected<Error> damaged(const std::string& name, const std::string& what) {
    return make_error(ErrorKind::kInvalidData, fmt::format("{}: {}", name, what));
}

Tree from_toml(const toml::value& value) {
    switch (value.type()) {
        case toml::value_t::boolean:
            return value.as_boolean();
        case toml::value_t::integer:
            return value.as_integer();
        case toml::value_t::floating:
            return value.as_floating();
        case toml::value_t::string:
            return value.as_string().str;
        case toml::value_t::array: {
            Tree list = Tree::array();
            for (const toml::value& element : value.as_array()) list.push_back(from_toml(element));
            return list;
        }
        case toml::value_t::table: {
            Tree map = Tree::object();
            for (const auto& [key, element] : value.as_table()) map[key] = from_toml(element);
            return map;
        }
        default:
            return nullptr;
    }
}

bool append_numbers(const Tree& value, int depth, std::vector<double>& out) {
    if (depth > kMaxDepth || out.size() > kMaxNumbers) return false;
    if (value.is_object()) {
        const Tree* data = find(value, {"data"});
        return data != nullptr && append_numbers(*data, depth + 1, out);
    }
    if (value.is_array()) {
        return std::ranges::all_of(
            value, [&](const Tree& element) { return append_numbers(element, depth + 1, out); });
    }
    if (!value.is_number()) return false;
    out.push_back(value.get<double>());
    return std::isfinite(out.back()) && out.size() <= kMaxNumbers;
}

bool equal_without_case(const std::string& a, const std::string& b) {
    return std::ranges::equal(
        a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

// The first line of toml11's message, without its function, and the place: " --> a.toml  | 7 | K =
// [".
std::string toml_reason(const std::string& what) {
    std::string reason = what.substr(0, what.find('\n'));
    if (const std::size_t function = reason.find("toml::"); function != std::string::npos) {
        const std::size_t end = reason.find(": ", function);
        if (end != std::string::npos) reason = reason.substr(end + 2);
    }
    const std::size_t bar = what.find(" | ");
    const std::size_t line_begin = bar == std::string::npos ? bar : what.rfind('\n', bar);
    std::string line =
        line_begin == std::string::npos ? "" : what.substr(line_begin, bar - line_begin);
    std::erase_if(line, [](unsigned char c) { return std::isdigit(c) == 0; });
    return (line.empty() ? "" : "line " + line + ": ") + reason;
}

// The decimal comma of a value that is no list, as in "error = 0,5"; or empty.
std::string comma_in_toml(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t equals = line.find('=');
        if (equals == std::string::npos || line.find_first_of("[\"'#{") != std::string::npos)
            continue;
        if (std::string word = decimal_comma(line.substr(equals + 1)); !word.empty()) return word;
    }
    return {};
}

}  // namespace

Expected<std::string> read_bytes(const std::filesystem::path& file, std::size_t max_bytes) {
    if (auto readable = check_readable(file); !readable) {
        if (readable.error().kind != ErrorKind::kNotFound) return tl::unexpected(readable.error());
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("{}: no such file{}; check the path", file.string(), looked_up_from(file)));
    }
    std::error_code failure;
    if (std::filesystem::is_empty(file, failure))
        return damaged(file.string(), "the file is empty; copy it again");
    if (std::filesystem::file_size(file, failure) > max_bytes || failure) {
        return damaged(file.string(),
                       fmt::format("larger than {} bytes, so it is no calibration", max_bytes));
    }
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream bytes;
    if (!stream || !(bytes << stream.rdbuf()).good()) {
        return make_error(ErrorKind::kNotFound, fmt::format("{}: cannot be read", file.string()));
    }
    return std::move(bytes).str();
}

Expected<Tree> parse_toml(const std::string& text, const std::string& name) {
    if (const std::size_t line = config::line_nested_too_deeply(text); line > 0)
        return damaged(name, fmt::format("line {} is nested too deeply", line));
    try {
        std::istringstream stream(text);
        return from_toml(toml::parse(stream, name));
    } catch (const std::exception& failure) {
        const std::string comma = comma_in_toml(text);
        return damaged(name,
                       fmt::format("not valid TOML: {}; {}",
                                   toml_reason(failure.what()),
                                   comma.empty() ? kCutOffOrComma : comma_is_no_point(comma)));
    }
}

Expected<Tree> parse_json(const std::string& text, const std::string& name) {
    int depth = 0;
    int deepest = 0;
    for (const char c : text) {
        if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
        if (c == ']' || c == '}') --depth;
    }
    if (deepest > kMaxDepth) return damaged(name, "nested too deeply");
    try {
        return Tree::parse(text, nullptr, true, true);
    } catch (const std::exception& failure) {
        const bool has_nan = text.find("NaN") != std::string::npos;
        const bool may_have_comma =
            std::string_view(failure.what()).find("object key - unexpected number") !=
            std::string_view::npos;
        return damaged(
            name,
            fmt::format("not valid JSON: {}{}{}",
                        failure.what(),
                        has_nan ? "; a value is NaN, not a number: calibrate again" : "",
                        may_have_comma ? "; is it a decimal comma? decimals have a point" : ""));
    }
}

std::optional<std::vector<double>> numbers(const Tree& value) {
    std::vector<double> result;
    if (!append_numbers(value, 0, result)) return std::nullopt;
    return result;
}

std::optional<double> number(const Tree& value) {
    const auto all = numbers(value);
    if (!all || all->size() != 1) return std::nullopt;
    return all->front();
}

std::string decimal_comma(std::string_view text) {
    std::istringstream words{std::string(text)};
    for (std::string word; words >> word;) {
        std::string with_point = word;
        const std::size_t comma = with_point.find(',');
        if (comma == std::string::npos || comma + 1 == with_point.size()) continue;
        with_point[comma] = '.';
        const char* const begin = with_point.c_str();
        char* end = nullptr;
        std::strtod(begin, &end);
        if (end == begin + with_point.size()) return word;
    }
    return {};
}

std::string decimal_comma_in(const Tree& tree) {
    if (tree.is_string()) return decimal_comma(tree.get_ref<const std::string&>());
    if (!tree.is_structured()) return {};
    for (const Tree& child : tree) {
        if (std::string word = decimal_comma_in(child); !word.empty()) return word;
    }
    return {};
}

std::string comma_is_no_point(const std::string& word) {
    return fmt::format("'{}' is not a number; decimals have a point: {}", word, with_points(word));
}

std::string with_points(std::string word) {
    std::ranges::replace(word, ',', '.');
    return word;
}

const Tree* find(const Tree& map, std::initializer_list<const char*> keys) {
    if (!map.is_object()) return nullptr;
    for (const char* key : keys) {
        for (const auto& [name, value] : map.items()) {
            if (equal_without_case(name, key)) return &value;
        }
    }
    return nullptr;
}

std::optional<Eigen::Matrix3d> rotation_of(const std::vector<double>& values) {
    if (values.size() == 3) {
        const Eigen::Vector3d v(values[0], values[1], values[2]);
        const double angle = v.norm();
        if (!(angle < 1e3)) return std::nullopt;
        if (angle < 1e-12) return Eigen::Matrix3d(Eigen::Matrix3d::Identity());
        return Eigen::AngleAxisd(angle, v / angle).toRotationMatrix();
    }
    if (values.size() != 9) return std::nullopt;
    const Eigen::Matrix3d m =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
    const double error = (m.transpose() * m - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(error < kMaxRotationError) || !(m.determinant() > 0.0)) return std::nullopt;
    return geometry::rotation_of(m);
}

}  // namespace atrium::calibrate
