#include "core/keys/permissions.hpp"

#include "core/keys/topics.hpp"
#include "tests/support/random.hpp"
#include "tests/unit/keys/a_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include <set>
#include <tuple>

namespace atrium::keys {
namespace {

using namespace keys::testing;
using ::testing::ElementsAre;

constexpr Validity kYear{{1'800'000'000'000'000'000}, {1'831'536'000'000'000'000}};

// direction, topic, partition
using Allowed = std::set<std::tuple<std::string, std::string, std::string>>;

Allowed allowed_in(const pugi::xml_node& grant) {
    Allowed allowed;
    for (const pugi::xml_node& element : grant.child("allow_rule").children()) {
        for (const pugi::xml_node& topic : element.child("topics").children("topic"))
            for (const pugi::xml_node& partition :
                 element.child("partitions").children("partition"))
                allowed.emplace(element.name(), topic.child_value(), partition.child_value());
    }
    return allowed;
}

Allowed allowed_by_table(const Member& member) {
    Allowed allowed;
    for (const Topic& topic : topics()) {
        for (const std::string& partition : partitions_written(member, topic))
            allowed.emplace("publish", topic.name, partition);
        for (const std::string& partition : partitions_read(member, topic))
            allowed.emplace("subscribe", topic.name, partition);
    }
    return allowed;
}

std::string random_name(test::Random& random) {
    constexpr std::string_view kFirst = "ABYZabyz0189_-";
    constexpr std::string_view kAll = "ABYZabyz0189_-.";
    const auto pick = [&](std::string_view from) {
        return from[static_cast<std::size_t>(
            test::between(random, 0, static_cast<int>(from.size()) - 1))];
    };
    std::string name(1, pick(kFirst));
    for (int more = test::between(random, 0, 62); more > 0; --more) name += pick(kAll);
    return name;
}

Member random_member(test::Random& random) {
    Member member{random_name(random),
                  kKinds[static_cast<std::size_t>(test::between(random, 0, 3))],
                  random_name(random),
                  {}};
    if (member.kind == Kind::kViewer || member.kind == Kind::kMonitor) {
        for (int right = 0; right < 8; ++right)
            if (test::between(random, 0, 1) == 1) member.rights.add(static_cast<Right>(right));
    }
    return member;
}

TEST(Permissions, AreThoseOfTheTableForAnyMember) {
    test::Random random(1);
    for (int i = 0; i < 300; ++i) {
        const Member member = random_member(random);
        ASSERT_TRUE(check(member));
        pugi::xml_document document;
        ASSERT_TRUE(document.load_string(permissions_xml(member, kYear).c_str()));
        const pugi::xml_node permissions = document.child("dds").child("permissions");
        ASSERT_EQ(std::distance(permissions.begin(), permissions.end()), 1);
        const pugi::xml_node grant = permissions.child("grant");
        EXPECT_EQ(grant.child_value("subject_name"), subject_of(member));
        EXPECT_STREQ(grant.child("validity").child_value("not_before"), "2027-01-15T08:00:00Z");
        EXPECT_STREQ(grant.child("validity").child_value("not_after"), "2028-01-15T08:00:00Z");
        EXPECT_STREQ(grant.child_value("default"), "DENY");
        EXPECT_EQ(allowed_in(grant), allowed_by_table(member));
    }
}

// Cyclone DDS takes the first element that has the topic and all partitions of an endpoint.
TEST(Permissions, NameEachTopicOnceForEachDirection) {
    test::Random random(2);
    for (int i = 0; i < 50; ++i) {
        pugi::xml_document document;
        document.load_string(permissions_xml(random_member(random), kYear).c_str());
        const pugi::xml_node rule =
            document.child("dds").child("permissions").child("grant").child("allow_rule");
        std::set<std::pair<std::string, std::string>> seen;
        for (const pugi::xml_node& element : rule.children()) {
            for (const pugi::xml_node& topic : element.child("topics").children()) {
                EXPECT_NE(std::string(topic.child_value()), "*");
                EXPECT_TRUE(seen.emplace(element.name(), topic.child_value()).second);
            }
        }
    }
}

TEST(Permissions, AreInTheOrderOfTheSchema) {
    pugi::xml_document document;
    document.load_string(
        permissions_xml({"w", Kind::kViewer, "bob", {Right::kRecord}}, kYear).c_str());
    const auto names = [](const pugi::xml_node& node) {
        std::vector<std::string> children;
        for (const pugi::xml_node& child : node.children())
            if (children.empty() || children.back() != child.name())
                children.push_back(child.name());
        return children;
    };
    const pugi::xml_node grant = document.child("dds").child("permissions").child("grant");
    EXPECT_THAT(names(grant), ElementsAre("subject_name", "validity", "allow_rule", "default"));
    EXPECT_THAT(names(grant.child("allow_rule")), ElementsAre("domains", "publish", "subscribe"));
    EXPECT_THAT(names(grant.child("allow_rule").child("publish")),
                ElementsAre("topics", "partitions"));
}

TEST(Permissions, AreCheckedAgainstTheMember) {
    const Member bob{"w", Kind::kViewer, "bob", {Right::kPush}};
    const std::string xml = permissions_xml(bob, kYear);
    EXPECT_EQ(value(check_permissions_xml(xml, bob)), kYear);
    EXPECT_EQ(value(check_permissions_xml(xml + "\n\n", bob)), kYear);
    for (const Member& other : {Member{"w", Kind::kViewer, "eve", {Right::kPush}},
                                Member{"v", Kind::kViewer, "bob", {Right::kPush}},
                                Member{"w", Kind::kMonitor, "bob", {Right::kPush}},
                                Member{"w", Kind::kViewer, "bob", {Right::kPush, Right::kGrab}},
                                Member{"w", Kind::kViewer, "bob", {}}})
        EXPECT_FALSE(check_permissions_xml(xml, other)) << describe(other);
}

TEST(Permissions, RefuseEveryChangeOfTheText) {
    const Member bob{"w", Kind::kViewer, "bob", {Right::kPush}};
    const std::string xml = permissions_xml(bob, kYear);
    for (std::size_t i = 0; i < xml.size(); ++i) {
        std::string changed = xml;
        changed[i] = changed[i] == 'x' ? 'y' : 'x';
        if (i + 1 < xml.size()) {
            EXPECT_FALSE(check_permissions_xml(changed, bob)) << changed.substr(i, 40);
        }
        EXPECT_FALSE(check_permissions_xml(xml.substr(0, i == 0 ? 0 : i - 1), bob)) << i;
    }
    for (const char* time : {"2027-02-30T08:00:00Z",
                             "1960-01-01T00:00:00Z",
                             "9999-01-01T00:00:00Z",
                             "2027-01-15T24:00:00Z",
                             "2027-01-15T08:61:00Z",
                             "2027-01-15 08:00:00Z",
                             "",
                             "2027-01-15T08:00:00+02:00",
                             "-027-01-15T08:00:00Z"}) {
        std::string changed = xml;
        changed.replace(changed.find("2027-01-15T08:00:00Z"), 20, time);
        EXPECT_FALSE(check_permissions_xml(changed, bob)) << time;
    }
}

TEST(Governance, EncryptsAllAndLetsOnlyMembersIn) {
    pugi::xml_document document;
    ASSERT_TRUE(document.load_string(governance_xml().c_str()));
    std::vector<std::string> rules;
    const pugi::xml_node rule =
        document.child("dds").child("domain_access_rules").child("domain_rule");
    for (const pugi::xml_node& child : rule.children())
        rules.push_back(std::string(child.name()) + "=" + child.child_value());
    EXPECT_THAT(rules,
                ElementsAre("domains=",
                            "allow_unauthenticated_participants=false",
                            "enable_join_access_control=true",
                            "discovery_protection_kind=NONE",
                            "liveliness_protection_kind=NONE",
                            "rtps_protection_kind=ENCRYPT_WITH_ORIGIN_AUTHENTICATION",
                            "topic_access_rules="));
    std::vector<std::string> topic;
    for (const pugi::xml_node& child :
         rule.child("topic_access_rules").child("topic_rule").children())
        topic.push_back(std::string(child.name()) + "=" + child.child_value());
    EXPECT_THAT(topic,
                ElementsAre("topic_expression=*",
                            "enable_discovery_protection=false",
                            "enable_liveliness_protection=false",
                            "enable_read_access_control=true",
                            "enable_write_access_control=true",
                            "metadata_protection_kind=NONE",
                            "data_protection_kind=NONE"));
    const pugi::xml_node range = rule.child("domains").child("id_range");
    EXPECT_STREQ(range.child_value("min"), "0");
    EXPECT_STREQ(range.child_value("max"), "230");
}

}  // namespace
}  // namespace atrium::keys
