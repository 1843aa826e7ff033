#include "core/bus/dds_log.hpp"

#include "core/bus/authentication.hpp"

#include <dds/dds.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <utility>

namespace atrium::bus {
namespace {

constexpr std::size_t kMaxKinds = 64;  // limit on what untrusted senders can cause
constexpr std::size_t kMaxLength = 300;
constexpr std::chrono::minutes kPeriod{1};

std::string printable(std::string_view line) {
    std::string text(line.substr(0, kMaxLength));
    const auto end = text.find_last_not_of(" \n");
    text.resize(end == std::string::npos ? 0 : end + 1);
    for (char& c : text) c = std::isprint(static_cast<unsigned char>(c)) != 0 ? c : '?';
    return text;
}

// The address in "ddsi_udp_conn_write to udp/10.0.0.7:7432 failed with retcode -1".
std::string unreachable_address(std::string_view line) {
    constexpr std::string_view kBegin = "conn_write to udp/";
    const auto begin = line.find(kBegin);
    if (begin == std::string_view::npos || line.find("failed") == std::string_view::npos) return {};
    line.remove_prefix(begin + kBegin.size());
    return std::string(line.substr(0, line.find(':')));
}

// What authentication.cpp logs with the names of the peers.
bool is_told_better(std::string_view line) {
    return line.starts_with("Begin handshake re") || line.starts_with("Process handshake failed");
}

// Lines of one kind differ in numbers only.
std::string without_numbers(std::string_view line) {
    std::string kind;
    for (const char c : line) {
        const bool is_digit = std::isxdigit(static_cast<unsigned char>(c)) != 0;
        if (!is_digit) {
            kind += c;
        } else if (!kind.ends_with('#')) {
            kind += '#';
        }
    }
    return kind;
}

void take_line(void* log, const dds_log_data_t* data) {
    const std::string_view line(data->message, data->size);
    // Cyclone aborts the process after such a line
    if ((data->priority & DDS_LC_FATAL) != 0)
        std::fprintf(stderr, "dds: %s\n", printable(line).c_str());
    static_cast<DdsLog*>(log)->add(line);
}

}  // namespace

DdsLog& DdsLog::of_process() {
    // never destroyed: threads of Cyclone may log until the process ends
    static DdsLog* const log = [] {
        auto* made = new DdsLog;
        dds_set_log_sink(&take_line, made);
        return made;
    }();
    return *log;
}

void DdsLog::add(std::string_view line, Clock::time_point now) {
    const std::string text = printable(line);
    if (is_told_better(text)) return;
    const std::string name = proven_name_in(text);
    const std::lock_guard lock(mutex_);
    if (is_captured_) {
        if (!captured_.empty()) captured_ += "; ";
        captured_ += text;
        return;
    }
    const std::string address = unreachable_address(text);
    const std::string kind = address.empty() ? without_numbers(text) + name : address;
    const std::string from = name.empty() ? name : fmt::format(" from=\"{}\"", name);
    count(kind,
          address.empty() ? fmt::format("dds message=\"{}\"{}", text, from)
                          : fmt::format("peer_unreachable address={} no route from this host, or "
                                        "its network refuses: check --peers, --interface, cable "
                                        "and firewall (atrium doctor), with --join the tunnel "
                                        "(atrium tunnel status)",
                                        address),
          now);
}

void DdsLog::add(const std::string& kind, const std::string& line, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    count(kind, line, now);
}

void DdsLog::count(const std::string& kind, const std::string& line, Clock::time_point now) {
    const auto found = kinds_.find(kind);
    if (found == kinds_.end() && kinds_.size() >= kMaxKinds)
        std::erase_if(kinds_, [this](const auto& old) {
            return old.second.num_new == 0 && taken_ - old.second.logged >= kPeriod;
        });
    if (found == kinds_.end() && kinds_.size() >= kMaxKinds) {
        ++num_of_other_kinds_;
        return;
    }
    Kind& entry = kinds_[kind];
    ++entry.num_new;
    entry.added = now;
    if (entry.line.empty()) entry.line = line;
}

std::vector<std::string> DdsLog::take(Clock::time_point now) {
    std::vector<std::string> lines;
    const std::lock_guard lock(mutex_);
    taken_ = now;
    for (auto& [kind, entry] : kinds_) {
        const bool is_first = entry.logged == Clock::time_point{};
        if (entry.num_new == 0 || (!is_first && now - entry.logged < kPeriod)) continue;
        const std::size_t num = std::exchange(entry.num_new, 0);
        entry.logged = now;
        std::string line = entry.line;
        if (num > 1) line += fmt::format(" times={}", num);
        // held back, it may be about somebody who has left or was let in meanwhile
        const auto age = std::chrono::duration_cast<std::chrono::seconds>(now - entry.added);
        if (!is_first && age.count() > 0) line += fmt::format(" ago_s={}", age.count());
        lines.push_back(std::move(line));
    }
    if (const std::size_t num = std::exchange(num_of_other_kinds_, 0); num > 0)
        lines.push_back(fmt::format("dds further_messages={}", num));
    return lines;
}

void DdsLog::begin_capture() {
    const std::lock_guard lock(mutex_);
    is_captured_ = true;
    captured_.clear();
}

std::string DdsLog::end_capture() {
    const std::lock_guard lock(mutex_);
    is_captured_ = false;
    return std::exchange(captured_, {});
}

}  // namespace atrium::bus
