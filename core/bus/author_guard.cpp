#include "core/bus/author_guard.hpp"

#include "core/bus/cyclone_entities.h"
#include "core/bus/dds_log.hpp"

#include <dds/ddsc/dds_rhc.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_tkmap.h>

#include <cstring>
#include <utility>
#include <vector>

// Exported by Cyclone, but in none of its installed headers.
extern "C" dds_rhc* dds_rhc_default_new(dds_reader* reader, const ddsi_sertype* type);

namespace atrium::bus {
namespace {

constexpr std::size_t kMaxAuthors = 4096;

/// A cache of Cyclone's behind a check. Cyclone calls `store` in its receiving threads.
struct GuardedCache : dds_rhc {
    std::shared_ptr<Authors> authors;
    ClaimOfKey claim_of_key = nullptr;
    std::vector<std::max_align_t> wire;  // room for one struct of the topic
    std::mutex mutex;                    // guards `wire`
    const ddsi_sertype* type = nullptr;
    dds_rhc* inner = nullptr;
};

GuardedCache& guarded(dds_rhc* cache) { return *static_cast<GuardedCache*>(cache); }
// Both views of a cache begin with its table of functions.
GuardedCache& guarded(ddsi_rhc* cache) { return guarded(reinterpret_cast<dds_rhc*>(cache)); }

std::optional<keys::PartitionAuthor> author_of_writer(const GuardedCache& cache,
                                                      const ddsi_writer_info& writer) {
    if (auto known = cache.authors->find(writer.iid)) return known;
    struct Found {
        const std::string& world;
        std::optional<keys::PartitionAuthor> author;
    } found{cache.authors->world(), std::nullopt};
    // Permissions let all partitions of a writer have the same name in them.
    const auto visit = [](void* argument, const char* partition) -> int {
        auto& to = *static_cast<Found*>(argument);
        to.author = keys::author_of_partition(partition, to.world);
        return to.author ? 0 : 1;
    };
    atrium_visit_writer_partitions(cache.type, &writer.guid, visit, &found);
    if (found.author) cache.authors->add(writer.iid, *found.author);
    return found.author;
}

std::optional<Claim> claim_of_instance(GuardedCache& cache, const ddsi_tkmap_instance& instance) {
    const std::lock_guard lock(cache.mutex);
    void* wire = cache.wire.data();
    std::memset(wire, 0, cache.wire.size() * sizeof cache.wire.front());
    if (!ddsi_serdata_untyped_to_sample(cache.type, instance.m_sample, wire, nullptr, nullptr))
        return std::nullopt;
    auto claim = cache.claim_of_key(wire);
    ddsi_sertype_free_sample(cache.type, wire, DDS_FREE_CONTENTS);
    return claim;
}

void log_refusal(const GuardedCache& cache,
                 const std::optional<keys::PartitionAuthor>& author,
                 const std::optional<Claim>& claim) {
    const std::string who =
        !author
            ? "a writer that has left"
            : fmt::format(
                  "{} {}", author->kind ? keys::kind_text(*author->kind) : "member", author->name);
    const std::string& topic = cache.authors->topic();
    DdsLog::of_process().add(
        fmt::format("refused {} {}", topic, who),
        fmt::format("refused topic={} from=\"{}\" reason=\"its samples are of {}: a member may "
                    "publish only in its own name; revoke its key if it goes on\"",
                    topic,
                    who,
                    claim ? "'" + claim->name + "'" : "nobody"));
}

bool store(ddsi_rhc* base,
           const ddsi_writer_info* writer,
           ddsi_serdata* sample,
           ddsi_tkmap_instance* instance) {
    GuardedCache& cache = guarded(base);
    const auto author = author_of_writer(cache, *writer);
    const auto claim = claim_of_instance(cache, *instance);
    if (author && claim && may_write(*author, *claim))
        return dds_rhc_store(cache.inner, writer, sample, instance);
    log_refusal(cache, author, claim);
    return true;  // done with: false would ask for it again
}

void unregister_writer(ddsi_rhc* base, const ddsi_writer_info* writer) {
    dds_rhc_unregister_wr(guarded(base).inner, writer);
}

void relinquish_ownership(ddsi_rhc* base, std::uint64_t writer) {
    dds_rhc_relinquish_ownership(guarded(base).inner, writer);
}

void set_qos(ddsi_rhc* base, const dds_qos* qos) { dds_rhc_set_qos(guarded(base).inner, qos); }

void free_cache(ddsi_rhc* base) {
    GuardedCache* cache = &guarded(base);
    if (cache->inner != nullptr) dds_rhc_free(cache->inner);
    delete cache;
}

template <auto kForward>
std::int32_t forward_read(dds_rhc* cache,
                          bool lock,
                          void** values,
                          dds_sample_info_t* infos,
                          std::uint32_t max,
                          std::uint32_t mask,
                          dds_instance_handle_t instance,
                          dds_readcond* condition) {
    return kForward(guarded(cache).inner, lock, values, infos, max, mask, instance, condition);
}

template <auto kForward>
std::int32_t forward_read_cdr(dds_rhc* cache,
                              bool lock,
                              ddsi_serdata** values,
                              dds_sample_info_t* infos,
                              std::uint32_t max,
                              std::uint32_t samples,
                              std::uint32_t views,
                              std::uint32_t instances,
                              dds_instance_handle_t instance) {
    return kForward(
        guarded(cache).inner, lock, values, infos, max, samples, views, instances, instance);
}

bool add_condition(dds_rhc* cache, dds_readcond* condition) {
    return dds_rhc_add_readcondition(guarded(cache).inner, condition);
}

void remove_condition(dds_rhc* cache, dds_readcond* condition) {
    dds_rhc_remove_readcondition(guarded(cache).inner, condition);
}

std::uint32_t lock_samples(dds_rhc* cache) { return dds_rhc_lock_samples(guarded(cache).inner); }

dds_return_t associate(dds_rhc* base,
                       dds_reader* reader,
                       const ddsi_sertype* type,
                       ddsi_tkmap* instances) {
    GuardedCache& cache = guarded(base);
    cache.type = type;
    cache.inner = dds_rhc_default_new(reader, type);
    return dds_rhc_associate(cache.inner, reader, type, instances);
}

constexpr dds_rhc_ops kGuardedOps{
    {store, unregister_writer, relinquish_ownership, set_qos, free_cache},
    forward_read<dds_rhc_read>,
    forward_read<dds_rhc_take>,
    forward_read_cdr<dds_rhc_readcdr>,
    forward_read_cdr<dds_rhc_takecdr>,
    add_condition,
    remove_condition,
    lock_samples,
    associate};

}  // namespace

bool may_write(const keys::PartitionAuthor& author, const Claim& claim) {
    if (claim.kind && author.kind != claim.kind) return false;
    if (claim.name == author.name) return true;
    // The programs on the hosts of a site. Of other kinds NAME.SUFFIX can be another member.
    if (author.kind != keys::Kind::kSite) return false;
    return claim.name.size() > author.name.size() && claim.name.starts_with(author.name) &&
           claim.name[author.name.size()] == '.';
}

keys::Kind key_kind(ProgramKind kind) {
    switch (kind) {
        case ProgramKind::kWorldServer:
            return keys::Kind::kWorld;
        case ProgramKind::kViewer:
            return keys::Kind::kViewer;
        case ProgramKind::kOther:
            return keys::Kind::kMonitor;
        default:
            return keys::Kind::kSite;
    }
}

std::optional<keys::PartitionAuthor> Authors::find(dds_instance_handle_t writer) const {
    const std::lock_guard lock(mutex_);
    const auto found = authors_.find(writer);
    return found == authors_.end() ? std::nullopt : std::optional(found->second);
}

void Authors::add(dds_instance_handle_t writer, keys::PartitionAuthor author) {
    // Those who have left stay: their last samples may not be taken yet. Handles are never reused,
    // and those who are there are found again.
    const std::lock_guard lock(mutex_);
    if (authors_.size() >= kMaxAuthors) authors_.clear();
    authors_.insert_or_assign(writer, std::move(author));
}

Expected<Entity> create_guarded_reader(dds_entity_t subscriber,
                                       dds_entity_t topic,
                                       const dds_qos_t* qos,
                                       std::shared_ptr<Authors> authors,
                                       ClaimOfKey claim_of_key,
                                       std::size_t wire_bytes) {
    auto cache = std::make_unique<GuardedCache>();
    cache->common.ops = &kGuardedOps;
    cache->authors = std::move(authors);
    cache->claim_of_key = claim_of_key;
    cache->wire.resize(wire_bytes / sizeof(std::max_align_t) + 1);
    const std::string what = "a reader of " + cache->authors->topic();
    auto reader = own(dds_create_reader_rhc(subscriber, topic, qos, nullptr, cache.get()), what);
    if (reader) cache.release();  // the reader owns it
    return reader;
}

}  // namespace atrium::bus
