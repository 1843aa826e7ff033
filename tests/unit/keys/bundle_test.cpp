#include "core/keys/bundle.hpp"

#include "core/keys/documents.hpp"
#include "core/keys/permissions.hpp"
#include "core/keys/private_file.hpp"
#include "tests/unit/keys/a_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

namespace atrium::keys {
namespace {

using namespace keys::testing;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string refusal(const Bundle& bundle, Timestamp now = kNow) {
    const auto checked = check(bundle, now);
    if (checked) return "accepted";
    EXPECT_EQ(checked.error().kind, ErrorKind::kInvalidData);
    return checked.error().message;
}

TEST(Bundle, IsUsableUntilItsCertificateExpires) {
    for (const char* name : {"alice", "hall", "bob", "mona"}) {
        const Validity validity = value(check(a_world().bundle(name), kNow));
        EXPECT_EQ(validity.begin, kNow + -kDay) << name;
        EXPECT_EQ(validity.end, kNow + 365 * kDay) << name;
    }
}

TEST(Bundle, ComesBackFromItsText) {
    for (const char* name : {"alice", "bob"}) {
        const Bundle bundle = a_world().bundle(name);
        const Bundle again = value(parse_bundle(bundle_text(bundle), "a.bundle"));
        EXPECT_EQ(again.member, bundle.member);
        EXPECT_EQ(again.identity_ca, bundle.identity_ca);
        EXPECT_EQ(again.permissions_ca, bundle.permissions_ca);
        EXPECT_EQ(again.certificate, bundle.certificate);
        EXPECT_EQ(again.private_key, bundle.private_key);
        EXPECT_EQ(again.crl, bundle.crl);
        EXPECT_EQ(again.governance, bundle.governance);
        EXPECT_EQ(again.permissions, bundle.permissions);
        EXPECT_TRUE(check(again, kNow));
    }
}

TEST(Bundle, SaysWhoseItIsInItsFirstLine) {
    const std::string text = bundle_text(a_world().bundle("bob"));
    EXPECT_THAT(text.substr(0, text.find('\n')),
                AllOf(HasSubstr("viewer bob of world playroom"), HasSubstr("Secret")));
    EXPECT_THAT(text, HasSubstr("rights = \"push+grab\""));
}

TEST(Bundle, FitsIntoAQuarterOfItsLimit) {
    EXPECT_LT(bundle_text(a_world().bundle("mona")).size(), kMaxBundleBytes / 4);
}

TEST(Bundle, ExpiresAndIsNotValidBeforeItsTime) {
    const Bundle alice = a_world().bundle("alice");
    EXPECT_TRUE(check(alice, kNow + -kDay + std::chrono::seconds(1)));
    EXPECT_TRUE(check(alice, kNow + 365 * kDay + -std::chrono::seconds(2)));
    EXPECT_THAT(
        refusal(alice, kNow + 365 * kDay + std::chrono::seconds(1)),
        AllOf(HasSubstr("has expired on 2028-01-15"), HasSubstr("atrium keys renew alice")));
    // its authorities were made at the same time
    EXPECT_THAT(refusal(alice, kNow + -kDay + -std::chrono::seconds(1)),
                HasSubstr("is the clock right?"));
    EXPECT_THAT(refusal(alice, kNow + 3651 * kDay),
                AllOf(HasSubstr("authority has expired"), HasSubstr("atrium keys init")));
}

TEST(Bundle, IsRefusedWhenItIsRevoked) {
    AWorld world;
    Bundle old = world.bundle("bob");
    value(world.store().revoke("bob", Reason::kLost, kNow));
    EXPECT_TRUE(check(old, kNow));  // it has the list from before
    old.crl = world.bundle("alice").crl;
    EXPECT_THAT(refusal(old), HasSubstr("is revoked"));
    EXPECT_TRUE(check(world.bundle("alice"), kNow));
}

TEST(Bundle, RefusesPartsOfAnotherMember) {
    const Bundle alice = a_world().bundle("alice");
    const Bundle anna = a_world().bundle("anna");
    for (std::string Bundle::*part :
         {&Bundle::certificate, &Bundle::private_key, &Bundle::permissions}) {
        Bundle mixed = alice;
        mixed.*part = anna.*part;
        EXPECT_NE(refusal(mixed), "accepted");
    }
    Bundle renamed = alice;
    renamed.member = anna.member;
    EXPECT_THAT(refusal(renamed), HasSubstr("is not that of site anna"));
}

TEST(Bundle, RefusesPartsOfAnotherWorldOfTheSameName) {
    const AWorld other;
    const Bundle ours = a_world().bundle("alice");
    const Bundle theirs = other.bundle("alice");
    for (std::string Bundle::*part : {&Bundle::identity_ca,
                                      &Bundle::permissions_ca,
                                      &Bundle::certificate,
                                      &Bundle::private_key,
                                      &Bundle::crl,
                                      &Bundle::governance,
                                      &Bundle::permissions}) {
        Bundle mixed = ours;
        mixed.*part = theirs.*part;
        EXPECT_NE(refusal(mixed), "accepted");
    }
    Bundle exchanged = ours;
    std::swap(exchanged.identity_ca, exchanged.permissions_ca);
    EXPECT_THAT(refusal(exchanged), HasSubstr("another world or authority"));
    exchanged = ours;
    std::swap(exchanged.governance, exchanged.permissions);
    EXPECT_NE(refusal(exchanged), "accepted");
}

TEST(Bundle, RefusesMoreRightsThanPermitted) {
    Bundle bob = a_world().bundle("bob");
    bob.member.rights = Rights::all();
    EXPECT_THAT(refusal(bob), HasSubstr("add+remove+reset+push+grab+edit+save+record"));
    bob.member.rights = {};
    EXPECT_NE(refusal(bob), "accepted");
    bob = a_world().bundle("bob");
    bob.member.kind = Kind::kMonitor;
    EXPECT_NE(refusal(bob), "accepted");
}

// With the key of its own certificate, and with one of an authority that it made itself.
TEST(Bundle, RefusesPermissionsThatTheMemberSigned) {
    Bundle bob = a_world().bundle("bob");
    const Validity validity = validity_from(kNow, 365);
    bob.member.rights = Rights::all();
    const std::string xml = permissions_xml(bob.member, validity);
    bob.permissions = value(sign_document(xml, {bob.certificate, bob.private_key}));
    EXPECT_THAT(refusal(bob), HasSubstr("not signed by the permissions authority"));
    const KeyPair own = value(make_authority(Authority::kPermissions, "playroom", validity));
    bob.permissions = value(sign_document(xml, own));
    EXPECT_THAT(refusal(bob), HasSubstr("not signed by the permissions authority"));
    bob.permissions_ca = own.certificate;
    EXPECT_THAT(refusal(bob), HasSubstr("the governance is not signed"));
}

TEST(Bundle, RefusesAMembersCertificateAsAnAuthority) {
    Bundle bob = a_world().bundle("bob");
    bob.identity_ca = bob.certificate;
    EXPECT_NE(refusal(bob), "accepted");
}

TEST(Bundle, RefusesAGovernanceThatProtectsLess) {
    const test::TemporaryFolder folder;
    const Validity validity = validity_from(kNow, 365);
    const KeyPair authority = value(make_authority(Authority::kPermissions, "playroom", validity));
    Bundle alice = a_world().bundle("alice");
    alice.permissions_ca = authority.certificate;
    alice.permissions = value(sign_document(permissions_xml(alice.member, validity), authority));
    alice.governance = value(sign_document(governance_xml(), authority));
    EXPECT_TRUE(check(alice, kNow));
    std::string weak = governance_xml();
    weak.replace(weak.find("ENCRYPT_WITH_ORIGIN_AUTHENTICATION"), 34, "NONE");
    alice.governance = value(sign_document(weak, authority));
    EXPECT_THAT(refusal(alice), HasSubstr("the governance is not that of this version"));
}

class BundleFile : public ::testing::Test {
protected:
    std::filesystem::path write(mode_t mode, const std::string& text) {
        const std::filesystem::path file = folder_ / "alice.bundle";
        value(write_private_file(file, text, Existing::kReplace).map([] { return 0; }));
        ::chmod(file.c_str(), mode);
        return file;
    }
    test::TemporaryFolder folder_;
    std::string text_ = bundle_text(a_world().bundle("alice"));
};

TEST_F(BundleFile, IsReadIfOnlyItsOwnerCan) {
    for (const mode_t mode : {0600U, 0400U, 0700U}) {
        const auto bundle = read_bundle(write(mode, text_));
        ASSERT_TRUE(bundle) << bundle.error().message;
        EXPECT_EQ(bundle->member.name, "alice");
    }
}

TEST_F(BundleFile, IsRefusedIfOthersCanReadIt) {
    for (const mode_t mode : {0644U, 0604U, 0640U, 0660U, 0444U, 0601U}) {
        const auto bundle = read_bundle(write(mode, text_));
        ASSERT_FALSE(bundle) << mode;
        EXPECT_EQ(bundle.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(bundle.error().message,
                    AllOf(HasSubstr("alice.bundle"), HasSubstr("chmod 600")));
    }
}

// Nobody is told to close a file of the system.
TEST_F(BundleFile, OfOtherFilesTheModeDoesNotMatter) {
    for (const std::string& text : {std::string("root:x:0:0:root:/root:/bin/bash\n"),
                                    std::string("format = 1\n"),
                                    std::string("-----BEGIN PRIVATE KEY-----\n"),
                                    std::string()}) {
        const auto bundle = read_bundle(write(0644, text));
        ASSERT_FALSE(bundle);
        EXPECT_EQ(bundle.error().kind, ErrorKind::kInvalidData);
        EXPECT_THAT(bundle.error().message,
                    AllOf(HasSubstr("it must be the unchanged file"), Not(HasSubstr("chmod"))));
    }
    // cut off, and without its first line
    for (const std::string& text : {text_.substr(0, 3000), text_.substr(text_.find("format = "))})
        EXPECT_THAT(read_bundle(write(0644, text)).error().message, HasSubstr("chmod 600"));
}

TEST_F(BundleFile, IsReadAsACredentialOfSystemd) {
    const auto file = write(0440, text_);
    struct stat info {};
    ASSERT_EQ(::stat(file.c_str(), &info), 0);
    EXPECT_EQ(read_bundle(file).has_value(), info.st_uid == 0 && info.st_gid == 0);
}

TEST_F(BundleFile, IsRefusedIfItIsNoFileOrTooLarge) {
    EXPECT_EQ(read_bundle(folder_ / "none").error().kind, ErrorKind::kNotFound);
    EXPECT_EQ(read_bundle(folder_ / "").error().kind, ErrorKind::kConfiguration);
    ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    EXPECT_EQ(read_bundle(folder_ / "pipe").error().kind, ErrorKind::kConfiguration);
    const auto large = read_bundle(write(0600, text_ + std::string(kMaxBundleBytes, '\n')));
    ASSERT_FALSE(large);
    EXPECT_THAT(large.error().message, HasSubstr("is larger than 256 KiB"));
}

TEST_F(BundleFile, IsWrittenForItsOwnerAndNotOverAnother) {
    const std::filesystem::path file = folder_ / "b.bundle";
    ASSERT_TRUE(write_private_file(file, "one", Existing::kKeep));
    struct stat info {};
    ASSERT_EQ(::stat(file.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777U, 0600U);
    const auto again = write_private_file(file, "two", Existing::kKeep);
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("exists already"));
    EXPECT_EQ(value(read_private_file(file, 10)), "one");
    ASSERT_TRUE(write_private_file(file, "two", Existing::kReplace));
    EXPECT_EQ(value(read_private_file(file, 10)), "two");
    EXPECT_FALSE(write_private_file(folder_ / "no" / "b.bundle", "one", Existing::kKeep));
    // nothing is left over
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file.parent_path()), {}), 1);
}

}  // namespace
}  // namespace atrium::keys
