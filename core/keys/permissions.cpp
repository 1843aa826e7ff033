#include "core/keys/permissions.hpp"

#include "core/keys/topics.hpp"

#include <pugixml.hpp>

#include <charconv>
#include <map>
#include <sstream>

namespace atrium::keys {
namespace {

using pugi::xml_node;

constexpr int kMaxDomainId = 230;  // Cyclone DDS refuses larger ones
constexpr const char* kSchemas = "https://www.omg.org/spec/DDS-SECURITY/20170901/";

xml_node new_document(pugi::xml_document& document, const std::string& schema) {
    xml_node declaration = document.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "utf-8";
    xml_node root = document.append_child("dds");
    root.append_attribute("xmlns:xsi") = "http://www.w3.org/2001/XMLSchema-instance";
    root.append_attribute("xsi:noNamespaceSchemaLocation") = (kSchemas + schema).c_str();
    return root;
}

xml_node add(xml_node parent, const char* name, const std::string& text) {
    xml_node child = parent.append_child(name);
    child.text() = text.c_str();
    return child;
}

void add_all_domains(xml_node parent) {
    xml_node range = parent.append_child("domains").append_child("id_range");
    add(range, "min", "0");
    add(range, "max", std::to_string(kMaxDomainId));
}

// One line per element and no indentation: peers send permissions to each other when they meet.
std::string text_of(const pugi::xml_document& document) {
    std::ostringstream out;
    document.save(out, "");
    return out.str();
}

using Partitions = std::vector<std::string>;

// DDS permits an endpoint only if one element allows its topic and all of its partitions: each
// topic stands in one element, with all its partitions.
void add_allowed(xml_node rule,
                 const char* direction,
                 const Member& member,
                 Partitions (*partitions_of)(const Member&, const Topic&)) {
    std::map<Partitions, std::vector<std::string_view>> topics_in;
    for (const Topic& topic : topics()) {
        if (Partitions partitions = partitions_of(member, topic); !partitions.empty())
            topics_in[std::move(partitions)].push_back(topic.name);
    }
    for (const auto& [partitions, names] : topics_in) {
        xml_node allowed = rule.append_child(direction);
        xml_node topic_list = allowed.append_child("topics");
        for (const std::string_view name : names) add(topic_list, "topic", std::string(name));
        xml_node partition_list = allowed.append_child("partitions");
        for (const std::string& partition : partitions) add(partition_list, "partition", partition);
    }
}

std::optional<Timestamp> parse_time(std::string_view text) {
    constexpr std::string_view kPattern = "0000-00-00T00:00:00Z";
    if (text.size() != kPattern.size()) return std::nullopt;
    const auto number = [&](std::size_t begin, std::size_t length) {
        int value = -1;
        const char* const end = text.data() + begin + length;
        const auto read = std::from_chars(text.data() + begin, end, value);
        return read.ec == std::errc() && read.ptr == end ? value : -1;
    };
    const std::chrono::year_month_day day{std::chrono::year(number(0, 4)),
                                          std::chrono::month(static_cast<unsigned>(number(5, 2))),
                                          std::chrono::day(static_cast<unsigned>(number(8, 2)))};
    // to 2261: nanoseconds fit; other mistakes show in the text that is made of the result
    if (!day.ok() || day.year() < std::chrono::year(1971) || day.year() > std::chrono::year(2261))
        return std::nullopt;
    const auto time = std::chrono::sys_days(day) + std::chrono::hours(number(11, 2)) +
                      std::chrono::minutes(number(14, 2)) + std::chrono::seconds(number(17, 2));
    const Timestamp parsed{
        std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count()};
    return time_text(parsed) == text ? std::optional(parsed) : std::nullopt;
}

}  // namespace

std::string governance_xml() {
    pugi::xml_document document;
    xml_node rule = new_document(document, "omg_shared_ca_governance.xsd")
                        .append_child("domain_access_rules")
                        .append_child("domain_rule");
    add_all_domains(rule);
    add(rule, "allow_unauthenticated_participants", "false");
    add(rule, "enable_join_access_control", "true");
    add(rule, "discovery_protection_kind", "NONE");
    add(rule, "liveliness_protection_kind", "NONE");
    // with origin authentication: else a member could forge samples of another
    add(rule, "rtps_protection_kind", "ENCRYPT_WITH_ORIGIN_AUTHENTICATION");
    xml_node topic = rule.append_child("topic_access_rules").append_child("topic_rule");
    add(topic, "topic_expression", "*");
    add(topic, "enable_discovery_protection", "false");
    add(topic, "enable_liveliness_protection", "false");
    add(topic, "enable_read_access_control", "true");
    add(topic, "enable_write_access_control", "true");
    add(topic, "metadata_protection_kind", "NONE");  // RTPS encrypts all of it already
    add(topic, "data_protection_kind", "NONE");
    return text_of(document);
}

std::string permissions_xml(const Member& member, Validity validity) {
    pugi::xml_document document;
    xml_node grant = new_document(document, "omg_shared_ca_permissions.xsd")
                         .append_child("permissions")
                         .append_child("grant");
    grant.append_attribute("name") = member.name.c_str();
    add(grant, "subject_name", subject_of(member));
    xml_node times = grant.append_child("validity");
    add(times, "not_before", time_text(validity.begin));
    add(times, "not_after", time_text(validity.end));
    xml_node rule = grant.append_child("allow_rule");
    add_all_domains(rule);
    add_allowed(rule, "publish", member, partitions_written);
    add_allowed(rule, "subscribe", member, partitions_read);
    add(grant, "default", "DENY");
    return text_of(document);
}

Expected<Validity> check_permissions_xml(std::string_view xml, const Member& member) {
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(xml.data(), xml.size());
    const xml_node grant = document.child("dds").child("permissions").child("grant");
    const auto begin = parse_time(grant.child("validity").child_value("not_before"));
    const auto end = parse_time(grant.child("validity").child_value("not_after"));
    if (!parsed || !begin || !end)
        return make_error(ErrorKind::kInvalidData, "the permissions have no validity");
    if (grant.child_value("subject_name") != subject_of(member))
        return make_error(ErrorKind::kInvalidData,
                          "the permissions are not those of " + describe(member));
    const Validity validity{*begin, *end};
    // the signed text may end in another way
    const auto trimmed = [](std::string_view text) {
        return text.substr(0, text.find_last_not_of('\n') + 1);
    };
    if (trimmed(permissions_xml(member, validity)) != trimmed(xml))
        return make_error(ErrorKind::kInvalidData,
                          "the permissions are not what this version of Atrium gives " +
                              describe(member) + " with the rights " + rights_text(member.rights));
    return validity;
}

}  // namespace atrium::keys
