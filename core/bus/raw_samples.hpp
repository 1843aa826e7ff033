#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/bus/bus.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Samples of any topic as bytes: what a recording holds.
///
/// The bytes are those of the network: CDR, little-endian, behind an encapsulation header of 4
/// bytes. Written again, a sample has the same bytes.
namespace atrium::bus {

enum class RawKind : std::uint8_t {
    kSample,
    kDisposed,  // the instance ended (Ending); of the sample's fields only those of the key count
    kLost,
};

struct RawSample {
    RawKind kind = RawKind::kSample;
    Timestamp written;  // by the writer's clock
    std::span<const std::byte> cdr;
};

/// As Reader, for bytes.
class RawReader {
public:
    virtual ~RawReader() = default;
    /// The bytes are valid during the call only.
    virtual TakeReport take(const std::function<void(const RawSample&)>& on_sample) = 0;
    virtual void add_to(Waiter& waiter) const = 0;
    virtual int num_writers() const = 0;
};

/// As Writer, for bytes.
class RawWriter {
public:
    virtual ~RawWriter() = default;
    /// Checks the bytes, which may be anyone's (kInvalidData), and writes them with `written` as
    /// the time of writing; or ends the instance.
    virtual Expected<void> write(const RawSample& sample) = 0;
    virtual int num_readers() const = 0;
};

/// A topic of a world; all are in `raw_topics`.
class RawTopic {
public:
    virtual ~RawTopic() = default;
    virtual std::string_view name() const = 0;       // "SiteMesh"
    virtual std::string_view type_name() const = 0;  // "atrium::SiteMesh"
    /// The class of its QoS: "description", "stream", "texture", "command" or "status".
    virtual std::string_view qos_class() const = 0;
    virtual Expected<std::unique_ptr<RawReader>> reader(const Participant& participant) const = 0;
    virtual Expected<std::unique_ptr<RawWriter>> writer(const Participant& participant) const = 0;
    /// The key fields as text, "alice/3": distinct for distinct instances. kInvalidData if the
    /// bytes are no sample of this topic.
    virtual Expected<std::string> key_of(const RawSample& sample) const = 0;
    /// A sample with only the key fields of `sample`, as for the end of its instance.
    virtual Expected<std::vector<std::byte>> key_cdr(const RawSample& sample) const = 0;
};

/// The topics that all programs of a world share. Those between the hosts of one site, which have
/// partitions of their own, are not among them.
std::span<const RawTopic* const> raw_topics();
/// nullptr: there is none of that name.
const RawTopic* find_raw_topic(std::string_view name);

/// The text of the .idl files, without preprocessor lines: the types of all topics.
extern const std::string_view kIdl;

template <typename Message>
std::string_view topic_name();
/// Checks as for a sample from the network. Of a sample that is not kSample only the key is read.
template <typename Message>
Expected<Message> from_raw(const RawSample& sample);
/// The message must pass `check`.
template <typename Message>
std::vector<std::byte> to_cdr(const Message& message);

}  // namespace atrium::bus
