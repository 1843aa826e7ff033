#include "core/keys/bundle.hpp"

#include "core/config/table_reader.hpp"
#include "core/keys/certificates.hpp"
#include "core/keys/documents.hpp"
#include "core/keys/permissions.hpp"
#include "core/keys/private_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace atrium::keys {
namespace {

constexpr int kBundleFormat = 1;
constexpr std::string_view kFirstWords = "# Keys of ";

struct TextField {
    const char* key;
    std::string Bundle::*text;
};
constexpr std::array<TextField, 7> kTextFields{{{"identity_ca", &Bundle::identity_ca},
                                                {"permissions_ca", &Bundle::permissions_ca},
                                                {"certificate", &Bundle::certificate},
                                                {"private_key", &Bundle::private_key},
                                                {"crl", &Bundle::crl},
                                                {"governance", &Bundle::governance},
                                                {"permissions", &Bundle::permissions}}};

tl::unexpected<Error> unusable(const std::string& why) {
    return make_error(ErrorKind::kInvalidData, why);
}

std::string export_again(const Member& member) {
    return fmt::format("; run `atrium keys export {} -o FILE` again", member.name);
}

// The signed text, without line ends after it.
Expected<std::string> signed_text(const Bundle& bundle,
                                  const std::string& document,
                                  std::string_view what) {
    auto text = verify_document(document, bundle.permissions_ca);
    if (!text)
        return unusable(
            fmt::format("{} {}{}", what, text.error().message, export_again(bundle.member)));
    text->resize(text->find_last_not_of('\n') + 1);
    return text;
}

Expected<Validity> check_permissions(const Bundle& bundle, Timestamp now) {
    const Member& member = bundle.member;
    const auto xml = signed_text(bundle, bundle.permissions, "the document of the permissions");
    if (!xml) return tl::unexpected(xml.error());
    auto validity = check_permissions_xml(*xml, member);
    const std::string renew = fmt::format("run `atrium keys renew {}` and export it", member.name);
    if (!validity) return unusable(validity.error().message + ": " + renew);
    if (now < validity->begin)
        return unusable("the permissions are valid from " + time_text(validity->begin) +
                        ": is the clock right?");
    if (now >= validity->end)
        return unusable("the permissions have expired on " + day_text(validity->end) + ": " +
                        renew);
    return validity;
}

}  // namespace

std::string bundle_text(const Bundle& bundle) {
    const Member& member = bundle.member;
    std::string text = fmt::format(
        "{}{}. Secret: with them anybody can join as this member.\n\nformat = {}\nworld = "
        "\"{}\"\nkind = \"{}\"\nname = \"{}\"\nrights = \"{}\"\n",
        kFirstWords,
        describe(member),
        kBundleFormat,
        member.world,
        kind_text(member.kind),
        member.name,
        rights_text(member.rights));
    // PEM and S/MIME texts have no apostrophes
    for (const TextField& field : kTextFields)
        text += fmt::format("\n{} = '''\n{}'''\n", field.key, bundle.*field.text);
    if (bundle.tunnel) text += tunnel_text(*bundle.tunnel);
    return text;
}

Expected<Bundle> parse_bundle(const std::string& text, const std::string& name) {
    // errors of TOML quote the text, which has a private key in it
    const auto damaged = [&](const std::string& why) {
        return make_error(
            ErrorKind::kInvalidData,
            name + ": " + why + "; it must be the unchanged file that `atrium keys export` wrote");
    };
    auto reader = config::TableReader::parse(text, name);
    if (!reader) return damaged("is no bundle of keys, or was cut off");
    Bundle bundle;
    std::int64_t format = 0;
    std::string kind;
    std::string rights;
    reader->read("format", format);
    reader->read("world", bundle.member.world);
    reader->read("kind", kind);
    reader->read("name", bundle.member.name);
    reader->read("rights", rights);
    for (const TextField& field : kTextFields) reader->read(field.key, bundle.*field.text);
    Expected<void> tunnel_is_fine;
    if (reader->has("tunnel")) {
        config::TableReader table = reader->table("tunnel");
        auto tunnel = read_tunnel(table);
        if (tunnel) {
            bundle.tunnel = std::move(*tunnel);
        } else {
            tunnel_is_fine = tl::unexpected(tunnel.error());
        }
    }
    if (format > kBundleFormat)
        return make_error(
            ErrorKind::kInvalidData,
            name + ": was made by a newer version of Atrium; install that version here");
    if (!reader->finish() || format != kBundleFormat)
        return damaged("is no bundle of keys, or was changed");
    for (const TextField& field : kTextFields) {
        const std::string& value = bundle.*field.text;
        if (value.empty()) return damaged(fmt::format("has no {}", field.key));
        const bool is_text = std::ranges::all_of(
            value, [](char c) { return c == '\n' || c == '\t' || (c >= ' ' && c <= '~'); });
        if (!is_text) return damaged(fmt::format("has a damaged {}", field.key));
    }
    if (!tunnel_is_fine) return damaged(tunnel_is_fine.error().message);
    if (bundle.tunnel && bundle.tunnel->name != bundle.member.name)
        return damaged("has the tunnel of another member");
    const auto known_kind = find_kind(kind);
    const auto known_rights = rights_of_text(rights);
    if (!known_kind) return damaged("has no kind of member that is known");
    if (!known_rights) return damaged("has damaged rights");
    bundle.member.kind = *known_kind;
    bundle.member.rights = *known_rights;
    if (auto fine = check(bundle.member); !fine) return damaged(fine.error().message);
    return bundle;
}

bool is_bundle(const std::string& text) {
    return text.starts_with(kFirstWords) || parse_bundle(text, {}).has_value();
}

Expected<Bundle> read_bundle(const std::filesystem::path& file) {
    const auto text = read_private_file(file, kMaxBundleBytes, is_bundle);
    if (!text) return tl::unexpected(text.error());
    return parse_bundle(*text, file.string());
}

Expected<Validity> check(const Bundle& bundle, Timestamp now) {
    const Member& member = bundle.member;
    if (auto fine = check(member); !fine) return unusable(fine.error().message);
    Validity all{Timestamp{0}, Timestamp{std::numeric_limits<std::int64_t>::max()}};
    const auto narrow = [&](const Validity& part) {
        all.begin = std::max(all.begin, part.begin);
        all.end = std::min(all.end, part.end);
    };
    const std::pair<Authority, const std::string&> authorities[] = {
        {Authority::kIdentity, bundle.identity_ca},
        {Authority::kPermissions, bundle.permissions_ca}};
    for (const auto& [authority, certificate] : authorities) {
        const auto validity = check_authority(authority, certificate, member.world, now);
        if (!validity) return tl::unexpected(validity.error());
        narrow(*validity);
    }
    const auto certified =
        check_certificate(bundle.certificate, member, bundle.identity_ca, bundle.crl, now);
    if (!certified) return tl::unexpected(certified.error());
    narrow(*certified);
    if (auto fine = check_key(bundle.private_key, bundle.certificate); !fine)
        return unusable(fine.error().message + export_again(member));
    const auto governance = signed_text(bundle, bundle.governance, "the governance");
    if (!governance) return tl::unexpected(governance.error());
    if (*governance + "\n" != governance_xml())
        return unusable(
            "the governance is not that of this version of Atrium: use the version that made "
            "these keys, or make new ones with `atrium keys init`");
    const auto permitted = check_permissions(bundle, now);
    if (!permitted) return permitted;
    narrow(*permitted);
    return all;
}

}  // namespace atrium::keys
