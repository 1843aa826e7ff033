#include "core/bus/wire_fields.hpp"

namespace atrium::bus {

void to_wire(const StreamFeedback& message, WireScratch& /*scratch*/, atrium_StreamFeedback& out) {
    key_to_wire(message, out);
    out.time_ns = message.time.ns;
    out.newest_frame_id = message.newest_frame_id;
    out.num_complete = message.num_complete;
    out.num_incomplete = message.num_incomplete;
    out.num_late = message.num_late;
    out.num_samples = message.num_samples;
    out.payload_bytes_per_s = message.payload_bytes_per_s;
    out.min_delay_ms = message.min_delay_ms;
    out.sure_delay_ms = message.sure_delay_ms;
    out.median_delay_ms = message.median_delay_ms;
    out.longest_wait_ms = message.longest_wait_ms;
}

Expected<StreamFeedback> from_wire(const atrium_StreamFeedback& wire) {
    StreamFeedback message;
    message.viewer = get_name(wire.viewer);
    message.site = get_name(wire.site);
    message.time.ns = wire.time_ns;
    message.newest_frame_id = wire.newest_frame_id;
    message.num_complete = wire.num_complete;
    message.num_incomplete = wire.num_incomplete;
    message.num_late = wire.num_late;
    message.num_samples = wire.num_samples;
    message.payload_bytes_per_s = wire.payload_bytes_per_s;
    message.min_delay_ms = wire.min_delay_ms;
    message.sure_delay_ms = wire.sure_delay_ms;
    message.median_delay_ms = wire.median_delay_ms;
    message.longest_wait_ms = wire.longest_wait_ms;
    return checked(std::move(message));
}

void key_to_wire(const StreamFeedback& message, atrium_StreamFeedback& out) {
    put_name(message.viewer, out.viewer);
    put_name(message.site, out.site);
}

Expected<StreamFeedback> key_from_wire(const atrium_StreamFeedback& wire) {
    StreamFeedback key;
    key.viewer = get_name(wire.viewer);
    key.site = get_name(wire.site);
    if (!is_valid_name(key.viewer)) return make_error(ErrorKind::kInvalidData, "key: invalid name");
    return with_checked_name(std::move(key), key.site);
}

std::size_t payload_bytes(const StreamFeedback& message) {
    return message.viewer.size() + message.site.size() + 8 * sizeof(std::uint64_t) +
           4 * sizeof(std::uint32_t);
}

}  // namespace atrium::bus
