#pragma once

#include "core/base/expected.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Reads TOML into structs that already hold their defaults. An unknown key, a wrong type or a
/// value out of range is an error that names file, line, key and the allowed values.
namespace atrium::config {

struct Range {
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
};

/// Reads one table of a TOML file. Reads never throw; `finish` returns the first error. Copies
/// refer to the same table.
class TableReader {
public:
    static Expected<TableReader> load(const std::filesystem::path& file);
    /// `name` stands for the file in error messages.
    static Expected<TableReader> parse(const std::string& toml_text, const std::string& name);

    /// True if the key is present. Like every read, it makes the key a known one.
    bool has(const std::string& key) const;
    /// True if the key is present and an array, for keys that take one value or several.
    bool has_array(const std::string& key) const;

    // Optional keys: `value` stays as it is when the key is absent. Dotted keys reach into
    // sub-tables.
    void read(const std::string& key, bool& value);
    void read(const std::string& key, std::int64_t& value, Range allowed = {});
    void read(const std::string& key, int& value, Range allowed = {});
    void read(const std::string& key, std::uint32_t& value, Range allowed = {});
    void read(const std::string& key, std::uint64_t& value, Range allowed = {});
    void read(const std::string& key, double& value, Range allowed = {});
    void read(const std::string& key,
              std::string& value,
              const std::vector<std::string>& choices = {});
    /// A relative path is taken relative to the file's folder.
    void read(const std::string& key, std::filesystem::path& value);
    /// Exactly `count` numbers.
    void read(const std::string& key, double* values, std::size_t count, Range allowed = {});
    /// Any number of points `[x, y]`.
    void read(const std::string& key,
              std::vector<std::array<double, 2>>& points,
              Range allowed = {});
    /// Any number of strings.
    void read(const std::string& key, std::vector<std::string>& values);

    /// Returns the place of `key`, for example "room.toml:7", or of its table if the key is absent.
    /// For errors that are found later.
    std::string where(const std::string& key) const;

    /// Turns the absence of `key` into an error.
    void require(const std::string& key);

    /// Returns the sub-table; an empty one if absent.
    TableReader table(const std::string& key);
    /// Returns the tables `[[key]]`; none if absent.
    std::vector<TableReader> tables(const std::string& key);

    /// If the key is present, reports it as unknown, with advice. For likely mistakes.
    void forbid(const std::string& key, const std::string& advice);

    /// Makes every key of this table that was not read yet a known one: another program reads it.
    void pass_over_others();

    /// Reports an error that the caller found in the value at `key`.
    void reject(const std::string& key, const std::string& what_is_allowed);
    /// Reports why the file that `key` names cannot be used: kNotFound if it is missing, else
    /// kConfiguration.
    void reject(const std::string& key, const Error& error);

    /// Returns the first error; without one, an error for the first unknown key in this table or
    /// below.
    Expected<void> finish() const;

    /// Folder of the file, or the one set last. Relative paths start there.
    std::filesystem::path folder() const;
    /// For all readers of this file.
    void set_folder(const std::filesystem::path& folder);

private:
    struct Document;
    struct Node;
    void report(const std::string& key, const std::string& problem, ErrorKind kind);
    std::optional<Error> misspelling() const;
    static void add_known_keys(const Node& node, std::vector<std::string>& keys);
    std::optional<Error> unknown_key(const Node& node) const;
    /// The table that holds the last part of a dotted key.
    TableReader holder(const std::string& key) const;
    TableReader(std::shared_ptr<Document> document, std::shared_ptr<Node> node);
    std::shared_ptr<Document> document_;
    std::shared_ptr<Node> node_;
};

}  // namespace atrium::config
