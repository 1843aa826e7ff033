#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/bus.hpp"
#include "tests/integration/swaying_person.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/network/hosted_process.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

/// A site on several hosts, as programs that users would start.
namespace atrium::test {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

inline constexpr auto kPatience = 120s;
inline constexpr std::uint32_t kDomain = 194;  // used by this test only
inline constexpr int kRate_hz = 10;
inline constexpr int kNumInstants = 6;

template <typename T>
T value(Expected<T> expected) {
    if (!expected) throw std::runtime_error(expected.error().message);
    return std::move(*expected);
}

inline std::string site_file(const fs::path& recording) {
    return fmt::format(R"([site]
name = "hall"
[capture]
source = "recording"
recording = "{}"
rate_hz = {}
min_cameras = 4
aligned = true
)",
                       recording.string(),
                       kRate_hz);
}

inline constexpr const char* kHosts = R"(
[[host]]
name = "left"
cameras = ["cam0", "cam1", "cam2", "cam3"]
[[host]]
name = "right"
cameras = ["cam4", "cam5", "cam6", "cam7"]
[[host]]
name = "hull"
model = true
)";

// The person stands in both regions.
inline constexpr const char* kRegions = R"(
[[hull.region]]
name = "front"
bounds = { min = [-2.0, -2.0, -0.1], max = [2.0, 0.0, 2.5] }
[[hull.region]]
name = "back"
bounds = { min = [-2.0, 0.0, -0.1], max = [2.0, 2.0, 2.5] }
cameras = ["cam0", "cam1", "cam2", "cam3", "cam4", "cam5", "cam6"]
)";

inline constexpr const char* kHelper = R"(
[[host]]
name = "help"
regions = ["front"]
)";

// What a site published of each instant of the recording: all that came is the same each round.
struct Published {
    std::map<std::int64_t, std::set<std::vector<std::uint8_t>>> meshes;
    std::map<std::pair<std::int64_t, std::uint32_t>, std::set<std::vector<std::uint8_t>>> textures;
    std::size_t num_complete = 0;       // meshes of all cameras whose textures all came
    std::size_t num_of_two_meshes = 0;  // part of num_complete
    std::size_t num_textures = 0;
};

inline std::int64_t instant_at(Timestamp time) {
    const auto number = std::llround(static_cast<double>(time.ns / 1000) * kRate_hz / 1e6);
    return number % kNumInstants;
}

class SiteHosts : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = fs::path(testing::TempDir()) / ("atrium_site_hosts_" + std::to_string(getpid()));
        write_swaying_person(folder_ / "recording", kNumInstants);
        std::ofstream(folder_ / "one.toml") << site_file(folder_ / "recording");
        std::ofstream(folder_ / "hall.toml") << site_file(folder_ / "recording") << kHosts;
        const std::string regions = site_file(folder_ / "recording") + kRegions;
        std::ofstream(folder_ / "one_with_regions.toml") << regions;
        std::ofstream(folder_ / "hall_with_regions.toml") << regions << kHosts << kHelper;
    }
    static void TearDownTestSuite() { fs::remove_all(folder_); }
    void TearDown() override {
        for (auto& [name, program] : programs_) {
            program->signal(SIGTERM);
            EXPECT_EQ(program->wait(kPatience), 0) << name << program->output();
            EXPECT_EQ(program->output().find(" error "), std::string::npos) << program->output();
        }
    }

    std::vector<std::string> command_of(const std::string& host) const {
        const std::string program = host == "left" || host == "right" ? "camera_node" : "site_node";
        const std::string file = (host == "one" ? "one" : "hall") + regions_ + ".toml";
        std::vector<std::string> command{
            std::string(ATRIUM_BIN_DIR) + "/" + program, "--config", (folder_ / file).string()};
        if (host != "one") command.insert(command.end(), {"--host", host});
        command.insert(command.end(), {"--bus.domain", std::to_string(kDomain)});
        return command;
    }
    void start(const std::string& host, std::vector<std::string> prefix = {}) {
        const auto command = command_of(host);
        prefix.insert(prefix.end(), command.begin(), command.end());
        programs_[host] = value(HostedProcess::start(prefix));
    }
    void start_all() {
        for (const std::string host : {"hull", "left", "right"}) start(host);
        for (const std::string host : {"left", "right"})
            ASSERT_TRUE(hull_says("host_in_use host=" + host, 0)) << hull().output();
    }
    HostedProcess& hull() { return *programs_.at("hull"); }
    std::size_t now_in_log() { return hull().output().size(); }
    bool hull_says(const std::string& text, std::size_t from) {
        return hull().wait_for_output(text, kPatience, from);
    }

    // Listens until `num` meshes of all cameras came with their textures.
    Published listen(std::size_t num) {
        bus::BusOptions options;
        options.domain = kDomain;
        const auto participant = value(bus::Participant::create(options));
        auto meshes = value(bus::Reader<bus::SiteMesh>::create(participant));
        auto textures = value(bus::Reader<bus::CameraTexture>::create(participant));
        auto waiter = value(bus::Waiter::create(participant));
        waiter.add(meshes);
        waiter.add(textures);
        Published published;
        std::set<std::tuple<std::uint32_t, std::uint64_t, std::int64_t>> there;
        std::vector<bus::SiteMesh> pending;
        const auto end = std::chrono::steady_clock::now() + kPatience;
        while (published.num_complete < num && std::chrono::steady_clock::now() < end) {
            waiter.wait(100ms);
            textures.take([&](bus::CameraTexture&& t) {
                there.emplace(t.camera, t.frame_id, t.capture_time.ns);
                ++published.num_textures;
                std::vector<std::uint8_t> bytes = t.colour;
                bytes.insert(bytes.end(), t.mask.begin(), t.mask.end());
                published.textures[{instant_at(t.capture_time), t.camera}].insert(bytes);
            });
            meshes.take([&](bus::SiteMesh&& mesh) {
                if (mesh.textured_cameras.size() == 8) pending.push_back(std::move(mesh));
            });
            std::erase_if(pending, [&](const bus::SiteMesh& mesh) {
                for (std::size_t i = 0; i < mesh.textured_cameras.size(); ++i) {
                    const bus::FrameKey key = bus::texture_frame(mesh, i);
                    if (!there.contains(
                            {mesh.textured_cameras[i], key.frame_id, key.capture_time.ns}))
                        return false;
                    // the instant of each picture is that of the mesh
                    EXPECT_EQ(instant_at(key.capture_time), instant_at(mesh.capture_time));
                }
                ++published.num_complete;
                if (mesh.mesh_sizes.size() == 2) ++published.num_of_two_meshes;
                published.meshes[instant_at(mesh.capture_time)].insert(mesh.draco);
                return true;
            });
        }
        return published;
    }

    static inline fs::path folder_;
    std::string regions_;  // of the names of the site's files
    std::map<std::string, std::unique_ptr<HostedProcess>> programs_;
};

}  // namespace atrium::test
