#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace atrium::bus {

/// Shares a DDS domain within this process. The last owner closes it.
class Domain {
public:
    /// Joins the open domain, or opens it with the settings `network_xml`; `source` names them in
    /// errors. Fails with kConfiguration if the domain is open with other settings or Cyclone
    /// refuses them, with kUnavailable if Cyclone cannot open it, for example without a free port.
    static Expected<Domain> open(std::uint32_t id,
                                 const std::string& network_xml,
                                 const std::string& source);

    Domain(Domain&& other) noexcept : id_(std::exchange(other.id_, std::nullopt)) {}
    Domain& operator=(Domain&&) = delete;
    ~Domain();

private:
    explicit Domain(std::uint32_t id) : id_(id) {}
    std::optional<std::uint32_t> id_;
};

}  // namespace atrium::bus
