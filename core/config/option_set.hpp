#pragma once

#include "core/base/expected.hpp"
#include "core/config/table_reader.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace atrium::config {

/// The options of one program, declared once and served three ways: keys of its TOML file
/// (`hull.threads`), options of its command line (`--hull.threads 2`), lines of its `--help` with
/// unit and default.
///
/// `target` holds the default when it is declared, and must outlive the set.
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
    /// `alone` is the value where the option stands on the command line without one; empty: it
    /// needs one.
    void add(const std::string& key,
             std::filesystem::path& target,
             const std::string& help,
             const std::string& alone = {});

    /// One of `words`, or else a path, which in a file is taken from the folder of that file.
    void add_word_or_path(const std::string& key,
                          std::string& target,
                          const std::string& help,
                          const std::vector<std::string>& words);
    /// On the command line, `--name` is the last option added.
    void also_called(const std::string& name);

    /// One more line of `effective()`, of what is no option because only a file can say it.
    void show(const std::string& key, std::function<std::string()> current);

    /// Reads every declared key that the file has. Does not call `reader.finish()`: a program may
    /// read more from the file.
    void read_file(TableReader& reader) const;

    /// One `key = value` as text, as on the command line. `source` names it in errors.
    Expected<void> set(const std::string& key,
                       const std::string& text,
                       const std::string& source) const;

    struct Entry {
        std::string key;
        std::string help;           // says the unit
        std::string type_name;      // for example "number in [0, 1]"
        std::string default_value;  // as text
        std::string alone;          // value of an option that stands alone; empty: it needs one
        std::string short_name;     // on the command line, besides the key; empty: none
        std::function<void(TableReader&)> read;
        std::function<Expected<void>(const std::string&)> parse;
    };
    const std::vector<Entry>& entries() const { return entries_; }
    /// `key = value` of every option as it is now, one per line, and of what is shown besides: the
    /// effective configuration.
    std::string effective() const;
    /// Those lines of it that are not as they were declared.
    std::string changed() const;

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
    std::vector<std::function<std::string()>> current_;  // of the entries
    std::vector<Shown> shown_;
};

}  // namespace atrium::config
