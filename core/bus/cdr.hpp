#pragma once

#include "core/base/expected.hpp"

#include <dds/dds.h>

#include <cstddef>
#include <span>
#include <vector>

/// Wire structs to and from CDR bytes, by Cyclone's own code. Private to core/bus and its tests.
namespace atrium::bus {

/// CDR version 1, little-endian, with the encapsulation header. `wire` is a struct of the topic.
std::vector<std::byte> cdr_of(const dds_topic_descriptor_t& topic, const void* wire);

/// Fills `wire`, all zeros, from bytes of anyone. kInvalidData if they are no sample of the topic.
/// Free it with `free_wire`, also after an error.
Expected<void> wire_of(const dds_topic_descriptor_t& topic,
                       std::span<const std::byte> cdr,
                       void* wire);
void free_wire(const dds_topic_descriptor_t& topic, void* wire);

}  // namespace atrium::bus
