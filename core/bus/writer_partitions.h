/* Looks into Cyclone DDS from the thread that receives. C, because these headers of Cyclone are no C++. Private to core/bus. */
#ifndef ATRIUM_WRITER_PARTITIONS_H
#define ATRIUM_WRITER_PARTITIONS_H

#ifdef __cplusplus
extern "C" {
#endif

struct ddsi_sertype;
struct ddsi_guid;

/* Calls `visit` with each partition of a writer, in this process or another, until it returns nonzero. `type` is that of one of its
 * readers. Returns 0 if there is no such writer. Call it in a thread of Cyclone that holds no lock of an entity index: in `store` of a
 * reader's cache. */
int atrium_visit_writer_partitions(const struct ddsi_sertype* type,
                                   const struct ddsi_guid* writer,
                                   int (*visit)(void* argument, const char* partition),
                                   void* argument);

#ifdef __cplusplus
}
#endif
#endif
