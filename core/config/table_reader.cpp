#include "core/config/table_reader.hpp"

#include "core/base/text_file.hpp"
#include "core/config/spelling.hpp"
#include "core/config/toml_text_internal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace atrium::config {

// The state that all readers of a file share.
struct TableReader::Document {
    std::string name;
    std::filesystem::path folder;
    toml::value root;
    std::optional<Error> first_problem;
    std::pair<std::shared_ptr<Node>, std::string> missing;  // the key, if it is a missing one

    void report(const std::string& where,
                const std::string& key,
                const std::string& problem,
                ErrorKind kind = ErrorKind::kConfiguration) {
        if (!first_problem) first_problem = Error{kind, where + ": " + key + ": " + problem};
    }
};

// One table, and the keys of it that the program has asked for.
struct TableReader::Node {
    const toml::value* table = nullptr;  // null: absent, every key keeps its default
    std::string path;                    // "physics." or empty at the root
    std::set<std::string> asked;
    std::map<std::string, std::shared_ptr<Node>> children;
    std::map<std::string, std::vector<std::shared_ptr<Node>>> arrays;

    const toml::value* find(const std::string& key) {
        asked.insert(key);
        if (table == nullptr) return nullptr;
        const auto& entries = table->as_table();
        const auto it = entries.find(key);
        return it == entries.end() ? nullptr : &it->second;
    }
};

namespace {

std::string describe(Range allowed) {
    const bool has_min = std::isfinite(allowed.min);
    const bool has_max = std::isfinite(allowed.max);
    if (has_min && has_max) return fmt::format(" in [{}, {}]", allowed.min, allowed.max);
    if (has_min) return fmt::format(" >= {}", allowed.min);
    if (has_max) return fmt::format(" <= {}", allowed.max);
    return "";
}

std::string location(const std::string& file, const toml::value& value) {
    const auto at = value.location();
    return at.line() > 0 ? fmt::format("{}:{}", file, at.line()) : file;
}

Error unknown(const std::string& where, const std::string& key, const std::string& hint) {
    return {ErrorKind::kConfiguration, where + ": " + key + ": unknown key; " + hint};
}

bool has_tables(const toml::value& value) {
    return value.is_table() ||
           (value.is_array() && !value.as_array().empty() && value.as_array().front().is_table());
}

std::optional<double> as_number(const toml::value& value) {
    if (value.is_floating()) return value.as_floating();
    if (value.is_integer()) return static_cast<double>(value.as_integer());
    return std::nullopt;
}

bool within(double v, Range allowed) {
    return std::isfinite(v) && v >= allowed.min && v <= allowed.max;
}

}  // namespace

TableReader::TableReader(std::shared_ptr<Document> document, std::shared_ptr<Node> node)
    : document_(std::move(document)), node_(std::move(node)) {}

Expected<TableReader> TableReader::load(const std::filesystem::path& file) {
    const auto text = read_text_file(file);
    if (!text) {
        const std::string meant = ask_which_path(file);
        return make_error(text.error().kind,
                          text.error().message + (meant.empty() ? "" : "; " + meant));
    }
    auto reader = parse(*text, file.string());
    if (reader) reader->document_->folder = file.parent_path();
    return reader;
}

Expected<TableReader> TableReader::parse(const std::string& toml_text, const std::string& name) {
    auto root = parse_toml(toml_text, name);
    if (!root) return tl::unexpected(root.error());
    auto document = std::make_shared<Document>();
    document->name = name;
    document->root = std::move(*root);
    auto node = std::make_shared<Node>();
    node->table = &document->root;
    return TableReader(std::move(document), std::move(node));
}

std::filesystem::path TableReader::folder() const { return document_->folder; }

void TableReader::set_folder(const std::filesystem::path& folder) { document_->folder = folder; }

TableReader TableReader::holder(const std::string& key) const {
    const auto dot = key.rfind('.');
    return dot == std::string::npos ? *this : TableReader(*this).table(key.substr(0, dot));
}

static std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

bool TableReader::has(const std::string& key) const {
    return holder(key).node_->find(last_part(key)) != nullptr;
}

bool TableReader::has_array(const std::string& key) const {
    const toml::value* found = holder(key).node_->find(last_part(key));
    return found != nullptr && found->is_array();
}

TableReader TableReader::table(const std::string& key) {
    if (key.find('.') != std::string::npos) return holder(key).table(last_part(key));
    auto& child = node_->children[key];
    if (!child) {
        child = std::make_shared<Node>();
        child->path = node_->path + key + ".";
        if (const toml::value* value = node_->find(key)) {
            if (value->is_table()) {
                child->table = value;
            } else {
                document_->report(location(document_->name, *value),
                                  node_->path + key,
                                  "must be a table, written [" + node_->path + key + "]");
            }
        }
    }
    return {document_, child};
}

