#include "core/config/option_set.hpp"

#include <fmt/format.h>

#include <cmath>
#include <type_traits>

namespace atrium::config {
namespace {

std::string range_text(const char* noun, Range allowed) {
    const bool has_min = std::isfinite(allowed.min);
    const bool has_max = std::isfinite(allowed.max);
    if (has_min && has_max) return fmt::format("{} in [{}, {}]", noun, allowed.min, allowed.max);
    if (has_min) return fmt::format("{} >= {}", noun, allowed.min);
    if (has_max) return fmt::format("{} <= {}", noun, allowed.max);
    return noun;
}

std::string text_of(bool v) { return v ? "true" : "false"; }
std::string text_of(const std::string& v) { return v; }
std::string text_of(const std::filesystem::path& v) { return v.string(); }
template <typename Number>
std::string text_of(Number v) {
    return fmt::format("{}", v);
}

// Matches the wording of TableReader's errors.
std::string with_article(const std::string& type) {
    if (type.starts_with("integer")) return "an " + type;
    if (type.starts_with("number") || type.starts_with("path")) return "a " + type;
    return type;
}

// Turns text from the command line into TOML, for the same checks and messages as in a file.
std::string as_toml(const std::string& text, bool quoted) {
    if (!quoted) return text;
    std::string literal = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') literal += '\\';
        literal += c;
    }
    return literal + "\"";
}

}  // namespace

template <typename T, typename... Limits>
void OptionSet::add_entry(const std::string& key,
                          T& target,
                          const std::string& help,
                          std::string type_name,
                          Limits... limits) {
    Entry entry;
    entry.key = key;
    entry.help = help;
    entry.type_name = std::move(type_name);
    entry.default_value = text_of(target);
    if (std::is_same_v<T, bool>) entry.implicit_value = "true";
    entry.read = [key, &target, limits...](TableReader& reader) {
        reader.read(key, target, limits...);
    };
    constexpr bool kQuoted =
        std::is_same_v<T, std::string> || std::is_same_v<T, std::filesystem::path>;
    entry.parse =
        [&target, type = entry.type_name, limits...](const std::string& text) -> Expected<void> {
        auto reader = TableReader::parse("value = " + as_toml(text, kQuoted), "");
        T value = target;
        if (reader) {
            reader->read("value", value, limits...);
            if (reader->finish()) {
                target = value;
                return {};
            }
        }
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("must be {}, got '{}'", with_article(type), text));
    };
    entries_.push_back(std::move(entry));
    current_.push_back([&target] { return text_of(target); });
}

void OptionSet::add(const std::string& key, bool& target, const std::string& help) {
    add_entry(key, target, help, "true or false");
}
void OptionSet::add(const std::string& key, int& target, const std::string& help, Range allowed) {
    add_entry(key, target, help, range_text("integer", allowed), allowed);
}
void OptionSet::add(const std::string& key,
                    std::int64_t& target,
                    const std::string& help,
                    Range allowed) {
    add_entry(key, target, help, range_text("integer", allowed), allowed);
}
void OptionSet::add(const std::string& key,
                    std::uint32_t& target,
                    const std::string& help,
                    Range allowed) {
    allowed.min = std::max(allowed.min, 0.0);
    add_entry(key, target, help, range_text("integer", allowed), allowed);
}
void OptionSet::add(const std::string& key,
                    std::uint64_t& target,
                    const std::string& help,
                    Range allowed) {
    allowed.min = std::max(allowed.min, 0.0);
    add_entry(key, target, help, range_text("integer", allowed), allowed);
}
void OptionSet::add(const std::string& key,
                    double& target,
                    const std::string& help,
                    Range allowed) {
    add_entry(key, target, help, range_text("number", allowed), allowed);
}
void OptionSet::add(const std::string& key,
                    std::string& target,
                    const std::string& help,
                    const std::vector<std::string>& choices) {
    const std::string type =
        choices.empty() ? std::string("text") : fmt::format("one of {}", fmt::join(choices, ", "));
    add_entry(key, target, help, type, choices);
}
void OptionSet::add(const std::string& key,
                    std::filesystem::path& target,
                    const std::string& help,
                    const std::string& implicit_value) {
    add_entry(key, target, help, "path");
    entries_.back().implicit_value = implicit_value;
}

