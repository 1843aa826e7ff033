#include "core/bus/participant.hpp"

#include "core/bus/bus_options.hpp"
#include "core/bus/dds_log.hpp"
#include "core/bus/key_watch.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "core/bus/network_settings.hpp"
#include "core/bus/topics.hpp"
#include "core/config/spelling.hpp"
#include "core/keys/topics.hpp"

#include <fmt/ranges.h>

#include <algorithm>

namespace atrium::bus {

namespace {

constexpr const char* kOnlyThisHost = " (this host only: --network lan for others)";

dds_duration_t to_dds(std::chrono::nanoseconds duration) {
    return duration == kForever ? DDS_INFINITY : duration.count();
}

dds_history_kind_t history_kind(const History& history) {
    return history.keep_all ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST;
}

QosPointer make_qos(const EndpointQos& qos) {
    QosPointer out(dds_create_qos());
    dds_qset_reliability(out.get(),
                         qos.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                         to_dds(qos.max_blocking_time));
    dds_qset_durability(
        out.get(), qos.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(out.get(), history_kind(qos.history), qos.history.depth);
    dds_qset_resource_limits(out.get(),
                             qos.limits.max_samples,
                             qos.limits.max_instances,
                             qos.limits.max_samples_per_instance);
    dds_qset_liveliness(out.get(), DDS_LIVELINESS_AUTOMATIC, to_dds(qos.lease));
    dds_qset_latency_budget(out.get(), to_dds(qos.latency_budget));
    return out;
}

Expected<void> check_options(const BusOptions& options) {
    if (!is_valid_name(options.world)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("world '{}': must have 1 to 63 characters of [A-Za-z0-9_.-]",
                                      options.world));
    }
    if (options.domain > kMaxDomain) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("domain {}: must be in 0..{}", options.domain, kMaxDomain));
    }
    return {};
}

Expected<void> check_profiles(const QosProfiles& profiles, const BusOptions& options) {
    for (const std::string_view name : kProfileNames) {
        if (!profiles.contains(name)) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format(
                    "{}: the profile '{}' is missing", options.profiles_file.string(), name));
        }
    }
    return {};
}

}  // namespace

QosPointer make_writer_qos(const EndpointQos& qos) {
    QosPointer out = make_qos(qos);
    dds_qset_lifespan(out.get(), to_dds(qos.lifespan));
    dds_qset_deadline(out.get(), to_dds(qos.deadline));
    // No autodispose: an instance with two writers must stay alive when one of them leaves.
    dds_qset_writer_data_lifecycle(out.get(), false);
    if (qos.transient_local) {
        dds_qset_durability_service(out.get(),
                                    0,
                                    history_kind(qos.late_joiner_history),
                                    qos.late_joiner_history.depth,
                                    qos.late_joiner_limits.max_samples,
                                    qos.late_joiner_limits.max_instances,
                                    qos.late_joiner_limits.max_samples_per_instance);
    }
    return out;
}

QosPointer partition_qos(const std::vector<std::string>& partitions) {
    QosPointer qos(dds_create_qos());
    std::vector<const char*> texts;
    for (const std::string& partition : partitions) texts.push_back(partition.c_str());
    dds_qset_partition(qos.get(), static_cast<std::uint32_t>(texts.size()), texts.data());
    return qos;
}

// Leaves out the deadline: after a missed deadline a reader of Cyclone DDS 0.10 is no longer told
// that the instance's writer has left. Reader counts missed deadlines itself (DeadlineCount).
QosPointer make_reader_qos(const EndpointQos& qos) { return make_qos(qos); }

