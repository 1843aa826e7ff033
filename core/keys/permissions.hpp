#pragma once

#include "core/base/expected.hpp"
#include "core/keys/member.hpp"
#include "core/keys/validity.hpp"

#include <string>
#include <string_view>

/// The XML documents of DDS Security 1.1, unsigned.
namespace atrium::keys {

/// The governance, equal for all worlds: only authenticated participants, all of RTPS encrypted
/// with origin authentication, access control on all topics, in the domains 0 to 230.
std::string governance_xml();

/// What a member may write and read, from the table in topics.hpp; all else is denied.
std::string permissions_xml(const Member& member, Validity validity);

/// The validity that permissions state. Fails with kInvalidData if the text is not what
/// `permissions_xml` makes of this member and validity, for example because it was made by another
/// version of Atrium with other topics.
Expected<Validity> check_permissions_xml(std::string_view xml, const Member& member);

}  // namespace atrium::keys
