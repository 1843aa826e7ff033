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

/// TOML at a program's edge: values are read into structs that already hold their defaults; an
/// unknown key, a wrong type or a value outside its range is an error that names file, line, key
/// and what is allowed.
namespace atrium::config {

struct Range {
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
};

/// One table of a TOML file. Reads never throw; the first problem is kept and returned by `finish`,
/// after which nothing else matters. Copies refer to the same table.
class TableReader {
public:
    static Expected<TableReader> load(const std::filesystem::path& file);
    /// `name` stands for the file in error messages.
    static Expected<TableReader> parse(const std::string& toml_text, const std::string& name);

    /// Like all that reads: makes the key one that is known here.
    bool has(const std::string& key) const;
    /// There, and an array: for keys that may be one value or several.
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

    /// "room.toml:7", the place of what is at `key`, or of its table where it is absent: for
    /// problems that show later.
    std::string where(const std::string& key) const;

    /// Turns the absence of `key` into an error.
    void require(const std::string& key);

    /// Sub-table; empty where absent.
    TableReader table(const std::string& key);
    /// `[[key]]`; none where absent.
    std::vector<TableReader> tables(const std::string& key);

    /// Reports a problem of the caller's own with the value at `key`.
    void reject(const std::string& key, const std::string& what_is_allowed);

    /// The first problem, or else an error for the first key in this table or below that nobody
    /// asked for.
    Expected<void> finish() const;

    std::filesystem::path folder() const;

private:
    struct Document;
    struct Node;
    std::optional<Error> misspelling() const;
    TableReader(std::shared_ptr<Document> document, std::shared_ptr<Node> node);
    std::shared_ptr<Document> document_;
    std::shared_ptr<Node> node_;
};

}  // namespace atrium::config
