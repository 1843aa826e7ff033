#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace atrium::doctor {

enum class Severity : std::uint8_t {
    kStops,  // Atrium does not start, or programs or cameras do not find each other
    kCosts,  // pictures come late, are lost or their latencies are unknown
    kNote,   // nothing is lost yet
};

/// One thing that is wrong on this host.
struct Finding {
    std::string id;  // of `known_findings`
    Severity severity = Severity::kNote;
    std::string text;  // one sentence, with the value found and the value wanted
    std::string cure;  // command line
    std::string keep;  // command line that keeps the cure over a restart; empty: it stays by itself
};

struct KnownFinding {
    const char* id;
    Severity severity;
};

/// All findings that the checks can make, in the order of the checks.
std::span<const KnownFinding> known_findings();

/// The finding `id`, with its severity. `id` is one of `known_findings`.
Finding make_finding(std::string id, std::string text, std::string cure, std::string keep = {});

const char* name_of(Severity severity);  // "stops", "costs", "note"

// Parts of command lines.
/// The word for a shell, in quotes if it needs them: names come from the system and may be hostile.
std::string shell_word(const std::string& word);
/// Adds a line to a file of root.
std::string write_line(const std::string& line, const std::string& file);
/// Sets a kernel setting until the next start, and the line that keeps it.
std::string set_sysctl(const std::string& name, const std::string& value);
std::string keep_sysctl(const std::string& name, const std::string& value);

std::string size_text(std::uint64_t bytes);  // "208 KiB", "16 MiB"

}  // namespace atrium::doctor
