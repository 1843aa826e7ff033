#pragma once

#include "core/base/expected.hpp"
#include "core/presence/membership.hpp"

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

/// Presence of a program in its world: its unique name and the list of present programs.
namespace atrium::presence {

/// Logs the participant's network and its warnings, then joins the world and logs the events of the
/// membership. Fails as `Membership::join` does. `on_name_lost` is called on the membership's
/// thread (MembershipEvents::name_lost).
Expected<std::unique_ptr<Membership>> join_world(const bus::Participant& participant,
                                                 bus::ProgramKind kind,
                                                 const std::string& name,
                                                 std::function<void(const Error&)> on_name_lost,
                                                 std::stop_token stop = {});

}  // namespace atrium::presence
