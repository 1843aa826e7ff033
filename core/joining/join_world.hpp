#pragma once

#include "core/base/expected.hpp"
#include "core/bus/membership.hpp"

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

/// How each program enters its world: between core/bus, which does not log, and core/app, which
/// knows no network.
namespace atrium::joining {

/// Logs how the participant is on the network, in one line, with a warning for each thing that is
/// wrong there; then joins as `bus::Membership::join` does, and logs what that has to say.
Expected<std::unique_ptr<bus::Membership>> join_world(
    const bus::Participant& participant,
    bus::ProgramKind kind,
    const std::string& name,
    std::function<void(const Error&)> on_name_lost,
    std::stop_token stop = {});

}  // namespace atrium::joining
