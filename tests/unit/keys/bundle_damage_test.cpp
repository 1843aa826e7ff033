#include "core/keys/bundle.hpp"
#include "core/keys/documents.hpp"
#include "tests/support/random.hpp"
#include "tests/unit/keys/a_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::keys {
namespace {

using namespace keys::testing;
using ::testing::HasSubstr;

// Errors reach logs: they must not have a line of the private key.
void expect_no_secret(const std::string& message, const Bundle& bundle) {
    const std::string& key = bundle.private_key;
    for (std::size_t i = key.find('\n'); i + 12 < key.rfind('-', key.size() - 20); i += 6) {
        if (message.find(key.substr(i, 12)) != std::string::npos) FAIL() << message;
    }
}

void expect_refused_if_cut(const Bundle& bundle, std::size_t step) {
    const std::string text = bundle_text(bundle);
    ASSERT_TRUE(parse_bundle(text, "a.bundle"));
    const std::size_t end = text.rfind("'''");  // what follows is a line end
    for (std::size_t length = 0; length < end + 3; length += step) {
        const auto parsed = parse_bundle(text.substr(0, length), "a.bundle");
        ASSERT_FALSE(parsed) << length;
        EXPECT_EQ(parsed.error().kind, ErrorKind::kInvalidData);
        EXPECT_THAT(parsed.error().message, HasSubstr("a.bundle: "));
        expect_no_secret(parsed.error().message, bundle);
    }
}

TEST(DamagedBundle, IsRefusedWhereverItIsCut) {
    const Bundle bob = a_world().bundle("bob");
    expect_refused_if_cut(bob, 61);
    // shorter, at every byte: parsing does not look into the texts
    Bundle brief{.member = bob.member,
                 .identity_ca = "one\n",
                 .permissions_ca = "two\n",
                 .certificate = "three\nlines\n",
                 .private_key = bob.private_key,
                 .crl = "four\n",
                 .governance = "five\n",
                 .permissions = "six\n"};
    expect_refused_if_cut(brief, 1);
}

TEST(DamagedBundle, IsRefusedWithAnyByteChanged) {
    const Bundle alice = a_world().bundle("alice");
    const std::string text = bundle_text(alice);
    const std::string permissions = value(verify_document(alice.permissions, alice.permissions_ca));
    const std::string governance = value(verify_document(alice.governance, alice.permissions_ca));
    test::Random random(3);
    const std::size_t first = text.find('\n');  // the comment may be anything
    for (std::size_t i = first; i < text.size(); i += 13) {
        std::string changed = text;
        changed[i] = static_cast<char>(test::between(random, 1, 255));
        const auto parsed = parse_bundle(changed, "a.bundle");
        if (!parsed) {
            expect_no_secret(parsed.error().message, alice);
            continue;
        }
        const auto checked = check(*parsed, kNow);
        if (!checked) {
            EXPECT_FALSE(checked.error().message.empty());
            expect_no_secret(checked.error().message, alice);
            continue;
        }
        // spaces, or a part of the S/MIME text that the signature does not cover
        EXPECT_EQ(parsed->member, alice.member);
        EXPECT_EQ(parsed->certificate, alice.certificate);
        EXPECT_EQ(parsed->private_key, alice.private_key);
        EXPECT_EQ(parsed->crl, alice.crl);
        EXPECT_EQ(value(verify_document(parsed->permissions, parsed->permissions_ca)), permissions);
        EXPECT_EQ(value(verify_document(parsed->governance, parsed->permissions_ca)), governance);
    }
}

TEST(DamagedBundle, IsRefusedWithoutOneOfItsParts) {
    const std::string text = bundle_text(a_world().bundle("alice"));
    for (const std::string key : {"format",
                                  "world",
                                  "kind",
                                  "name",
                                  "rights",
                                  "identity_ca",
                                  "permissions_ca",
                                  "certificate",
                                  "private_key",
                                  "crl",
                                  "governance",
                                  "permissions"}) {
        std::string other = text;
        other.insert(other.find("\n" + key + " =") + 1, "x_");
        EXPECT_FALSE(parse_bundle(other, "a.bundle")) << key;
    }
}

TEST(DamagedBundle, IsRefusedWithOtherValues) {
    const std::string text = bundle_text(a_world().bundle("bob"));
    for (const auto& [from, to] : {std::pair{"format = 1", "format = 0"},
                                   {"format = 1", "format = \"1\""},
                                   {"kind = \"viewer\"", "kind = \"king\""},
                                   {"kind = \"viewer\"", "kind = \"site\""},
                                   {"name = \"bob\"", "name = \"../bob\""},
                                   {"world = \"playroom\"", "world = \"*\""},
                                   {"rights = \"push+grab\"", "rights = \"grab+push\""},
                                   {"crl = '''", "crl = 5 #"},
                                   {"private_key = '''", "private_key = ['''"}}) {
        std::string changed = text;
        ASSERT_NE(changed.find(from), std::string::npos) << from;
        changed.replace(changed.find(from), std::string(from).size(), to);
        const auto parsed = parse_bundle(changed, "a.bundle");
        ASSERT_FALSE(parsed) << to;
        expect_no_secret(parsed.error().message, a_world().bundle("bob"));
    }
    std::string newer = text;
    newer.replace(newer.find("format = 1"), 10, "format = 2");
    EXPECT_THAT(parse_bundle(newer, "a.bundle").error().message, HasSubstr("newer version"));
}

// PEM readers skip what they do not know: a second certificate would go unnoticed.
TEST(DamagedBundle, IsRefusedWithMoreThanOneObjectInAText) {
    const Bundle alice = a_world().bundle("alice");
    for (std::string Bundle::*part : {&Bundle::identity_ca,
                                      &Bundle::permissions_ca,
                                      &Bundle::certificate,
                                      &Bundle::private_key,
                                      &Bundle::crl}) {
        for (const std::string& more :
             {alice.certificate, std::string("\n"), std::string("note\n")}) {
            Bundle changed = alice;
            changed.*part += more;
            EXPECT_FALSE(check(changed, kNow));
            changed.*part = more + alice.*part;
            EXPECT_FALSE(check(changed, kNow));
        }
        Bundle empty = alice;
        (empty.*part).clear();
        EXPECT_FALSE(check(empty, kNow));
    }
}

}  // namespace
}  // namespace atrium::keys
