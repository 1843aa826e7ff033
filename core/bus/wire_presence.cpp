#include "core/bus/wire_fields.hpp"

namespace atrium::bus {

void to_wire(const Presence& message, WireScratch& /*scratch*/, atrium_Presence& out) {
    key_to_wire(message, out);
    out.is_holder = message.is_holder;
    out.num_written = message.num_written;
    put_name(message.host, out.host);
    out.pid = message.pid;
    put_name(message.version, out.version);
    out.start_time_ns = message.start_time.ns;
    out.is_clock_synchronised = message.is_clock_synchronised;
    out.clock_max_error_ns = message.clock_max_error.count();
}

Expected<Presence> from_wire(const atrium_Presence& wire) {
    Presence message;
    message.kind = static_cast<ProgramKind>(wire.kind);  // any octet; `check` rejects unknown ones
    message.name = get_name(wire.member);
    message.instance = wire.instance;
    message.is_holder = wire.is_holder;
    message.num_written = wire.num_written;
    message.host = get_name(wire.host);
    message.pid = wire.pid;
    message.version = get_name(wire.version);
    message.start_time.ns = wire.start_time_ns;
    message.is_clock_synchronised = wire.is_clock_synchronised;
    message.clock_max_error = std::chrono::nanoseconds(wire.clock_max_error_ns);
    return checked(std::move(message));
}

void key_to_wire(const Presence& message, atrium_Presence& out) {
    out.kind = static_cast<std::uint8_t>(message.kind);
    put_name(message.name, out.member);
    out.instance = message.instance;
}

Expected<Presence> key_from_wire(const atrium_Presence& wire) {
    Presence key;
    key.kind = static_cast<ProgramKind>(wire.kind);
    key.name = get_name(wire.member);
    key.instance = wire.instance;
    if (key.kind > ProgramKind::kOther)
        return make_error(ErrorKind::kInvalidData, "key: unknown program kind");
    return with_checked_name(std::move(key), key.name);
}

std::size_t payload_bytes(const Presence& message) {
    return message.name.size() + message.host.size() + message.version.size() +
           4 * sizeof(std::uint64_t) + sizeof(std::uint32_t) + 3;
}

}  // namespace atrium::bus
