#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace atrium::bus {

/// Share in a DDS domain of this process; the last one closes it.
class Domain {
public:
    /// Joins the domain that is open, or opens it with the settings `network_xml`. Fails where it
    /// is open with others, and where Cyclone refuses the settings or finds no free port.
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
