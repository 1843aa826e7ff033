#include "core/keys/member.hpp"

#include "tests/support/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::keys {
namespace {

using ::testing::HasSubstr;

TEST(Rights, HaveOneTextEach) {
    EXPECT_EQ(rights_text({}), "none");
    EXPECT_EQ(rights_text({Right::kGrab, Right::kPush}), "push+grab");
    EXPECT_EQ(rights_text(Rights::all()), "add+remove+reset+push+grab+edit+save+record");
}

TEST(Rights, AreReadFromTheirText) {
    for (unsigned bits = 0; bits < 256; ++bits) {
        Rights rights;
        for (unsigned i = 0; i < 8; ++i)
            if ((bits >> i & 1U) != 0) rights.add(static_cast<Right>(i));
        const auto read = rights_of_text(rights_text(rights));
        ASSERT_TRUE(read) << rights_text(rights);
        EXPECT_EQ(*read, rights);
    }
}

TEST(Rights, RefuseEveryOtherText) {
    for (const char* text : {"",
                             "grab+push",
                             "push+push",
                             "push+",
                             "+push",
                             "push,grab",
                             "all",
                             "none+push",
                             "fly",
                             "push+fly",
                             "Push",
                             "push "})
        EXPECT_FALSE(rights_of_text(text)) << text;
}

TEST(Rights, AreParsedAsUsersWriteThem) {
    EXPECT_EQ(*parse_rights("grab,push"), (Rights{Right::kPush, Right::kGrab}));
    for (const char* text : {"grab, push", "push+grab", "grab,push+grab", " push ,  grab "})
        EXPECT_EQ(*parse_rights(text), (Rights{Right::kPush, Right::kGrab})) << text;
    EXPECT_EQ(*parse_rights("all"), Rights::all());
    EXPECT_EQ(*parse_rights("none"), Rights());
    for (const char* text :
         {"", "fly", "push,", "push+", "push grab", "push,,grab", ",", "none,push"}) {
        const auto parsed = parse_rights(text);
        ASSERT_FALSE(parsed) << text;
        EXPECT_EQ(parsed.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(parsed.error().message,
                    HasSubstr("add, remove, reset, push, grab, edit, save"));
    }
}

TEST(Member, HasASubjectAsCycloneComparesIt) {
    EXPECT_EQ(subject_of({"playroom", Kind::kSite, "alice", {}}), "CN=alice,OU=site,O=playroom");
    EXPECT_EQ(describe({"playroom", Kind::kWorld, "hall", {}}), "world server of world playroom");
}

TEST(Member, RefusesNamesThatLeaveAFolderOrAPartition) {
    for (const char* name : {"",
                             ".",
                             "..",
                             ".hidden",
                             "a/b",
                             "../a",
                             "a b",
                             "a*",
                             "a?",
                             "[a]",
                             "a,b",
                             "a=b",
                             "a+b",
                             "\xC3\xA4",
                             "a\nb"})
        EXPECT_FALSE(check(Member{"playroom", Kind::kSite, name, {}})) << name;
    EXPECT_FALSE(check(Member{"playroom", Kind::kSite, std::string(64, 'a'), {}}));
    EXPECT_FALSE(check(Member{"..", Kind::kSite, "alice", {}}));
    EXPECT_TRUE(check(Member{"playroom", Kind::kSite, std::string(63, 'a'), {}}));
    EXPECT_TRUE(check(Member{"play.room", Kind::kSite, "a.b-c_D9", {}}));
}

TEST(Member, HasRightsOnlyIfItIsAViewerOrAMonitor) {
    for (const Kind kind : kKinds) {
        const bool may = kind == Kind::kViewer || kind == Kind::kMonitor;
        EXPECT_EQ(check(Member{"playroom", kind, "x", {Right::kPush}}).has_value(), may);
        EXPECT_TRUE(check(Member{"playroom", kind, "x", {}}));
        EXPECT_EQ(find_kind(kind_text(kind)), kind);
    }
    EXPECT_EQ(find_kind("king"), std::nullopt);
}

std::string random_member_name(test::Random& random) {
    static constexpr std::string_view kCharacters = "abzABZ059_-.";
    std::string name;
    const int length = test::between(random, 1, 63);
    for (int i = 0; i < length; ++i)
        name += kCharacters[static_cast<std::size_t>(test::between(random, 0, i == 0 ? 10 : 11))];
    return name;
}

TEST(Subject, LeadsBackToItsMember) {
    test::Random random(5);
    for (int round = 0; round < 200; ++round) {
        for (const Kind kind : kKinds) {
            const Member member{random_member_name(random), kind, random_member_name(random), {}};
            ASSERT_TRUE(check(member)) << describe(member);
            const auto back = member_of_subject(subject_of(member));
            ASSERT_TRUE(back) << subject_of(member);
            EXPECT_EQ(*back, member);
        }
    }
}

TEST(Subject, HasNoRights) {
    const Member bob{"playroom", Kind::kViewer, "bob", {Right::kPush}};
    EXPECT_EQ(member_of_subject(subject_of(bob))->rights, Rights());
}

TEST(Subject, OfAnyOtherTextIsOfNobody) {
    ASSERT_TRUE(member_of_subject("CN=alice,OU=site,O=playroom"));
    for (const char* text : {"",
                             ",",
                             "CN=alice",
                             "CN=alice,OU=site",
                             "CN=alice,OU=site,O=",
                             "CN=alice,OU=,O=playroom",
                             "CN=,OU=site,O=playroom",
                             "OU=site,O=playroom",
                             "CN=alice,O=playroom",
                             "O=playroom,OU=site,CN=alice",
                             "OU=site,CN=alice,O=playroom",
                             "CN=alice,OU=authority,O=playroom",
                             "CN=alice,OU=identity authority,O=playroom",
                             "CN=alice,OU=Site,O=playroom",
                             "CN=alice,OU=site,O=playroom,",
                             "CN=alice,OU=site,O=playroom,,",
                             ",CN=alice,OU=site,O=playroom",
                             "CN=alice,,OU=site,O=playroom",
                             "CN=alice,OU=site,O=playroom,C=DE",
                             "CN=alice,OU=site,O=playroom,O=playroom",
                             "CN=alice,CN=bob,OU=site,O=playroom",
                             "CN=alice, OU=site, O=playroom",
                             "CN=alice+OU=site,O=playroom",
                             "cn=alice,OU=site,O=playroom",
                             "CN=alice ,OU=site,O=playroom",
                             "CN=al\\,ice,OU=site,O=playroom",
                             "CN=.alice,OU=site,O=playroom",
                             "CN=alice,OU=site,O=..",
                             "CN=a/b,OU=site,O=playroom",
                             "CN=*,OU=site,O=playroom",
                             "CN=alice,OU=site,O=play room",
                             "CN=\xC3\xA4,OU=site,O=playroom"})
        EXPECT_FALSE(member_of_subject(text)) << text;
    EXPECT_FALSE(member_of_subject("CN=" + std::string(64, 'a') + ",OU=site,O=playroom"));
    EXPECT_FALSE(member_of_subject(std::string("CN=alice,OU=site,O=playroom\0", 28)));
}

}  // namespace
}  // namespace atrium::keys
