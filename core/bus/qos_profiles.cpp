#include "core/bus/qos_profiles.hpp"

#include "core/base/text_file.hpp"
#include "core/bus/builtin_files.hpp"
#include "core/bus/network_file.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <charconv>
#include <functional>
#include <limits>
#include <optional>
#include <set>

namespace atrium::bus {

namespace {

using Children = std::map<std::string_view, std::function<void(const pugi::xml_node&)>>;

/// Walks the document and records the first fault with its place.
class ProfileParser {
public:
    explicit ProfileParser(std::string source) : source_(std::move(source)) {}

    Expected<QosProfiles> parse(const pugi::xml_node& root) {
        allow_attributes(root, {"xmlns", "xmlns:xsi", "xsi:schemaLocation"});
        if (std::string_view(root.name()) != "dds")
            fail(root, "is the root, must be <dds>; a network file is given with --network");
        for_children(root, {{"qos_library", [&](auto& node) { read_library(node); }}});
        if (!fault_.empty()) return make_error(ErrorKind::kConfiguration, fault_);
        return profiles_;
    }

private:
    void read_library(const pugi::xml_node& library) {
        allow_attributes(library, {"name"});
        for_children(library, {{"qos_profile", [&](auto& node) { read_profile(node); }}});
    }

    void read_profile(const pugi::xml_node& node) {
        allow_attributes(node, {"name"});
        profile_name_ = node.attribute("name").value();
        QosProfile profile;
        for_children(node,
                     {{"datawriter_qos", [&](auto& qos) { read_writer(qos, profile.writer); }},
                      {"datareader_qos", [&](auto& qos) { read_reader(qos, profile.reader); }}});
        if (profile_name_.empty()) fail(node, "needs a name");
        if (!profiles_.emplace(profile_name_, profile).second) fail(node, "is defined twice");
        profile_name_.clear();
    }

    void read_writer(const pugi::xml_node& node, EndpointQos& qos) {
        Children policies = common_policies(qos);
        policies["durability_service"] = [&](auto& policy) { read_service(policy, qos); };
        policies["lifespan"] = [&](auto& policy) {
            qos.lifespan = read_only_duration(policy, "duration");
        };
        read_endpoint(node, qos, policies);
    }

    void read_reader(const pugi::xml_node& node, EndpointQos& qos) {
        read_endpoint(node, qos, common_policies(qos));
    }

    Children common_policies(EndpointQos& qos) {
        return {{"reliability", [&](auto& policy) { read_reliability(policy, qos); }},
                {"durability", [&](auto& policy) { read_durability(policy, qos); }},
                {"history", [&](auto& policy) { read_history(policy, qos); }},
                {"resource_limits", [&](auto& policy) { read_limits(policy, qos); }},
                {"liveliness", [&](auto& policy) { read_liveliness(policy, qos); }},
                {"deadline",
                 [&](auto& policy) { qos.deadline = read_only_duration(policy, "period"); }},
                {"latency_budget", [&](auto& policy) {
                     qos.latency_budget = read_only_duration(policy, "duration");
                 }}};
    }

    void read_endpoint(const pugi::xml_node& node, EndpointQos& qos, const Children& policies) {
        allow_attributes(node, {});
        for_children(node, policies);
        const ResourceLimits& limits = qos.limits;
        if (!qos.history.keep_all && limits.max_samples_per_instance != kUnlimited &&
            limits.max_samples_per_instance < qos.history.depth)
            fail(node, "max_samples_per_instance is smaller than the history depth");
        if (limits.max_samples != kUnlimited &&
            (limits.max_samples_per_instance == kUnlimited ||
             limits.max_samples < limits.max_samples_per_instance))
            fail(node, "max_samples is smaller than max_samples_per_instance");
    }

    void read_reliability(const pugi::xml_node& policy, EndpointQos& qos) {
        for_children(policy,
                     {{"kind",
                       [&](auto& node) {
                           qos.reliable = one_of(
                               node, "BEST_EFFORT_RELIABILITY_QOS", "RELIABLE_RELIABILITY_QOS");
                       }},
                      {"max_blocking_time",
                       [&](auto& node) { qos.max_blocking_time = read_duration(node); }}});
    }

    void read_durability(const pugi::xml_node& policy, EndpointQos& qos) {
        for_children(policy, {{"kind", [&](auto& node) {
                                   qos.transient_local = one_of(node,
                                                                "VOLATILE_DURABILITY_QOS",
                                                                "TRANSIENT_LOCAL_DURABILITY_QOS");
                               }}});
    }

    void read_service(const pugi::xml_node& policy, EndpointQos& qos) {
        History& history = qos.late_joiner_history;
        Children children = limits_children(qos.late_joiner_limits);
        children["history_kind"] = [&](auto& node) { history.keep_all = read_keep_all(node); };
        children["history_depth"] = [&](auto& node) { history.depth = read_positive(node); };
        for_children(policy, children);
    }

    void read_history(const pugi::xml_node& policy, EndpointQos& qos) {
        for_children(policy,
                     {{"kind", [&](auto& node) { qos.history.keep_all = read_keep_all(node); }},
                      {"depth", [&](auto& node) { qos.history.depth = read_positive(node); }}});
    }

    void read_limits(const pugi::xml_node& policy, EndpointQos& qos) {
        for_children(policy, limits_children(qos.limits));
    }

    void read_liveliness(const pugi::xml_node& policy, EndpointQos& qos) {
        for_children(policy,
                     {{"kind",
                       [&](auto& node) {
                           one_of(node, "AUTOMATIC_LIVELINESS_QOS", "AUTOMATIC_LIVELINESS_QOS");
                       }},
                      {"lease_duration", [&](auto& node) { qos.lease = read_duration(node); }}});
    }

