#pragma once

#include "core/base/expected.hpp"
#include "tools/demo/start_checks.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace atrium::demo {

/// Keys for the programs of one demo. The folder goes with this object.
class ThrowawayKeys {
public:
    /// Makes keys for the sites, "world", "viewer" and "demo" (a monitor, which may reset).
    static Expected<ThrowawayKeys> create(const std::filesystem::path& folder,
                                          const std::string& world,
                                          const std::vector<DemoSite>& sites);
    ~ThrowawayKeys();
    ThrowawayKeys(ThrowawayKeys&& other) noexcept : folder_(std::exchange(other.folder_, {})) {}
    ThrowawayKeys& operator=(ThrowawayKeys&&) = delete;

    /// The bundle of a program of the demo.
    std::filesystem::path bundle_of(const std::string& program) const;

private:
    explicit ThrowawayKeys(std::filesystem::path folder) : folder_(std::move(folder)) {}
    std::filesystem::path folder_;
};

}  // namespace atrium::demo
