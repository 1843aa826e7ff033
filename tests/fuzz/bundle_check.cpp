#include "core/keys/bundle.hpp"
#include "core/keys/documents.hpp"
#include "core/keys/permissions.hpp"
#include "tests/fuzz/file_check.hpp"

namespace atrium::test {
namespace {

// 2027-01-15. The seeds are valid for a hundred years from then on.
constexpr Timestamp kBundleNow{1'800'000'000'000'000'000};

bool same_bundle(const keys::Bundle& a, const keys::Bundle& b) {
    return a.member == b.member && a.identity_ca == b.identity_ca &&
           a.permissions_ca == b.permissions_ca && a.certificate == b.certificate &&
           a.private_key == b.private_key && a.crl == b.crl && a.governance == b.governance &&
           a.permissions == b.permissions;
}

}  // namespace

std::string check_bundle_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    const std::string text(bytes.begin(), bytes.end());
    const auto bundle = keys::parse_bundle(text, "a.bundle");
    was_accepted = bundle.has_value();
    if (!bundle) {
        if (bundle.error().kind != ErrorKind::kInvalidData) return "another kind of error";
        return bundle.error().message.starts_with("a.bundle: ") ? "" : "an error without the file";
    }
    if (!keys::check(bundle->member)) return "an invalid member";
    const auto again = keys::parse_bundle(keys::bundle_text(*bundle), "b.bundle");
    if (!again) return "refuses what it accepted: " + again.error().message;
    if (!same_bundle(*bundle, *again)) return "another bundle on the way back";
    const auto validity = keys::check(*bundle, kBundleNow);
    if (!validity)
        return validity.error().kind == ErrorKind::kInvalidData ? "" : "another kind of error";
    if (validity->end <= kBundleNow || validity->begin > kBundleNow) return "a time";
    const auto xml = keys::verify_document(bundle->permissions, bundle->permissions_ca);
    if (!xml || !keys::check_permissions_xml(*xml, bundle->member)) return "the permissions";
    return "";
}

}  // namespace atrium::test
