#pragma once

#include "core/bus/bus.hpp"
#include "core/keys/store.hpp"
#include "tests/integration/security/forged_object.hpp"
#include "tests/integration/security/stream_gaps.hpp"
#include "tests/support/network/hosted_process.hpp"
#include "tests/support/temporary_folder.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// A world with keys, of programs as users start them, and programs of attackers.
namespace atrium::test {

namespace fs = std::filesystem;

template <typename T>
T value(Expected<T> expected) {
    if (!expected) throw std::runtime_error(expected.error().message);
    return std::move(*expected);
}

/// A world server, the site alice, and a monitor in this process.
class ClosedWorld {
public:
    explicit ClosedWorld(std::uint32_t domain);
    ~ClosedWorld();

    keys::KeyStore& store() { return store_; }
    std::uint32_t domain() const { return domain_; }
    fs::path folder() const { return folder_ / ""; }

    /// Adds a member and exports its bundle, made at `now`, for `days`.
    fs::path add(keys::Kind kind,
                 const std::string& name,
                 keys::Rights rights = {},
                 Timestamp now = Timestamp::now(),
                 int days = 30);
    /// Exports the bundle as it is now, over an older one.
    fs::path export_bundle(const std::string& name);
    fs::path write(const std::string& name, const std::string& text) const;

    HostedProcess& world_server() { return *world_server_; }
    HostedProcess& alice() { return *alice_; }
    /// Starts another program of the tests or of Atrium.
    std::unique_ptr<HostedProcess> start(const std::string& program,
                                         const std::vector<std::string>& arguments) const;

    /// Takes what the monitor has received. Returns what is wrong, empty if nothing is: a mesh
    /// that is not newer than the one before, a mesh of anybody else, a state or placement of
    /// anybody but the world server's, an end of alice's stream.
    std::string take();
    std::size_t num_meshes() const { return num_meshes_; }
    /// Meshes that alice has published and that did not arrive; empty: she says nothing of herself.
    std::optional<std::uint64_t> count_lost();
    /// What alice sent since the last call: coded meshes and pictures.
    std::vector<std::vector<std::uint8_t>> take_payloads() { return std::exchange(payloads_, {}); }
    /// Participants that the monitor's DDS keeps, with keys or without.
    std::size_t num_participants() const;
    /// Text of the logs of both honest programs and of the monitor.
    std::string logs() const;
    bool wait_until(const std::function<bool()>& condition,
                    std::chrono::milliseconds patience = std::chrono::seconds(20));

private:
    TemporaryFolder folder_;
    std::uint32_t domain_;
    keys::KeyStore store_;
    std::unique_ptr<HostedProcess> world_server_;
    std::unique_ptr<HostedProcess> alice_;
    std::optional<bus::Participant> monitor_;
    std::optional<bus::Reader<bus::SiteMesh>> meshes_;
    std::optional<bus::Reader<bus::SiteStatus>> statuses_;
    std::optional<bus::Reader<bus::CameraTexture>> textures_;
    std::optional<bus::Reader<bus::SceneState>> states_;
    std::optional<bus::Reader<bus::SitePlacement>> placements_;
    std::optional<bus::Waiter> waiter_;
    StreamGaps gaps_;
    std::size_t num_meshes_ = 0;
    std::size_t num_states_ = 0;
    std::string own_log_;
    std::vector<std::vector<std::uint8_t>> payloads_;  // the last ones
};

}  // namespace atrium::test
