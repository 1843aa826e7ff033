#include "viewer/scene/file_versions.hpp"

#include <limits>

namespace atrium::viewer {

void FileVersions::expect(const std::string& file, const Fingerprint& of_server) {
    if (!of_server.is_known()) return;
    if (expected_.size() >= max_files_ && !expected_.contains(file)) return;
    expected_[file] = of_server;
    const Key first(file, -std::numeric_limits<double>::infinity());
    for (auto known = files_.lower_bound(first); known != files_.end(); ++known) {
        if (known->first.first != file) break;
        sort_in(known->first, known->second);
    }
}

Fingerprint FileVersions::expected(const std::string& file) const {
    const auto found = expected_.find(file);
    return found == expected_.end() ? Fingerprint{} : found->second;
}

void FileVersions::sort_in(const Key& key, const File& file) {
    const Fingerprint of_server = expected(key.first);
    if (of_server.is_known() && file.own != of_server)
        suspects_.insert(key);
    else
        suspects_.erase(key);
}

void FileVersions::begin(const Key& key, Clock::time_point now) {
    File& file = files_[key];
    file.asked_for = expected(key.first);
    file.looked_at = now;
    file.is_reading = true;
}

bool FileVersions::end(const Key& key, const std::optional<Fingerprint>& own) {
    File& file = files_[key];
    file.is_reading = false;
    file.compared_with = file.asked_for;
    if (own) file.own = *own;
    sort_in(key, file);
    return is_different(key) && said_.size() < max_files_ &&
           said_.emplace(key.first, file.compared_with.hash).second;
}

std::vector<FileVersions::Key> FileVersions::take_due(Clock::time_point now) {
    std::vector<Key> due;
    for (const Key& key : suspects_) {
        const File& file = files_.at(key);
        if (file.is_reading || now - file.looked_at < kPeriod) continue;
        begin(key, now);
        due.push_back(key);
    }
    return due;
}

bool FileVersions::is_different(const Key& key) const {
    if (!suspects_.contains(key)) return false;
    const File& file = files_.at(key);
    return file.own.is_known() && file.compared_with == expected(key.first);
}

void FileVersions::forget() {
    expected_.clear();
    files_.clear();
    suspects_.clear();
}

}  // namespace atrium::viewer
