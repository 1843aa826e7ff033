// OpenCV's FileStorage, with checks before it of what it takes badly: depth and size.
#include "tools/calibrate/formats/data_tree.hpp"

#include <fmt/format.h>
#include <opencv2/core/persistence.hpp>
#include <opencv2/core/utils/logger.hpp>

#include <algorithm>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMaxNesting = 32;
constexpr std::size_t kMaxNodes = 200'000;

bool is_xml(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string::npos && text[first] == '<';
}

std::size_t indent_of(const std::string& line) {
    return std::min(line.find_first_not_of(' '), line.size());
}

bool is_dash(const std::string& line, std::size_t indent) {
    return indent < line.size() && line[indent] == '-' &&
           (indent + 1 == line.size() || line[indent + 1] == ' ');
}

// FileStorage wants its own first line, no document marks, and sequences further right than their
// key. The text need not be valid YAML.
std::string for_file_storage(const std::string& yaml) {
    std::string result = "%YAML:1.0\n---\n";
    std::size_t key_indent = 0;
    bool is_shifted = false;
    for (std::size_t begin = 0; begin < yaml.size();) {
        const std::size_t end = std::min(yaml.find('\n', begin), yaml.size());
        std::string line = yaml.substr(begin, end - begin);
        begin = end + 1;
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
        if (line.starts_with("%") || line == "---" || line == "..." || line.empty()) continue;
        const std::size_t indent = indent_of(line);
        const bool has_key = line.back() == ':' && !is_dash(line, indent);
        is_shifted = is_dash(line, indent) && indent == key_indent ? true
                     : indent > key_indent                         ? is_shifted
                                                                   : false;
        if (has_key || (indent <= key_indent && !is_dash(line, indent))) key_indent = indent;
        result += (is_shifted ? "  " : "") + line + "\n";
    }
    return result;
}

// Flow collections and indentation for YAML, open elements for XML.
bool is_too_deep(const std::string& text, bool xml) {
    std::size_t depth = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (xml && c == '<') {
            const char next = i + 1 < text.size() ? text[i + 1] : '\0';
            if (next == '/' && depth > 0) --depth;
            if (next != '/' && next != '!' && next != '?') ++depth;
        } else if (!xml) {
            if (c == '[' || c == '{') ++depth;
            if ((c == ']' || c == '}') && depth > 0) --depth;
        }
        if (depth > kMaxNesting) return true;
    }
    std::size_t spaces = 0;
    std::size_t dashes = 0;  // "- - - " opens a list each
    bool at_start = true;
    for (const char c : text) {
        if (c == '\n') {
            spaces = dashes = 0;
            at_start = true;
        } else if (at_start && (c == ' ' || c == '-')) {
            spaces += 1;
            dashes += c == '-' ? 1 : 0;
        } else {
            at_start = false;
        }
        if (!xml && (spaces > 20 * kMaxNesting || dashes > kMaxNesting)) return true;
    }
    return false;
}

Tree from_node(const cv::FileNode& node, std::size_t depth, std::size_t& num_nodes) {
    if (++num_nodes > kMaxNodes || depth > 2 * kMaxNesting) return nullptr;
    if (node.isInt()) return static_cast<int>(node);
    if (node.isReal()) return static_cast<double>(node);
    if (node.isString()) return static_cast<std::string>(node);
    if (node.isMap()) {
        Tree map = Tree::object();
        for (const cv::FileNode& child : node)
            map[child.name()] = from_node(child, depth + 1, num_nodes);
        return map;
    }
    if (!node.isSeq()) return nullptr;
    Tree list = Tree::array();
    for (const cv::FileNode& child : node) list.push_back(from_node(child, depth + 1, num_nodes));
    return list;
}

// ": line 26: Missing , between the elements" of the message of an OpenCV exception, which ends
// with "in function '(26): Missing ...'".
std::string place_of(std::string what) {
    std::ranges::replace(what, '\n', ' ');
    const std::size_t begin = what.rfind("'(");
    const std::size_t end = what.find("): ", begin == std::string::npos ? what.size() : begin);
    if (end == std::string::npos) return {};
    std::string text = what.substr(end + 3);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\'')) text.pop_back();
    return fmt::format(": line {}: {}", what.substr(begin + 2, end - begin - 2), text);
}

}  // namespace

Expected<Tree> parse_file_storage(const std::string& text, const std::string& name) {
    const bool xml = is_xml(text);
    const auto damaged = [&](const std::string& what) {
        return make_error(ErrorKind::kInvalidData, fmt::format("{}: {}", name, what));
    };
    if (text.size() > kMaxTextBytes) return damaged("too large for a calibration");
    if (text.find('\0') != std::string::npos) return damaged("not text");
    if (is_too_deep(text, xml)) return damaged("nested too deeply");
    if (text.find("$base64$") != std::string::npos || text.find("binary") != std::string::npos)
        return damaged("has base64 data; write the matrices as numbers");
    // FileStorage throws after it has logged; the error below says it
    const auto level = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    Expected<Tree> result = Tree::object();
    try {
        const cv::FileStorage storage(xml ? text : for_file_storage(text),
                                      cv::FileStorage::READ | cv::FileStorage::MEMORY);
        std::size_t num_nodes = 0;
        if (storage.isOpened()) {
            result = from_node(storage.root(), 0, num_nodes);
        } else {
            result = damaged(xml ? "not an XML file of OpenCV" : "not valid YAML");
        }
    } catch (const std::exception& failure) {
        std::string words = text;
        std::ranges::replace_if(
            words, [](char c) { return c == '<' || c == '>'; }, ' ');
        const std::string comma = decimal_comma(words);
        result = damaged(fmt::format("not a file of OpenCV's FileStorage{}; {}",
                                     place_of(failure.what()),
                                     comma.empty() ? kCutOffOrComma : comma_is_no_point(comma)));
    }
    cv::utils::logging::setLogLevel(level);
    return result;
}

}  // namespace atrium::calibrate
