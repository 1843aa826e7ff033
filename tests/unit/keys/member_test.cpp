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
    EXPECT_EQ(*parse_rights("all"), Rights::all());
    EXPECT_EQ(*parse_rights("none"), Rights());
    for (const char* text : {"", "fly", "push,", "push, grab", "push+grab", "none,push"}) {
        const auto parsed = parse_rights(text);
        ASSERT_FALSE(parsed) << text;
        EXPECT_EQ(parsed.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(parsed.error().message,
                    HasSubstr("add, remove, reset, push, grab, edit, save"));
    }
}

TEST(Member, HasASubjectAsCycloneComparesIt) {
    EXPECT_EQ(subject_of({"playroom", Kind::kSite, "alice", {}}), "CN=alice,OU=site,O=playroom");
    EXPECT_EQ(describe({"playroom", Kind::kWorld, "hall", {}}), "world hall of world playroom");
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

}  // namespace
}  // namespace atrium::keys
