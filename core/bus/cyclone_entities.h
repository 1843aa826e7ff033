/* What Cyclone DDS knows of the entities of other processes. C, because these headers of Cyclone are no C++. Private to core/bus. */
#ifndef ATRIUM_CYCLONE_ENTITIES_H
#define ATRIUM_CYCLONE_ENTITIES_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ddsi_domaingv;
struct ddsi_guid;
struct ddsi_sertype;

/* Calls `visit` with each partition of a writer, in this process or another, until it returns nonzero. `type` is that of one of its
 * readers. Returns 0 if there is no such writer. Call it in a thread of Cyclone that holds no lock of an entity index: in `store` of a
 * reader's cache. */
int atrium_visit_writer_partitions(const struct ddsi_sertype* type,
                                   const struct ddsi_guid* writer,
                                   int (*visit)(void* argument, const char* partition),
                                   void* argument);

/* The number of a domain. */
uint32_t atrium_domain_id(const struct ddsi_domaingv* domain);

/* Deletes what Cyclone knows of a participant of another process, as when its lease ends: its next announcement makes it a new one, with a
 * handshake of its own. Does nothing if there is none. `guid` has the 16 bytes of dds_guid_t. Not for threads of Cyclone. */
void atrium_forget_participant(struct ddsi_domaingv* domain, const uint8_t* guid);

#ifdef __cplusplus
}
#endif
#endif
