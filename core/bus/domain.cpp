#include "core/bus/domain.hpp"

#include "core/bus/dds_log.hpp"
#include "core/bus/entity.hpp"

#include <map>
#include <mutex>

namespace atrium::bus {

namespace {

/// The open domains with their settings. Global, because Cyclone's table of domains is global to
/// the process; that table does not hold the settings.
struct Registry {
    struct OpenDomain {
        Entity entity;
        std::string network_xml;
        std::size_t num_shares = 0;
    };
    std::mutex mutex;  // held while a domain is opened or closed, to serialise the two
    std::map<std::uint32_t, OpenDomain> domains;
};

Registry& registry() {
    static Registry instance;
    return instance;
}

// Removes Cyclone's name for the settings from its messages. It names them after an environment
// variable, even if they do not come from there: "(CYCLONEDDS_URI+0 line 7)".
std::string without_uri_name(std::string text) {
    constexpr std::string_view kName = "CYCLONEDDS_URI+";
    for (auto at = text.find(kName); at != std::string::npos; at = text.find(kName, at))
        text.erase(at, text.find_first_not_of("0123456789 ", at + kName.size()) - at);
    return text;
}

tl::unexpected<Error> describe_failure(std::uint32_t id,
                                       dds_entity_t code,
                                       const std::string& source,
                                       const std::string& log) {
    const std::string text = log.empty() ? dds_strretcode(code) : log;
    if (code == DDS_RETCODE_PRECONDITION_NOT_MET) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("DDS domain {} was already opened in this process outside "
                                      "Atrium; choose another domain",
                                      id));
    }
    if (log.find("config:") != std::string::npos)
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: {}", source, without_uri_name(text)));
    return make_error(
        ErrorKind::kUnavailable,
        fmt::format("cannot open DDS domain {} with {} ({}). If its ports are in use, stop other "
                    "programs, raise MaxAutoParticipantIndex or choose another domain. If the "
                    "network card is missing, choose another with --interface",
                    id,
                    source,
                    text));
}

}  // namespace

Expected<Domain> Domain::open(std::uint32_t id,
                              const std::string& network_xml,
                              const std::string& source) {
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);
    if (const auto found = all.domains.find(id); found != all.domains.end()) {
        if (found->second.network_xml != network_xml) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("{}: DDS domain {} is already open in this process with other network "
                            "settings; use the same file or another domain",
                            source,
                            id));
        }
        ++found->second.num_shares;
        return Domain(id);
    }
    DdsLog::of_process().begin_capture();
    const dds_entity_t handle = dds_create_domain(id, network_xml.c_str());
    const std::string messages = DdsLog::of_process().end_capture();
    if (handle < 0) return describe_failure(id, handle, source, messages);
    if (!messages.empty()) DdsLog::of_process().add(messages);
    all.domains.emplace(id, Registry::OpenDomain{Entity(handle), network_xml, 1});
    return Domain(id);
}

Domain::~Domain() {
    if (!id_) return;
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);
    const auto found = all.domains.find(*id_);
    if (--found->second.num_shares == 0) all.domains.erase(found);
}

}  // namespace atrium::bus
