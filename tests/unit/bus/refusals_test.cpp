#include "core/bus/authentication.hpp"
#include "core/bus/authentication_internal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>

namespace atrium::bus {
namespace {

TEST(Refusals, HaveReasonsInPlainWords) {
    const auto of_openssl = [](const std::string& error) {
        return authentication::plain_reason("Certificate not valid: error: " + error +
                                            "; subject: /O=kitchen/OU=viewer/CN=bob");
    };
    EXPECT_EQ(of_openssl("unable to get local issuer certificate"),
              "its key is of another key store");
    EXPECT_EQ(of_openssl("certificate signature failure"), "its key is of another key store");
    EXPECT_EQ(of_openssl("certificate revoked"), "its key is revoked");
    EXPECT_EQ(of_openssl("certificate has expired"), "its key has expired");
    EXPECT_EQ(authentication::plain_reason("another"), "another");
}

TEST(Refusals, AreKnownByParticipant) {
    dds_guid_t bob{};
    bob.v[0] = 0x12;
    bob.v[11] = 0x34;
    dds_guid_t carol = bob;
    carol.v[11] = 0x35;
    EXPECT_EQ(refusal_of(bob), "");
    {
        const std::lock_guard lock(authentication::process().mutex);
        authentication::note_refusal(
            authentication::guid_text(bob.v), "viewer bob", "its key is revoked");
    }
    bob.v[15] = 0xc1;  // beyond the prefix
    EXPECT_EQ(refusal_of(bob), "its key is revoked (viewer bob)");
    EXPECT_EQ(refusal_of(carol), "");
}

}  // namespace
}  // namespace atrium::bus