std::vector<TableReader> TableReader::tables(const std::string& key) {
    if (key.find('.') != std::string::npos) return holder(key).tables(last_part(key));
    auto& nodes = node_->arrays[key];
    const toml::value* value = node_->find(key);
    if (value != nullptr && nodes.empty()) {
        const bool all_tables =
            value->is_array() && std::all_of(value->as_array().begin(),
                                             value->as_array().end(),
                                             [](const auto& v) { return v.is_table(); });
        if (!all_tables) {
            document_->report(
                location(document_->name, *value),
                node_->path + key,
                fmt::format("must be an array of tables, written [[{}{}]]", node_->path, key));
        } else {
            for (const toml::value& item : value->as_array()) {
                auto node = std::make_shared<Node>();
                node->table = &item;
                node->path = fmt::format("{}{}[{}].", node_->path, key, nodes.size());
                nodes.push_back(std::move(node));
            }
        }
    }
    std::vector<TableReader> readers;
    for (const auto& node : nodes) readers.push_back(TableReader(document_, node));
    return readers;
}

std::string TableReader::where(const std::string& key) const {
    if (key.find('.') != std::string::npos) return holder(key).where(last_part(key));
    if (const toml::value* value = node_->find(key)) return location(document_->name, *value);
    const bool is_root = node_->path.empty();
    return node_->table == nullptr || is_root ? document_->name
                                              : location(document_->name, *node_->table);
}

void TableReader::report(const std::string& key, const std::string& problem, ErrorKind kind) {
    if (!document_->first_problem && problem.starts_with("is missing"))
        document_->missing = {holder(key).node_, last_part(key)};
    const toml::value* value = holder(key).node_->find(last_part(key));
    const bool is_shown = value != nullptr && !has_tables(*value);
    document_->report(where(key),
                      node_->path + key,
                      is_shown ? problem + ", got " + shown(*value) : problem,
                      kind);
}

void TableReader::pass_over_others() {
    if (node_->table == nullptr) return;
    for (const auto& [key, value] : node_->table->as_table()) node_->asked.insert(key);
}

void TableReader::reject(const std::string& key, const std::string& what_is_allowed) {
    report(key, what_is_allowed, ErrorKind::kConfiguration);
}

void TableReader::reject(const std::string& key, const Error& error) {
    const bool is_missing = error.kind == ErrorKind::kNotFound;
    report(key, error.message, is_missing ? ErrorKind::kNotFound : ErrorKind::kConfiguration);
}

void TableReader::forbid(const std::string& key, const std::string& advice) {
    if (node_->table == nullptr) return;
    const auto& entries = node_->table->as_table();
    const auto found = entries.find(key);
    if (found == entries.end() || document_->first_problem) return;
    document_->first_problem =
        unknown(location(document_->name, found->second), node_->path + key, advice);
}

void TableReader::require(const std::string& key) {
    if (has(key)) return;
    reject(key, "is missing");
}

void TableReader::read(const std::string& key, bool& value) {
    const toml::value* found = holder(key).node_->find(last_part(key));
    if (found == nullptr) return;
    if (!found->is_boolean()) return reject(key, "must be true or false");
    value = found->as_boolean();
}

void TableReader::read(const std::string& key, std::int64_t& value, Range allowed) {
    const toml::value* found = holder(key).node_->find(last_part(key));
    if (found == nullptr) return;
    if (!found->is_integer() || !within(static_cast<double>(found->as_integer()), allowed))
        return reject(key, "must be an integer" + describe(allowed));
    value = found->as_integer();
}

void TableReader::read(const std::string& key, int& value, Range allowed) {
    std::int64_t wide = value;
    allowed.min = std::max<double>(allowed.min, std::numeric_limits<int>::min());
    allowed.max = std::min<double>(allowed.max, std::numeric_limits<int>::max());
    read(key, wide, allowed);
    value = static_cast<int>(wide);
}

void TableReader::read(const std::string& key, std::uint32_t& value, Range allowed) {
    std::int64_t wide = value;
    allowed.min = std::max(allowed.min, 0.0);
    allowed.max = std::min<double>(allowed.max, std::numeric_limits<std::uint32_t>::max());
    read(key, wide, allowed);
    value = static_cast<std::uint32_t>(wide);
}

void TableReader::read(const std::string& key, std::uint64_t& value, Range allowed) {
    auto wide = static_cast<std::int64_t>(value);
    allowed.min = std::max(allowed.min, 0.0);
    read(key, wide, allowed);
    value = static_cast<std::uint64_t>(wide);
}

void TableReader::read(const std::string& key, double& value, Range allowed) {
    const toml::value* found = holder(key).node_->find(last_part(key));
    if (found == nullptr) return;
    const auto number = as_number(*found);
    if (!number || !within(*number, allowed))
        return reject(key, "must be a number" + describe(allowed));
    value = *number;
}

void TableReader::read(const std::string& key,
                       std::string& value,
                       const std::vector<std::string>& choices) {
    const toml::value* found = holder(key).node_->find(last_part(key));
    if (found == nullptr) return;
    if (!found->is_string()) return reject(key, "must be a string in double quotes");
    const std::string text = found->as_string();
    if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end())
        return reject(key, must_be_one_of(choices, text));
    value = text;
}