Expected<std::vector<std::string>> Participant::Impl::partitions(std::string_view topic,
                                                                 const std::string& part,
                                                                 bool is_reader) const {
    if (!keys) return std::vector{part.empty() ? world : world + "/" + part};
    const keys::Member& member = keys->member;
    const keys::Topic* found = keys::find_topic(topic);
    auto allowed = found == nullptr ? std::vector<std::string>()
                   : is_reader      ? keys::partitions_read(member, *found)
                                    : keys::partitions_written(member, *found);
    if (allowed.empty() && found != nullptr && found->needs_right && !is_reader)
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("the keys of {} do not have the right {}: its owner runs `atrium keys "
                        "renew {} --rights {}` and exports it",
                        describe(member),
                        keys::rights_text({*found->needs_right}),
                        member.name,
                        keys::rights_text({*found->needs_right})));
    if (allowed.empty())
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("the keys of {} do not allow to {} {}",
                                      describe(member),
                                      is_reader ? "read" : "publish",
                                      topic));
    // of the parts of a site each endpoint has one
    if (!part.empty()) return std::vector{fmt::format("{}/part/{}", world, part)};
    return allowed;
}

Expected<Participant> Participant::create(const BusOptions& given) {
    BusOptions options = given;
    if (auto entered = enter_keys(options); !entered) return tl::unexpected(entered.error());
    if (auto result = check_options(options); !result) return tl::unexpected(result.error());
    auto profiles = load_qos_profiles(options.profiles_file);
    if (!profiles) return tl::unexpected(profiles.error());
    if (auto result = check_profiles(*profiles, options); !result)
        return tl::unexpected(result.error());
    const auto network = load_network_settings(options);
    if (!network) return tl::unexpected(network.error());
    auto domain = Domain::open(options.domain, network->xml, network->source);
    if (!domain) return tl::unexpected(domain.error());
    auto participant = own(dds_create_participant(options.domain, nullptr, nullptr),
                           "a participant; too many programs in this domain?");
    if (!participant) return tl::unexpected(participant.error());
    const QosPointer qos = partition_qos({options.world});
    auto publisher =
        own(dds_create_publisher(participant->get(), qos.get(), nullptr), "a publisher");
    if (!publisher) return tl::unexpected(publisher.error());
    auto subscriber =
        own(dds_create_subscriber(participant->get(), qos.get(), nullptr), "a subscriber");
    if (!subscriber) return tl::unexpected(subscriber.error());
    auto peers = PeerWatch::create(participant->get(), options.world, options.keys != nullptr);
    if (!peers) return tl::unexpected(peers.error());
    Participant made(std::shared_ptr<Impl>(
        new Impl{std::move(*domain),
                 std::move(*profiles),
                 report_network(*network),
                 options.world,
                 fmt::format("world={} domain={} network={}{}{}",
                             options.world,
                             options.domain,
                             options.network,
                             options.network == "loopback" ? kOnlyThisHost : "",
                             options.join.empty() ? "" : " tunnel=\"atrium tunnel status\""),
                 std::move(*participant),
                 std::move(*publisher),
                 std::move(*subscriber),
                 std::move(*peers),
                 options.keys}));
    if (options.keys) {
        auto watch = KeyWatch::start(made, options.security, options.keys);
        if (!watch) return tl::unexpected(watch.error());
        made.key_watch_ = std::move(*watch);
    }
    return made;
}

const keys::Member* Participant::member() const {
    return impl_->keys ? &impl_->keys->member : nullptr;
}

const NetworkReport& Participant::network() const { return impl_->network; }

std::vector<std::string> Participant::take_mismatches() const {
    return impl_->peers.take_mismatches();
}

std::vector<std::string> Participant::take_dds_log() const {
    return DdsLog::of_process().take(DdsLog::Clock::now());
}

OtherWorlds Participant::other_worlds() const {
    OtherWorlds others{impl_->peers.other_worlds(), {}};
    others.meant = config::names_meant_by(impl_->world, others.heard);
    return others;
}

std::string Participant::place() const {
    const auto [others, meant] = other_worlds();
    if (others.empty()) return impl_->place;
    return fmt::format("{} other_worlds={}{}{}",
                       impl_->place,
                       fmt::join(others, ","),
                       meant.empty() ? "" : " did_you_mean=",
                       fmt::join(meant, ","));
}

}  // namespace atrium::bus
