#include "core/keys/documents.hpp"

#include "core/keys/permissions.hpp"
#include "tests/unit/keys/a_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::keys {
namespace {

using namespace keys::testing;
using ::testing::HasSubstr;

class Documents : public ::testing::Test {
protected:
    Validity validity_ = validity_from(kNow, 100);
    KeyPair identity_ = value(make_authority(Authority::kIdentity, "playroom", validity_));
    KeyPair permissions_ = value(make_authority(Authority::kPermissions, "playroom", validity_));
};

TEST_F(Documents, ComeBackAsTheyWereSigned) {
    const std::string text = governance_xml();
    const std::string document = value(sign_document(text, permissions_));
    EXPECT_EQ(value(verify_document(document, permissions_.certificate)), text);
    EXPECT_THAT(document, HasSubstr("MIME-Version: 1.0"));
    EXPECT_EQ(document.find('\r'), std::string::npos);
    EXPECT_EQ(document.find('\''), std::string::npos);  // TOML ends its strings there
}

TEST_F(Documents, AreRefusedIfAnotherAuthoritySignedThem) {
    const std::string document = value(sign_document(governance_xml(), permissions_));
    EXPECT_FALSE(verify_document(document, identity_.certificate));
    const KeyPair other = value(make_authority(Authority::kPermissions, "playroom", validity_));
    EXPECT_FALSE(verify_document(document, other.certificate));
}

TEST_F(Documents, AreRefusedIfAMemberSignedThem) {
    const Member eve{"playroom", Kind::kViewer, "eve", Rights::all()};
    // certified by the one authority and by the other
    for (const KeyPair& authority : {identity_, permissions_}) {
        const KeyPair keys = value(make_certificate(authority, eve, validity_));
        const std::string document = value(sign_document(permissions_xml(eve, validity_), keys));
        const auto verified = verify_document(document, permissions_.certificate);
        ASSERT_FALSE(verified);
        EXPECT_THAT(verified.error().message,
                    HasSubstr("is not signed by the permissions authority"));
        EXPECT_TRUE(verify_document(document, keys.certificate));
    }
}

TEST_F(Documents, AreRefusedIfTheTextWasChanged) {
    const std::string document = value(sign_document(governance_xml(), permissions_));
    for (const auto& [from, to] : {std::pair{"ENCRYPT", "DECRYPT"},
                                   {"<max>230", "<max>231"},
                                   {">false<", ">true<"},
                                   {"text/plain", "text/html"}}) {
        std::string changed = document;
        ASSERT_NE(changed.find(from), std::string::npos) << from;
        changed.replace(changed.find(from), std::string(from).size(), to);
        EXPECT_FALSE(verify_document(changed, permissions_.certificate)) << from;
    }
}

TEST_F(Documents, AreRefusedWithoutASignature) {
    for (const char* text :
         {"", "text", "Content-Type: text/plain\n\ntext\n", "MIME-Version: 1.0\n\n"})
        EXPECT_FALSE(verify_document(text, permissions_.certificate)) << text;
    EXPECT_FALSE(verify_document(value(sign_document("a\n", permissions_)), "no certificate"));
    EXPECT_FALSE(sign_document("a\n", {"no", "key"}));
}

TEST_F(Documents, MayBeOfAnyLength) {
    for (const std::size_t length : {std::size_t{0},
                                     std::size_t{1},
                                     std::size_t{1023},
                                     std::size_t{1024},
                                     std::size_t{1025},
                                     std::size_t{70000}}) {
        const std::string text = std::string(length, 'a') + "\nb\n";
        const std::string document = value(sign_document(text, permissions_));
        EXPECT_EQ(value(verify_document(document, permissions_.certificate)), text) << length;
    }
}

TEST_F(Documents, LeaveNoErrorsToOtherUsersOfOpenSsl) {
    // a private key that is none makes OpenSSL ask for a password unless it is told not to
    EXPECT_FALSE(sign_document("a\n",
                               {permissions_.certificate,
                                "-----BEGIN ENCRYPTED PRIVATE KEY-----\nMIGbMFcGCSqGSIb3DQEF\n"
                                "-----END ENCRYPTED PRIVATE KEY-----\n"}));
}

}  // namespace
}  // namespace atrium::keys
