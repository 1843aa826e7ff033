#include "core/bus/cyclone_entities.h"

#include <dds/dds.h>
/* These need others before them. */
#include <dds/ddsi/ddsi_entity.h>
#include <dds/ddsi/q_hbcontrol.h>

#include <dds/ddsi/ddsi_domaingv.h>
#include <dds/ddsi/ddsi_endpoint.h>
#include <dds/ddsi/ddsi_entity_index.h>
#include <dds/ddsi/ddsi_proxy_endpoint.h>
#include <dds/ddsi/ddsi_proxy_participant.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/ddsi_xqos.h>
#include <dds/ddsi/q_bswap.h>
#include <dds/ddsi/q_thread.h>

#include <string.h>

int atrium_visit_writer_partitions(const struct ddsi_sertype* type,
                                   const struct ddsi_guid* writer,
                                   int (*visit)(void* argument, const char* partition),
                                   void* argument) {
    const struct ddsi_domaingv* domain = ddsrt_atomic_ldvoidp(&type->gv);
    if (domain == NULL) return 0;
    const struct dds_qos* qos = NULL;
    const struct ddsi_proxy_writer* remote =
        entidx_lookup_proxy_writer_guid(domain->entity_index, writer);
    if (remote != NULL) {
        qos = remote->c.xqos;
    } else {
        const struct ddsi_writer* local = entidx_lookup_writer_guid(domain->entity_index, writer);
        if (local == NULL) return 0;
        qos = local->xqos;
    }
    if ((qos->present & QP_PARTITION) == 0) return 1;
    for (uint32_t i = 0; i < qos->partition.n; ++i)
        if (visit(argument, qos->partition.strs[i]) != 0) break;
    return 1;
}

uint32_t atrium_domain_id(const struct ddsi_domaingv* domain) { return domain->config.domainId; }

void atrium_forget_participant(struct ddsi_domaingv* domain, const uint8_t* guid) {
    ddsi_guid_t on_wire;
    memcpy(&on_wire, guid, sizeof on_wire);
    const ddsi_guid_t key = nn_ntoh_guid(on_wire);
    struct thread_state* const thread = lookup_thread_state();
    thread_state_awake(thread, domain);
    ddsi_delete_proxy_participant_by_guid(domain, &key, ddsrt_time_wallclock(), 1);
    thread_state_asleep(thread);
}
