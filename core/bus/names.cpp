#include "core/bus/names.hpp"

#include "core/bus/limits.hpp"

#include <algorithm>

namespace atrium::bus {

bool is_valid_model_file(std::string_view file) {
    if (file.empty() || file.size() > kMaxModelFileLength) return false;
    bool begins_part = true;
    for (const char c : file) {
        if (c != '/' && !is_name_character(c)) return false;
        if (begins_part && (c == '/' || c == '.')) return false;
        begins_part = c == '/';
    }
    return !begins_part;
}

bool is_valid_line(std::string_view text) {
    return text.size() <= kMaxTextLength &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

std::string as_line(std::string text) {
    constexpr std::string_view kMore = "...";
    for (char& c : text)
        if (c < ' ' || c > '~') c = '?';
    if (text.size() <= kMaxTextLength) return text;
    const std::size_t end = text.rfind(' ', kMaxTextLength - kMore.size());
    text.resize(end == std::string::npos ? kMaxTextLength - kMore.size() : end);
    return text.append(kMore);
}

std::string host_program_name(const std::string& site, const std::string& host) {
    return site + "." + host;
}

const char* kind_name(ProgramKind kind) {
    switch (kind) {
        case ProgramKind::kSiteNode:
            return "site";
        case ProgramKind::kWorldServer:
            return "world server";
        case ProgramKind::kViewer:
            return "viewer";
        case ProgramKind::kCameraNode:
            return "camera node";
        case ProgramKind::kRegionNode:
            return "region node";
        default:
            return "program";
    }
}

}  // namespace atrium::bus
