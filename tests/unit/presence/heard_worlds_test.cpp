#include "core/presence/heard_worlds.hpp"

#include "core/presence/membership.hpp"
#include "tests/unit/bus/bus_support.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <thread>

namespace atrium::presence {
namespace {

using bus::HeardProgram;
using bus::ProgramKind;
using bus::testing::own_world;
using bus::testing::value;

bus::Presence program(ProgramKind kind, const std::string& name, bool is_holder = true) {
    bus::Presence presence;
    presence.kind = kind;
    presence.name = name;
    presence.host = "ada";
    presence.is_holder = is_holder;
    return presence;
}

TEST(HeardWorlds, AreGroupedByName) {
    const std::vector<HeardProgram> programs{
        {"lab", program(ProgramKind::kSiteNode, "bob")},
        {"garden", program(ProgramKind::kViewer, "v")},
        {"lab", program(ProgramKind::kSiteNode, "alice")},
        {"lab", program(ProgramKind::kWorldServer, "w")},
        {"lab", program(ProgramKind::kSiteNode, "late", false)},
        {"lab", program(ProgramKind::kOther, "monitor")}};
    const auto worlds = worlds_of(programs);
    ASSERT_EQ(worlds.size(), 2U);
    EXPECT_EQ(worlds[0].name, "garden");
    EXPECT_EQ(describe(worlds[0]), "no world server, 0 sites; 1 viewer");
    EXPECT_EQ(describe(worlds[1]), "world server on ada, 2 sites: alice, bob; 1 other program");
    EXPECT_TRUE(worlds_of({}).empty());
}

TEST(HeardWorlds, DescriptionsStayShort) {
    std::vector<HeardProgram> programs;
    for (int i = 0; i < 50; ++i)
        programs.push_back({"lab", program(ProgramKind::kSiteNode, "site" + std::to_string(i))});
    const std::string text = describe(worlds_of(programs)[0]);
    EXPECT_LT(text.size(), 120U) << text;
    EXPECT_NE(text.find(", ..."), std::string::npos) << text;
}

// Waits for what the listener hears.
bool hears(bus::WorldListener& listener,
           const std::function<bool(const std::vector<HeardWorld>&)>& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(15);
    while (std::chrono::steady_clock::now() < end) {
        if (condition(worlds_of(listener.heard()))) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

TEST(WorldListener, HearsTheProgramsOfAllWorldsAndTheirEnd) {
    constexpr std::uint32_t kDomain = 187;  // used by this test only
    const bus::BusOptions lab = own_world("heard-lab", kDomain);
    const bus::BusOptions garden = own_world("heard-garden", kDomain);
    const auto join =
        [](const bus::BusOptions& options, ProgramKind kind, const std::string& name) {
            const auto ignore = [](const std::string&) {};
            return value(Membership::join(value(bus::Participant::create(options)),
                                          {kind, name, "1"},
                                          {ignore, ignore, [](const Error&) {}}));
        };
    auto server = join(lab, ProgramKind::kWorldServer, "lab");
    auto listener = value(bus::WorldListener::create(lab));
    auto site = join(garden, ProgramKind::kSiteNode, "alice");
    EXPECT_TRUE(hears(listener, [&](const std::vector<HeardWorld>& worlds) {
        return worlds.size() == 2 && worlds[0].name == garden.world &&
               worlds[0].sites == std::vector<std::string>{"alice"} &&
               worlds[1].name == lab.world && worlds[1].servers.size() == 1;
    }));
    site.reset();
    EXPECT_TRUE(hears(listener, [&](const std::vector<HeardWorld>& worlds) {
        return worlds.size() == 1 && worlds[0].name == lab.world;
    }));
    server.reset();
    EXPECT_TRUE(
        hears(listener, [](const std::vector<HeardWorld>& worlds) { return worlds.empty(); }));
}

}  // namespace
}  // namespace atrium::presence
