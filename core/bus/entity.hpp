#pragma once

#include "core/base/expected.hpp"

#include <dds/dds.h>
#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace atrium::bus {

/// Owns one Cyclone DDS entity. Deleting it deletes its children.
class Entity {
public:
    Entity() = default;
    explicit Entity(dds_entity_t handle) : handle_(handle) {}
    Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
    Entity& operator=(Entity&& other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Entity() {
        if (handle_ > 0) dds_delete(handle_);
    }
    dds_entity_t get() const { return handle_; }

private:
    dds_entity_t handle_ = 0;
};

/// Takes ownership of the result of a dds_create_... function. Fails with kUnavailable if that is
/// an error; `what` names the entity in the message.
inline Expected<Entity> own(dds_entity_t handle, std::string_view what) {
    if (handle < 0) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("cannot create {}: {}", what, dds_strretcode(handle)));
    }
    return Entity(handle);
}

}  // namespace atrium::bus
