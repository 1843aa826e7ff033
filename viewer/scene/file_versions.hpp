#pragma once

#include "core/base/fingerprint.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Compares the files that the viewer has read with those of the world's server, and tells which
/// ones to look at again: those that differ, each at most once a second. No disk access. Not
/// thread-safe.
class FileVersions {
public:
    using Clock = std::chrono::steady_clock;
    using Key = std::pair<std::string, double>;  // file, scale
    static constexpr std::chrono::seconds kPeriod{1};

    /// Fingerprints of at most `max_files` are kept: the names come from the network.
    explicit FileVersions(std::size_t max_files) : max_files_(max_files) {}

    /// The server's version of a file. An unknown one is ignored.
    void expect(const std::string& file, const Fingerprint& of_server);
    /// A file is being read or looked at. `end` must follow.
    void begin(const Key& key, Clock::time_point now);
    /// It has been read (`own`, unknown if it failed), or has not changed since (none). True if it
    /// is another version than the server's and this was not yet said of this version.
    bool end(const Key& key, const std::optional<Fingerprint>& own);
    /// Files to look at again; calls `begin` for each.
    std::vector<Key> take_due(Clock::time_point now);
    /// Whether the file is another version than the server's, also after a look since the server
    /// has this version: it may have been replaced here, too.
    bool is_different(const Key& key) const;
    std::size_t num_read() const { return files_.size(); }
    /// Drops everything except for what was said.
    void forget();

private:
    struct File {
        Fingerprint own;
        Fingerprint asked_for;        // the server's version when `begin` was last called
        Fingerprint compared_with;    // the one that `own` was last compared with
        Clock::time_point looked_at;  // when `begin` was last called
        bool is_reading = false;
    };
    Fingerprint expected(const std::string& file) const;
    void sort_in(const Key& key, const File& file);

    std::size_t max_files_;
    std::map<std::string, Fingerprint> expected_;
    std::map<Key, File> files_;
    std::set<Key> suspects_;  // other versions than the server's, and not readable ones
    std::set<std::pair<std::string, std::uint64_t>> said_;  // file, hash of the server's version
};

}  // namespace atrium::viewer
