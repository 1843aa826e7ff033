#include "tools/doctor/facts/system.hpp"

#include "core/base/descriptor.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <sstream>

namespace atrium::doctor {
namespace {

constexpr std::size_t kMaxBytes = 1U << 20U;
constexpr std::size_t kMaxNames = 4096;

std::string trimmed(const std::string& text) {
    constexpr const char* kSpace = " \t\r\n";
    const auto begin = text.find_first_not_of(kSpace);
    if (begin == std::string::npos) return "";
    return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

}  // namespace

bool may_use(const struct stat& status, const User& user) {
    if (user.is_root) return true;
    if (status.st_uid == user.id) return (status.st_mode & S_IRUSR) && (status.st_mode & S_IWUSR);
    if (std::find(user.groups.begin(), user.groups.end(), status.st_gid) != user.groups.end())
        return (status.st_mode & S_IRGRP) && (status.st_mode & S_IWGRP);
    return (status.st_mode & S_IROTH) && (status.st_mode & S_IWOTH);
}

std::optional<std::uint64_t> parse_number(const std::string& text) {
    const std::string word = trimmed(text);
    std::uint64_t number = 0;
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (failure != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return number;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(std::move(line));
    return lines;
}

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words;
    std::istringstream stream(text);
    for (std::string word; stream >> word;) words.push_back(std::move(word));
    return words;
}

std::filesystem::path System::at(const std::string& file) const {
    return root_ / std::filesystem::path(file).relative_path();
}

std::optional<std::string> System::read(const std::string& file) const {
    // O_NONBLOCK: a pipe without a writer must not hold up
    const Descriptor opened(open(at(file).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (opened.get() < 0) return std::nullopt;
    std::string text;
    std::array<char, 16384> part;
    while (text.size() < kMaxBytes) {
        const ssize_t num_bytes = ::read(opened.get(), part.data(), part.size());
        if (num_bytes < 0 && errno == EINTR) continue;
        if (num_bytes < 0) return std::nullopt;
        if (num_bytes == 0) break;
        text.append(part.data(), static_cast<std::size_t>(num_bytes));
    }
    return text;
}

std::optional<std::string> System::read_word(const std::string& file) const {
    const auto text = read(file);
    return text ? std::optional(trimmed(*text)) : std::nullopt;
}

std::optional<std::uint64_t> System::read_number(const std::string& file) const {
    const auto text = read(file);
    return text ? parse_number(*text) : std::nullopt;
}

std::vector<std::string> System::names_in(const std::string& folder) const {
    std::vector<std::string> names;
    const std::unique_ptr<DIR, int (*)(DIR*)> opened(opendir(at(folder).c_str()), &closedir);
    if (opened == nullptr) return names;
    while (const dirent* entry = readdir(opened.get())) {
        const std::string name = entry->d_name;
        if (name == "." || name == "..") continue;
        names.push_back(name);
        if (names.size() >= kMaxNames) break;
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::optional<struct stat> System::status_of(const std::string& file) const {
    struct stat status {};
    if (stat(at(file).c_str(), &status) != 0) return std::nullopt;
    return status;
}

std::optional<System::Output> System::run(const std::vector<std::string>& /*command*/) const {
    return std::nullopt;
}
std::optional<std::vector<CardAddress>> System::card_addresses() const { return std::nullopt; }
bool System::has_card(const std::string& /*name*/) const { return true; }
std::optional<System::Clock> System::clock() const { return std::nullopt; }
User System::user() const { return {.name = "root", .is_root = true, .groups = {}}; }
bool System::may_open(const std::string& file) const {
    const auto status = status_of(file);
    return !status || may_use(*status, user());
}
std::optional<std::uint64_t> System::file_capabilities(
    const std::filesystem::path& /*file*/) const {
    return std::nullopt;
}
std::optional<bool> System::hears_multicast(std::uint32_t /*card_address*/) const {
    return std::nullopt;
}
Expected<double> System::write_speed(const std::filesystem::path& /*folder*/,
                                     std::uint64_t /*bytes*/) const {
    return 0.0;
}
std::optional<std::uint64_t> System::free_bytes(const std::filesystem::path& /*folder*/) const {
    return std::nullopt;
}
bool System::let_time_pass() const { return false; }
std::string System::variable(const std::string& /*name*/) const { return ""; }

}  // namespace atrium::doctor
