#pragma once

#include "tests/integration/security/closed_world.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

namespace atrium::test {

using namespace std::chrono_literals;
using keys::Kind;
using keys::Right;
using keys::Rights;
using testing::HasSubstr;

inline constexpr std::uint32_t kClosedDomain = 196;  // used by this test only

class ClosedWorldTest : public testing::Test {
protected:
    static void SetUpTestSuite() { world_ = std::make_unique<ClosedWorld>(kClosedDomain); }
    static void TearDownTestSuite() { world_.reset(); }
    static ClosedWorld& world() { return *world_; }

    using Arguments = std::vector<std::string>;
    void attack(const fs::path& bundle, Arguments arguments) {
        if (!bundle.empty()) arguments.insert(arguments.end(), {"--bundle", bundle.string()});
        attacker_ = world().start("security_attacker", arguments);
    }
    // With the plugin that lets it do everything.
    void attack_freely(const fs::path& bundle, Arguments arguments) {
        arguments.insert(arguments.end(), {"--access-control", ATRIUM_OPEN_ACCESS});
        attack(bundle, std::move(arguments));
    }
    // Ends the attacker. It must have acted, and heard nothing.
    void end_deaf() {
        const std::string output = end();
        EXPECT_THAT(output, HasSubstr("acts"));
        EXPECT_THAT(output, HasSubstr("heard 0"));
    }
    std::string end() {
        attacker_->signal(SIGTERM);
        EXPECT_TRUE(attacker_->wait(20s));
        return attacker_->output();
    }
    static bool log_has(const std::string& text) {
        return world().wait_until([&] { return world().logs().find(text) != std::string::npos; });
    }
    // Time for what must not happen to happen: thirty meshes of alice, of which none is lost.
    static void let_pass() {
        const std::size_t end = world().num_meshes() + 30;
        ASSERT_TRUE(world().wait_until([end] { return world().num_meshes() >= end; }, 60s));
        ASSERT_EQ(world().count_lost(), 0u);
    }

    std::unique_ptr<HostedProcess> attacker_;

private:
    inline static std::unique_ptr<ClosedWorld> world_;
};

}  // namespace atrium::test
