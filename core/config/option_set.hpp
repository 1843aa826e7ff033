#pragma once

#include "core/base/expected.hpp"
#include "core/config/table_reader.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace atrium::config {

/// Declares the options of a program once, for three uses: keys of its TOML file (`site.threads`),
/// options of its command line (`--site.threads 2`) and lines of its `--help` with unit and
/// default.
///
/// `target` holds the default when it is added, and must outlive the set.
class OptionSet {
public:
    void add(const std::string& key, bool& target, const std::string& help);
    void add(const std::string& key, int& target, const std::string& help, Range allowed = {});
    void add(const std::string& key,
             std::uint64_t& target,
             const std::string& help,
             Range allowed = {});
    void add(const std::string& key,
             std::int64_t& target,
             const std::string& help,
             Range allowed = {});
    void add(const std::string& key,
             std::uint32_t& target,
             const std::string& help,
             Range allowed = {});
    void add(const std::string& key, double& target, const std::string& help, Range allowed = {});
    void add(const std::string& key,
             std::string& target,
             const std::string& help,
             const std::vector<std::string>& choices = {});
    /// `implicit_value` is the value of the option if the command line gives none; empty: a value
    /// is required.
    void add(const std::string& key,
             std::filesystem::path& target,
             const std::string& help,
             const std::string& implicit_value = {});

    /// Adds an option that is one of `words` or a path. A relative path in a file is relative to
    /// the file's folder.
    void add_word_or_path(const std::string& key,
                          std::string& target,
                          const std::string& help,
                          const std::vector<std::string>& words);
    /// Adds an option with a form of its own on the command line. The set does not read its key
    /// from the file: the program does. `parse` returns false for text that is not of `type_name`.
    void add_own(const std::string& key,
                 const std::string& type_name,
                 const std::string& help,
                 std::function<bool(const std::string&)> parse,
                 std::function<std::string()> current);
    /// Makes `--name`, or `-n` for one letter, an alias of the last added option on the command
    /// line.
    void add_alias(const std::string& name);
    /// Makes an empty text for the last added option, a string, an error: "is empty: `advice`".
    void refuse_empty(const std::string& advice);

    /// Adds a line to `effective()` for a value that is not an option, because only a file can set
    /// it.
    void show(const std::string& key, std::function<std::string()> current);

    /// Reads every declared key from the file. Does not call `reader.finish()`: a program may read
    /// more from the file.
    void read_file(TableReader& reader) const;

    /// Sets an option from text, as on the command line. `source` names it in errors.
    Expected<void> set(const std::string& key,
                       const std::string& text,
                       const std::string& source) const;

    struct Entry {
        std::string key;
        std::string help;            // includes the unit
        std::string type_name;       // for example "number in [0, 1]"
        std::string default_value;   // as text
        std::string implicit_value;  // value if none is given; empty: a value is required
        std::string alias;           // alias on the command line; empty: none
        std::function<void(TableReader&)> read;
        std::function<Expected<void>(const std::string&)> parse;
    };
    const std::vector<Entry>& entries() const { return entries_; }
    /// Returns the effective configuration: a line `key = value` per option and per `show`.
    std::string effective() const;
    /// Returns only those lines of `effective()` whose value is not the default or whose key is in
    /// `given`.
    std::string changed(const std::set<std::string>& given = {}) const;

private:
    template <typename T, typename... Limits>
    void add_entry(const std::string& key,
                   T& target,
                   const std::string& help,
                   std::string type_name,
                   Limits... limits);
    struct Shown {
        std::string key;
        std::function<std::string()> current;
        std::string declared;
    };
    std::vector<Entry> entries_;
    std::vector<std::function<std::string()>> current_;  // values of the entries
    std::vector<Shown> shown_;
};

}  // namespace atrium::config
