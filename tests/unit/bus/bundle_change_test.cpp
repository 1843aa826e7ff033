#include "core/bus/bundle_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::bus {
namespace {

using keys::Kind;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class BundleChange : public ::testing::Test {
protected:
    BundleChange() {
        own_.member = {"playroom", Kind::kViewer, "bob", {}};
        own_.identity_ca = "the authority";
        own_.certificate = "the certificate";
        own_.crl = "nobody";
        now_ = own_;
    }
    std::string complaint() const { return complaint_about(now_, own_, "bob.bundle"); }

    keys::Bundle own_;
    keys::Bundle now_;
};

TEST_F(BundleChange, IsGoodIfOnlyTheListIsNew) {
    EXPECT_EQ(complaint(), "");
    now_.crl = "eve";
    EXPECT_EQ(complaint(), "");
}

TEST_F(BundleChange, NamesAnotherMemberAndDoesNotAdviseARestart) {
    now_.member.name = "carol";
    now_.certificate = "that of carol";
    EXPECT_THAT(complaint(),
                AllOf(StartsWith("bundle_of_another file=bob.bundle "),
                      HasSubstr("the bundle of viewer carol of world playroom"),
                      HasSubstr("this program is viewer bob of world playroom"),
                      HasSubstr("copy the right one"),
                      Not(HasSubstr("start this program again"))));
    now_.member = {"playroom", Kind::kMonitor, "bob", {}};
    EXPECT_THAT(complaint(), HasSubstr("the bundle of monitor bob of world playroom"));
}

TEST_F(BundleChange, NamesAnotherWorld) {
    now_.member.world = "kitchen";
    now_.identity_ca = "that of the kitchen";
    now_.certificate = "that of bob in the kitchen";
    EXPECT_THAT(complaint(),
                AllOf(StartsWith("bundle_of_another "),
                      HasSubstr("viewer bob of world kitchen"),
                      Not(HasSubstr("start this program again"))));
}

TEST_F(BundleChange, AdvisesARestartForANewKeyOfTheSameMember) {
    now_.certificate = "renewed";
    EXPECT_THAT(complaint(),
                AllOf(StartsWith("bundle_has_a_new_key file=bob.bundle "),
                      HasSubstr("start this program again")));
    now_.identity_ca = "a new key store";
    EXPECT_THAT(complaint(),
                AllOf(StartsWith("bundle_of_other_keys file=bob.bundle "),
                      HasSubstr("start this program again")));
}

}  // namespace
}  // namespace atrium::bus
