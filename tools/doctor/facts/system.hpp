#pragma once

#include "core/base/expected.hpp"
#include "core/base/run_command.hpp"
#include "core/base/timestamp.hpp"
#include "tools/doctor/facts/facts.hpp"

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::doctor {

/// The host that is examined: its files below `root`, and what only a running system answers.
///
/// The base class knows only files, for a copy of a host's /proc, /sys, /dev and /etc: all else is
/// unknown. Names of files are absolute, as on the host.
class System {
public:
    explicit System(std::filesystem::path root) : root_(std::move(root)) {}
    virtual ~System() = default;
    System(const System&) = delete;
    System& operator=(const System&) = delete;

    /// The content of a file, at most its first MiB; nullopt if it cannot be read.
    std::optional<std::string> read(const std::string& file) const;
    /// The content without the white space around it.
    std::optional<std::string> read_word(const std::string& file) const;
    /// A whole number; nullopt for anything else.
    std::optional<std::uint64_t> read_number(const std::string& file) const;
    /// The names in a folder, sorted, at most 4096; none if it cannot be read.
    std::vector<std::string> names_in(const std::string& folder) const;
    bool exists(const std::string& file) const { return status_of(file).has_value(); }
    std::optional<struct stat> status_of(const std::string& file) const;
    std::filesystem::path at(const std::string& file) const;

    using Output = CommandOutput;
    /// Runs a program for at most ten seconds. nullopt: not on this system.
    virtual std::optional<Output> run(const std::vector<std::string>& command) const;

    /// nullopt: unknown.
    virtual std::optional<std::vector<CardAddress>> card_addresses() const;
    /// Whether this process sees the card: /sys may be that of another network namespace.
    virtual bool has_card(const std::string& name) const;
    struct Clock {
        bool is_synchronised = false;
        double max_error_ms = 0.0;
    };
    virtual std::optional<Clock> clock() const;
    virtual User user() const;
    /// Whether this user may read and write a file; true if it is not there. The base class knows
    /// only owner and mode, no lists of access.
    virtual bool may_open(const std::string& file) const;
    /// The capabilities that a program file gives its process, one bit each.
    virtual std::optional<std::uint64_t> file_capabilities(const std::filesystem::path& file) const;
    /// Whether a datagram to 239.255.0.1 that leaves by the card with this address is heard on this
    /// host. It has a time to live of 0: no other host gets it.
    virtual std::optional<bool> hears_multicast(std::uint32_t card_address) const;
    /// Writes `bytes` to a file in the folder and to its disk, and removes it. Returns the speed
    /// [MB/s] or why it cannot.
    virtual Expected<double> write_speed(const std::filesystem::path& folder,
                                         std::uint64_t bytes) const;
    virtual std::optional<std::uint64_t> free_bytes(const std::filesystem::path& folder) const;
    /// Lets a second pass, over which counters are compared. Returns false if they cannot change.
    virtual bool let_time_pass() const;
    virtual Timestamp now() const { return Timestamp::now(); }
    virtual std::string variable(const std::string& name) const;  // of the environment

private:
    std::filesystem::path root_;
};

/// This host.
class LiveSystem : public System {
public:
    explicit LiveSystem(std::filesystem::path root = "/") : System(std::move(root)) {}
    std::optional<Output> run(const std::vector<std::string>& command) const override;
    std::optional<std::vector<CardAddress>> card_addresses() const override;
    bool has_card(const std::string& name) const override;
    std::optional<Clock> clock() const override;
    User user() const override;
    bool may_open(const std::string& file) const override;
    std::optional<std::uint64_t> file_capabilities(
        const std::filesystem::path& file) const override;
    std::optional<bool> hears_multicast(std::uint32_t card_address) const override;
    Expected<double> write_speed(const std::filesystem::path& folder,
                                 std::uint64_t bytes) const override;
    std::optional<std::uint64_t> free_bytes(const std::filesystem::path& folder) const override;
    bool let_time_pass() const override;
    std::string variable(const std::string& name) const override;
};

/// Whether the user may read and write a file with this owner and mode.
bool may_use(const struct stat& status, const User& user);

// Parsing of the texts of a kernel. Each accepts anything.
std::optional<std::uint64_t> parse_number(const std::string& text);
std::vector<std::string> lines_of(const std::string& text);
std::vector<std::string> words_of(const std::string& text);

}  // namespace atrium::doctor
