#include "core/bus/builtin_topics.hpp"

#include <fmt/format.h>

#include <cctype>

namespace atrium::bus {

std::string property_of(const dds_qos_t* qos, const char* key) {
    char* value = nullptr;
    if (!dds_qget_prop(qos, key, &value) || value == nullptr) return {};
    std::string text = std::string(value).substr(0, 64);
    dds_free(value);
    for (char& c : text) c = std::isprint(static_cast<unsigned char>(c)) != 0 && c != '"' ? c : '?';
    return text;
}

std::string prefix_text(const dds_guid_t& guid) {
    std::string text;
    for (std::size_t i = 0; i < 12; ++i) text += fmt::format("{:02x}", guid.v[i]);
    return text;
}

std::string process_of(const dds_builtintopic_participant_t& participant) {
    const std::string host = property_of(participant.qos, "__Hostname");
    if (host.empty()) return {};
    return fmt::format("{} pid {}", host, property_of(participant.qos, "__Pid"));
}

}  // namespace atrium::bus