    /// Reads a policy that has one duration only.
    std::chrono::nanoseconds read_only_duration(const pugi::xml_node& policy,
                                                std::string_view name) {
        std::chrono::nanoseconds value = kForever;
        bool is_there = false;
        for_children(policy, {{name, [&](auto& node) {
                                   value = read_duration(node);
                                   is_there = true;
                               }}});
        if (!is_there) fail(policy, fmt::format("needs a <{}>", name));
        return value;
    }

    Children limits_children(ResourceLimits& limits) {
        return {{"max_samples", [&](auto& node) { limits.max_samples = read_limit(node); }},
                {"max_instances", [&](auto& node) { limits.max_instances = read_limit(node); }},
                {"max_samples_per_instance",
                 [&](auto& node) { limits.max_samples_per_instance = read_limit(node); }}};
    }

    bool read_keep_all(const pugi::xml_node& node) {
        return one_of(node, "KEEP_LAST_HISTORY_QOS", "KEEP_ALL_HISTORY_QOS");
    }

    /// True for `yes`, false for `no`; fails for anything else.
    bool one_of(const pugi::xml_node& node, std::string_view no, std::string_view yes) {
        allow_attributes(node, {});
        const std::string_view value = node.text().get();
        if (value == yes) return true;
        if (value != no)
            fail(node, fmt::format("'{}' is not known here; allowed: {}, {}", value, no, yes));
        return false;
    }

    std::int32_t read_positive(const pugi::xml_node& node) {
        allow_attributes(node, {});
        const std::string_view text = node.text().get();
        std::int32_t value = 0;
        const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (status != std::errc() || end != text.data() + text.size() || value < 1)
            fail(node, fmt::format("'{}' is not an integer of at least 1", text));
        return value;
    }

    std::int32_t read_limit(const pugi::xml_node& node) {
        if (std::string_view(node.text().get()) == "LENGTH_UNLIMITED") return kUnlimited;
        return read_positive(node);
    }

    std::chrono::nanoseconds read_duration(const pugi::xml_node& duration) {
        std::int64_t seconds = 0;
        std::int64_t nanoseconds = 0;
        bool forever = false;
        const auto read = [&](const pugi::xml_node& node,
                              std::string_view infinity) -> std::int64_t {
            const std::string_view text = node.text().get();
            if (text == infinity) {
                forever = true;
                return 0;
            }
            return text == "0" ? 0 : read_positive(node);
        };
        for_children(
            duration,
            {{"sec", [&](auto& node) { seconds = read(node, "DURATION_INFINITE_SEC"); }},
             {"nanosec", [&](auto& node) { nanoseconds = read(node, "DURATION_INFINITE_NSEC"); }}});
        if (forever) return kForever;
        return std::chrono::seconds(seconds) + std::chrono::nanoseconds(nanoseconds);
    }

    /// Calls the function in `known` for each child element. A child without one is a fault.
    void for_children(const pugi::xml_node& parent, const Children& known) {
        std::set<std::string_view> seen;
        for (const pugi::xml_node& child : parent.children()) {
            const auto reader = known.find(child.name());
            if (reader == known.end()) {
                std::string allowed;
                for (const auto& [name, ignored] : known) allowed += fmt::format(" <{}>", name);
                fail(child,
                     fmt::format("is not known in <{}>; allowed:{}", parent.name(), allowed));
            } else if (is_policy(parent) && !seen.insert(child.name()).second) {
                fail(child, fmt::format("is given twice in <{}>", parent.name()));
            } else {
                reader->second(child);
            }
        }
    }

    /// True below a profile, where an element must not be repeated: the last would win silently.
    bool is_policy(const pugi::xml_node& parent) const {
        const std::string_view name = parent.name();
        return !profile_name_.empty() && name != "dds" && name != "qos_library";
    }

    void allow_attributes(const pugi::xml_node& node,
                          std::initializer_list<std::string_view> allowed) {
        for (const pugi::xml_attribute& attribute : node.attributes()) {
            if (std::find(allowed.begin(), allowed.end(), attribute.name()) == allowed.end())
                fail(node, fmt::format("the attribute '{}' is not known here", attribute.name()));
        }
    }

    void fail(const pugi::xml_node& node, std::string_view why) {
        if (!fault_.empty()) return;
        const std::string place =
            profile_name_.empty() ? std::string() : fmt::format(" profile '{}':", profile_name_);
        const std::string_view name = node.name();
        const std::string what =
            name.empty() ? fmt::format("text '{}'", node.value()) : fmt::format("<{}>", name);
        fault_ = fmt::format("{}:{} {} {}", source_, place, what, why);
    }

    std::string source_;
    std::string profile_name_;
    std::string fault_;
    QosProfiles profiles_;
};

}  // namespace

Expected<QosProfiles> parse_qos_profiles(std::string_view xml, const std::string& source) {
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_buffer(xml.data(), xml.size());
    if (!result) return malformed_xml(xml, source, result.description(), result.offset);
    auto profiles = ProfileParser(source).parse(document.document_element());
    if (!profiles) return profiles;
    if (auto fits = check_compatible(*profiles, source); !fits) return tl::unexpected(fits.error());
    return profiles;
}

Expected<QosProfiles> load_qos_profiles(const std::filesystem::path& file) {
    if (file.empty()) return parse_qos_profiles(kBuiltinProfiles, "built-in QoS profiles");
    const auto text = read_text_file(file);
    if (!text) return tl::unexpected(text.error());
    return parse_qos_profiles(*text, file.string());
}

}  // namespace atrium::bus
