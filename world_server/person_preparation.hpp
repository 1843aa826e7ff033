#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/physics/people/person_shape.hpp"

#include <functional>
#include <optional>
#include <string>

namespace atrium::world_server {

/// Turns the meshes of sites into shapes for the physics. Used by one thread.
class PersonPreparation {
public:
    using Result = Expected<std::optional<physics::PersonShape>>;
    /// Reads the meshes of one person of one site. Called by one thread at a time.
    using Reader = std::function<Result(const bus::SiteMesh&)>;
    /// Creates a reader without history. Called by the thread that calls `arrive` and `lose`.
    using MakeReader = std::function<Reader()>;

    virtual ~PersonPreparation() = default;
    virtual void arrive(const std::string& site, MakeReader make_reader) = 0;
    /// `arrive` must have been called for the site. `delays_from`: see bus::delays_from.
    virtual void put(bus::SiteMesh message, Timestamp delays_from) = 0;
    /// The person has left the site. Its next mesh is of a new person.
    virtual void lose(const std::string& site) = 0;
    virtual void leave(const std::string& site) = 0;
};

}  // namespace atrium::world_server
