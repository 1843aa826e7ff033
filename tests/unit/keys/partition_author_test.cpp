#include "core/keys/topics.hpp"
#include "tests/support/random.hpp"

#include <gtest/gtest.h>

#include <set>

namespace atrium::keys {
namespace {

std::string drawn_name(test::Random& random) {
    static constexpr std::string_view kCharacters =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
    std::string name;
    const int length = test::between(random, 1, 63);
    // the dot comes last: no name begins with it
    for (int i = 0; i < length; ++i)
        name += kCharacters[static_cast<std::size_t>(test::between(random, 0, i == 0 ? 63 : 64))];
    return name;
}

Rights drawn_rights(test::Random& random) {
    Rights rights;
    for (unsigned i = 0; i < 8; ++i)
        if (test::between(random, 0, 1) == 1) rights.add(static_cast<Right>(i));
    return rights;
}

// A partition as a writer has it: one host of a site writes in a partition of its own.
std::string without_pattern(std::string partition) {
    if (partition.ends_with("/*")) partition.replace(partition.size() - 1, 1, "host");
    return partition;
}

void expect_author(const Member& member, const Topic& topic, const std::string& partition) {
    SCOPED_TRACE(partition);
    const auto author = author_of_partition(partition, member.world);
    ASSERT_TRUE(author);
    // all world servers write in one partition, which has no name of a member
    EXPECT_EQ(author->name, member.kind == Kind::kWorld ? member.world : member.name);
    if (topic.author == Author::kCommand) {
        EXPECT_EQ(author->kind, std::nullopt);
        EXPECT_EQ(author->rights, member.rights);
    } else {
        EXPECT_EQ(author->kind, member.kind);
        EXPECT_EQ(author->rights, Rights());
    }
}

TEST(PartitionAuthor, IsTheMemberThatMayWriteThere) {
    test::Random random(11);
    for (int round = 0; round < 50; ++round) {
        for (const Kind kind : kKinds) {
            Member member{drawn_name(random), kind, drawn_name(random), {}};
            if (kind == Kind::kViewer || kind == Kind::kMonitor)
                member.rights = drawn_rights(random);
            ASSERT_TRUE(check(member)) << member.world << " " << member.name;
            for (const Topic& topic : topics())
                for (const std::string& partition : partitions_written(member, topic))
                    expect_author(member, topic, without_pattern(partition));
        }
    }
}

// Else the property above checks nothing of some topics.
TEST(PartitionAuthor, IsKnownForEveryTopic) {
    std::set<std::string_view> written;
    for (const Kind kind : kKinds) {
        Member member{"w", kind, "x", {}};
        if (kind == Kind::kViewer) member.rights = Rights::all();
        for (const Topic& topic : topics())
            if (!partitions_written(member, topic).empty()) written.insert(topic.name);
    }
    EXPECT_EQ(written.size(), topics().size());
}

TEST(PartitionAuthor, IsNobodyForTextsThatNobodyMayWrite) {
    for (const char* partition : {"",
                                  "/",
                                  "play",
                                  "playroom",
                                  "playroom/",
                                  "playroom//",
                                  "playroom//alice",
                                  "playroom/site",
                                  "playroom/site/",
                                  "playroom/site//alice",
                                  "playroom/site/alice/",
                                  "playroom/site/alice/left",
                                  "playroom/site/*",
                                  "playroom/site/al?ce",
                                  "playroom/site/.alice",
                                  "playroom/site/..",
                                  "playroom/site/alice smith",
                                  "/playroom/site/alice",
                                  " playroom/site/alice",
                                  "playroom/Site/alice",
                                  "playroom/king/alice",
                                  "playroom/world/hall",
                                  "playroom/world/",
                                  "playroom/worlds",
                                  "playroom/part",
                                  "playroom/part/",
                                  "playroom/part/*",
                                  "playroom/viewer/*",
                                  "playroom/monitor/",
                                  "playroom/command",
                                  "playroom/command/bob",
                                  "playroom/command/bob/",
                                  "playroom/command/*/push",
                                  "playroom/command/.bob/push",
                                  "playroom/command/bob/grab+push",
                                  "playroom/command/bob/push+push",
                                  "playroom/command/bob/push+",
                                  "playroom/command/bob/none+push",
                                  "playroom/command/bob/fly",
                                  "playroom/command/bob/*",
                                  "playroom/command/bob/push/",
                                  "playroom/command/bob/push/grab"})
        EXPECT_FALSE(author_of_partition(partition, "playroom")) << partition;
    const std::string long_name(64, 'a');
    EXPECT_FALSE(author_of_partition("playroom/site/" + long_name, "playroom"));
}

TEST(PartitionAuthor, IsNobodyForPartitionsOfAnotherWorld) {
    for (const char* world : {"play", "playroom2", "Playroom", "room", "other", "playroom/site"}) {
        for (const char* partition : {"playroom/site/alice",
                                      "playroom/world",
                                      "playroom/part/alice/left",
                                      "playroom/command/bob/push"}) {
            EXPECT_FALSE(author_of_partition(partition, world)) << world << " " << partition;
            EXPECT_TRUE(author_of_partition(partition, "playroom")) << partition;
        }
    }
}

// A member with the name of a folder of the partition, and a world with that of a kind.
TEST(PartitionAuthor, TakesNoNameForAKind) {
    const auto author = author_of_partition("site/site/site", "site");
    ASSERT_TRUE(author);
    EXPECT_EQ(author->name, "site");
    EXPECT_EQ(author->kind, Kind::kSite);
    EXPECT_EQ(author_of_partition("world/world", "world")->kind, Kind::kWorld);
    EXPECT_FALSE(author_of_partition("world/world/world", "world"));
    EXPECT_EQ(author_of_partition("w/command/world/none", "w")->kind, std::nullopt);
}

}  // namespace
}  // namespace atrium::keys
