#include "tools/doctor/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

namespace atrium::doctor {
namespace {

constexpr std::size_t kIndent = 7;  // of sentences
constexpr const char* kCommandIndent = "           ";
constexpr const char* kBold = "\033[1m";
constexpr const char* kDim = "\033[2m";
constexpr const char* kCyan = "\033[36m";
constexpr const char* kEnd = "\033[0m";

const char* colour_of(Severity severity) {
    constexpr std::array kColours{"\033[1;31m", "\033[33m", "\033[2m"};
    return kColours[static_cast<std::size_t>(severity)];
}

// Bytes of the letter in UTF-8 at the begin of the text; 0: it is wrong or controls a terminal or
// the direction of text.
std::size_t bytes_of_letter(std::string_view text) {
    const auto byte = [&](std::size_t i) {
        return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
    };
    const std::uint32_t first = byte(0);
    if (first < 0x80) return first >= ' ' && first <= '~' ? 1 : 0;
    const std::size_t num_bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
    if (num_bytes == 0 || first > 0xF4 || text.size() < num_bytes) return 0;
    std::uint32_t code = first & (0x7FU >> num_bytes);
    for (std::size_t i = 1; i < num_bytes; ++i) {
        if ((byte(i) & 0xC0U) != 0x80U) return 0;
        code = code << 6U | (byte(i) & 0x3FU);
    }
    constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0xA0, 0x800, 0x10000};
    const bool is_control = (code >= 0x200B && code <= 0x200F) ||
                            (code >= 0x2028 && code <= 0x202E) ||
                            (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF;
    const bool is_wrong = (code >= 0xD800 && code <= 0xDFFF) || code > 0x10FFFF;
    return code < kLeast[num_bytes] || is_control || is_wrong ? 0 : num_bytes;
}

// Names come from the system: none may send commands to a terminal.
std::string printable(const std::string& text) {
    std::string shown;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t num_bytes = bytes_of_letter(std::string_view(text).substr(at));
        shown += num_bytes == 0 ? "?" : text.substr(at, num_bytes);
        at += std::max<std::size_t>(1, num_bytes);
    }
    return shown;
}

class Page {
public:
    explicit Page(const TextStyle& style) : style_(style) {}

    void add(const std::string& text, const char* colour = nullptr) {
        text_ += coloured(text, colour) + '\n';
    }
    std::string coloured(const std::string& text, const char* colour) const {
        if (!style_.has_colour || colour == nullptr || text.empty()) return text;
        return colour + text + kEnd;
    }
    // Adds a sentence behind a head of `kIndent` columns, wrapped.
    void add_sentence(const std::string& head, const char* colour, const std::string& sentence) {
        std::string line;
        bool is_first = true;
        const auto end_line = [&] {
            text_ += is_first ? coloured(head, colour) + std::string(kIndent - head.size(), ' ')
                              : std::string(kIndent, ' ');
            text_ += line + '\n';
            is_first = false;
            line.clear();
        };
        std::istringstream words(sentence);
        for (std::string word; words >> word;) {
            if (!line.empty() && kIndent + line.size() + 1 + word.size() > style_.width) end_line();
            line += (line.empty() ? "" : " ") + word;
        }
        end_line();
    }
    std::string take() { return std::move(text_); }

private:
    const TextStyle& style_;
    std::string text_;
};

std::string summary(std::span<const Finding> findings) {
    std::array<std::size_t, 3> counts{};
    for (const Finding& finding : findings) ++counts[static_cast<std::size_t>(finding.severity)];
    const auto part = [](std::size_t count, const char* one, const char* more) {
        return count == 0 ? std::string() : fmt::format("{} {}", count, count == 1 ? one : more);
    };
    std::string text;
    for (const std::string& next : {part(counts[0], "stops Atrium", "stop Atrium"),
                                    part(counts[1], "costs pictures", "cost pictures"),
                                    part(counts[2], "note", "notes")}) {
        if (!next.empty()) text += (text.empty() ? "" : ", ") + next;
    }
    return text + ".";
}

}  // namespace

std::string report_text(std::span<const Finding> findings,
                        const std::vector<Checked>& checked,
                        const TextStyle& style) {
    Page page(style);
    if (style.shows_checked) {
        std::size_t width = 0;
        for (const Checked& one : checked) width = std::max(width, one.what.size());
        for (const Checked& one : checked)
            page.add(fmt::format("{:<{}}  {}", printable(one.what), width, printable(one.value)));
        page.add("");
    }
    for (const Finding& finding : findings) {
        page.add_sentence(name_of(finding.severity),
                          colour_of(finding.severity),
                          printable(finding.text) + " [" + finding.id + "]");
        page.add(kCommandIndent + printable(finding.cure), kCyan);
        if (finding.keep.empty()) continue;
        page.add(std::string(kIndent, ' ') + "to keep it after a restart:", kDim);
        page.add(kCommandIndent + printable(finding.keep), kCyan);
    }
    if (!findings.empty()) {
        page.add("");
        page.add(summary(findings), kBold);
        page.add("Run the commands, then atrium doctor again.");
    } else if (style.says_healthy) {
        page.add("Nothing is wrong on this host. --verbose lists what was checked.");
    }
    return page.take();
}

bool is_ill(std::span<const Finding> findings) {
    return std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
        return finding.severity != Severity::kNote;
    });
}

std::vector<std::string> names_of(const Roles& roles) {
    std::vector<std::string> names;
    if (roles.site) names.emplace_back("site");
    if (roles.world) names.emplace_back("world");
    if (roles.viewer) names.emplace_back("viewer");
    if (roles.camera) names.emplace_back("camera");
    return names;
}

}  // namespace atrium::doctor