void TableReader::read(const std::string& key, std::filesystem::path& value) {
    if (!has(key)) return;
    std::string text;
    read(key, text);
    const std::filesystem::path path = text;
    value = text.empty() || path.is_absolute() ? path : document_->folder / path;
}

void TableReader::read(const std::string& key, double* values, std::size_t count, Range allowed) {
    const toml::value* found = holder(key).node_->find(last_part(key));
    if (found == nullptr) return;
    const std::string rule =
        fmt::format("must be an array of {} numbers{}", count, describe(allowed));
    if (!found->is_array() || found->as_array().size() != count) return reject(key, rule);
    for (std::size_t i = 0; i < count; ++i) {
        const auto number = as_number(found->as_array()[i]);
        if (!number || !within(*number, allowed)) return reject(key, rule);
        values[i] = *number;
    }
}

void TableReader::read(const std::string& key,
                       std::vector<std::array<double, 2>>& points,
                       Range allowed) {
    const toml::value* found = holder(key).node_->find(last_part(key));
    if (found == nullptr) return;
    const std::string rule = fmt::format("must be an array of [x, y]{}", describe(allowed));
    if (!found->is_array()) return reject(key, rule);
    std::vector<std::array<double, 2>> read_points;
    for (const toml::value& point : found->as_array()) {
        if (!point.is_array() || point.as_array().size() != 2) return reject(key, rule);
        const auto x = as_number(point.as_array()[0]);
        const auto y = as_number(point.as_array()[1]);
        if (!x || !y || !within(*x, allowed) || !within(*y, allowed)) return reject(key, rule);
        read_points.push_back({*x, *y});
    }
    points = std::move(read_points);
}

void TableReader::read(const std::string& key, std::vector<std::string>& values) {
    const toml::value* found = holder(key).node_->find(last_part(key));
    if (found == nullptr) return;
    const bool all_strings =
        found->is_array() && std::all_of(found->as_array().begin(),
                                         found->as_array().end(),
                                         [](const auto& v) { return v.is_string(); });
    if (!all_strings) return reject(key, "must be an array of strings in double quotes");
    values.clear();
    for (const toml::value& v : found->as_array()) values.push_back(v.as_string());
}

// Looks for a misspelt name that explains the first error: that of a table, whose content is then
// missing elsewhere, or of a key that the error calls missing.
std::optional<Error> TableReader::misspelling() const {
    const std::vector<std::string> known(node_->asked.begin(), node_->asked.end());
    for (const auto& [key, value] : node_->table->as_table()) {
        if (node_->asked.contains(key) || !has_tables(value)) continue;
        const std::string meant = ask_which(names_meant_by(key, known));
        if (meant.empty()) continue;
        return unknown(location(document_->name, value), node_->path + key, meant);
    }
    const auto& [node, missing] = document_->missing;
    if (node == nullptr || node->table == nullptr) return std::nullopt;
    for (const auto& [key, value] : node->table->as_table()) {
        if (node->asked.contains(key) || names_meant_by(key, {missing}).empty()) continue;
        return unknown(location(document_->name, value),
                       node->path + key,
                       "did you mean " + missing + ", which is missing?");
    }
    return std::nullopt;
}

// Adds the keys that the program knows in this table and below.
void TableReader::add_known_keys(const Node& node, std::vector<std::string>& keys) {
    for (const std::string& key : node.asked) keys.push_back(node.path + key);
    for (const auto& [key, child] : node.children) add_known_keys(*child, keys);
}

// Finds the first unknown key. Recurses only over the tables that the program opened.
std::optional<Error> TableReader::unknown_key(const Node& node) const {
    if (node.table == nullptr) return std::nullopt;
    for (const auto& [key, value] : node.table->as_table()) {
        if (node.asked.contains(key)) continue;
        std::vector<std::string> known;
        add_known_keys(node, known);  // first: the nearest of equally similar keys
        add_known_keys(*node_, known);
        std::string hint = ask_which(names_meant_by(node.path + key, known));
        if (!hint.empty()) hint += ' ';
        return unknown(location(document_->name, value),
                       node.path + key,
                       fmt::format("{}known here: {}", hint, fmt::join(node.asked, ", ")));
    }
    for (const auto& [key, child] : node.children) {
        if (auto error = unknown_key(*child)) return error;
    }
    for (const auto& [key, nodes] : node.arrays) {
        for (const auto& child : nodes) {
            if (auto error = unknown_key(*child)) return error;
        }
    }
    return std::nullopt;
}

Expected<void> TableReader::finish() const {
    if (const auto& problem = document_->first_problem) {
        const auto misspelt = misspelling();
        return tl::unexpected(misspelt ? *misspelt : *problem);
    }
    if (auto error = unknown_key(*node_)) return tl::unexpected(*error);
    return {};
}

}  // namespace atrium::config