void OptionSet::add_word_or_path(const std::string& key,
                                 std::string& target,
                                 const std::string& help,
                                 const std::vector<std::string>& words) {
    const std::string type = fmt::format("{} or a path", fmt::join(words, ", "));
    add_entry(key, target, help, type);
    entries_.back().read = [key, &target, words](TableReader& reader) {
        std::string text;
        reader.read(key, text);
        if (text.empty()) return;
        const bool is_word = std::find(words.begin(), words.end(), text) != words.end();
        target = is_word || std::filesystem::path(text).is_absolute()
                     ? text
                     : (reader.folder() / text).string();
    };
}

void OptionSet::add_own(const std::string& key,
                        const std::string& type_name,
                        const std::string& help,
                        std::function<bool(const std::string&)> parse,
                        std::function<std::string()> current) {
    Entry entry;
    entry.key = key;
    entry.help = help;
    entry.type_name = type_name;
    entry.default_value = current();
    entry.read = [](TableReader&) {};
    entry.parse = [type_name, parse = std::move(parse)](const std::string& text) -> Expected<void> {
        if (parse(text)) return {};
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("must be {}, got '{}'", type_name, text));
    };
    entries_.push_back(std::move(entry));
    current_.push_back(std::move(current));
}

void OptionSet::add_alias(const std::string& name) { entries_.back().alias = name; }

void OptionSet::refuse_empty(const std::string& advice) {
    Entry& entry = entries_.back();
    const std::string problem = "is empty: " + advice;
    entry.read = [key = entry.key, problem, read = std::move(entry.read)](TableReader& reader) {
        std::string text = "absent";
        reader.read(key, text);
        if (text.empty()) return reader.reject(key, problem);
        read(reader);
    };
    entry.parse = [problem,
                   parse = std::move(entry.parse)](const std::string& text) -> Expected<void> {
        if (text.empty()) return make_error(ErrorKind::kConfiguration, problem);
        return parse(text);
    };
}

void OptionSet::show(const std::string& key, std::function<std::string()> current) {
    std::string declared = current();
    shown_.push_back({key, std::move(current), std::move(declared)});
}

void OptionSet::read_file(TableReader& reader) const {
    for (const Entry& entry : entries_) entry.read(reader);
}

Expected<void> OptionSet::set(const std::string& key,
                              const std::string& text,
                              const std::string& source) const {
    for (const Entry& entry : entries_) {
        if (entry.key != key) continue;
        auto parsed = entry.parse(text);
        if (parsed) return {};
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: {}", source, parsed.error().message));
    }
    return make_error(ErrorKind::kConfiguration, fmt::format("{}: unknown option {}", source, key));
}

std::string OptionSet::effective() const {
    std::string text;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        text += fmt::format("{} = {}\n", entries_[i].key, current_[i]());
    }
    for (const Shown& shown : shown_) text += fmt::format("{} = {}\n", shown.key, shown.current());
    return text;
}

std::string OptionSet::changed(const std::set<std::string>& given) const {
    std::string text;
    const auto add = [&](const std::string& key, const std::string& now, const std::string& was) {
        if (now != was || given.contains(key)) text += fmt::format("{} = {}\n", key, now);
    };
    for (std::size_t i = 0; i < entries_.size(); ++i)
        add(entries_[i].key, current_[i](), entries_[i].default_value);
    for (const Shown& shown : shown_) add(shown.key, shown.current(), shown.declared);
    return text;
}

}  // namespace atrium::config
