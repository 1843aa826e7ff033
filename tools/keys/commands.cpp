#include "tools/keys/commands.hpp"

#include "core/config/spelling.hpp"
#include "core/keys/private_file.hpp"
#include "tools/keys/find_store.hpp"
#include "tools/keys/listing.hpp"
#include "tools/keys/next_steps.hpp"

#include <fmt/format.h>

namespace atrium::keys_tool {
namespace {

namespace fs = std::filesystem;
using keys::Entry;
using keys::KeyStore;
using keys::Kind;
using keys::Member;
using keys::Rights;
using keys::State;

tl::unexpected<Error> missing(const std::string& what) {
    return make_error(ErrorKind::kConfiguration, what);
}

Expected<std::optional<Rights>> rights_of(const Options& options) {
    if (!options.rights) return std::optional<Rights>();
    return keys::parse_rights(*options.rights).map([](Rights rights) {
        return std::optional(rights);
    });
}

std::string days_left(Timestamp end, Timestamp now) {
    const auto days = (end - now) / std::chrono::hours(24);
    return fmt::format("{} day{}", days, days == 1 ? "" : "s");
}

// The place that an invitation has; a bundle for the same network has none.
std::string tunnel_line(const keys::Bundle& bundle) {
    if (!bundle.tunnel) return "none";
    const keys::Tunnel& tunnel = *bundle.tunnel;
    if (tunnel.is_hub())
        return fmt::format("{}, the hub of {} other place{}, which they reach at {}",
                           tunnel.own().address,
                           tunnel.places.size() - 1,
                           tunnel.places.size() == 2 ? "" : "s",
                           tunnel.hub);
    return fmt::format("{}, through the hub {}", tunnel.own().address, tunnel.hub);
}

Outcome check_store(const fs::path& folder, const Options& options, Timestamp now) {
    const std::vector<std::string> problems = keys::problems_of_store(folder, now);
    std::string text;
    for (const std::string& problem : problems) text += problem + "\n";
    if (!problems.empty()) return {text, 1};
    const auto store = KeyStore::open(folder, KeyStore::Access::kRead);
    if (!store) return {store.error().message + "\n", 1};
    const auto entries = store->entries(now);
    if (!entries) return {entries.error().message + "\n", 1};
    for (const Entry& entry : *entries) {
        if (entry.state != State::kExpiresSoon && entry.state != State::kExpired) continue;
        text += fmt::format("{}: {} ({}); run `{}`\n",
                            keys::describe(entry.member),
                            keys::state_text(entry.state),
                            keys::day_text(entry.validity.end),
                            command(options, "renew " + entry.member.name));
    }
    text +=
        fmt::format("{}: the keys of world {} are sound; {} member{}, the authorities until {}\n",
                    folder.string(),
                    store->world(),
                    entries->size(),
                    entries->size() == 1 ? "" : "s",
                    keys::day_text(store->end()));
    return {text, 0};
}

}  // namespace

Expected<KeyStore> open_store(const Options& options, KeyStore::Access access) {
    const auto folder = find_store(options.keys);
    if (!folder) return tl::unexpected(folder.error());
    return KeyStore::open(*folder, access);
}

std::string command(const Options& options, const std::string& rest) {
    const std::string folder =
        options.keys.empty() ? "" : fmt::format(" --keys '{}'", options.keys.string());
    return "atrium keys " + rest + folder;
}

Expected<void> check_output(const Options& options) {
    if (options.output != "-") return {};
    return missing("-o -: keys are secret and are not printed; give a file");
}

std::string described(const Entry& entry) {
    const std::string rights = shown_rights(entry.member);
    return keys::describe(entry.member) + (rights == "-" ? "" : " with the rights " + rights) +
           ", valid until " + keys::day_text(entry.validity.end);
}

Expected<Member> member_of(const Options& options, const std::string& world) {
    const auto kind = keys::find_kind(options.kind);
    if (options.kind.empty()) return missing("KIND is missing: site, viewer, world or monitor");
    if (!kind)
        return missing("KIND: " + config::must_be_one_of({"site", "viewer", "world", "monitor"},
                                                         options.kind));
    if (options.name.empty() && *kind != Kind::kWorld)
        return missing(fmt::format("NAME is missing: that of the {}", options.kind));
    const auto rights = rights_of(options);
    if (!rights) return tl::unexpected(rights.error());
    Member member{world, *kind, options.name.empty() ? world : options.name, {}};
    if (*kind == Kind::kViewer) member.rights = {keys::Right::kGrab, keys::Right::kPush};
    if (*rights) member.rights = **rights;
    return member;
}

Expected<Outcome> init(const Options& options, Timestamp now) {
    if (options.name.empty()) return missing("WORLD is missing: the name of the world");
    if (auto fine = keys::check_key_name(options.name, "the world"); !fine)
        return tl::unexpected(fine.error());
    const fs::path folder = options.keys.empty() ? fs::path(options.name + ".keys") : options.keys;
    const auto store =
        KeyStore::create(folder, options.name, options.days.value_or(keys::kAuthorityDays), now);
    if (!store) return tl::unexpected(store.error());
    return Outcome{
        fmt::format("made the keys of world {} in {}, valid until {}\n"
                    "Keep the folder secret, and a copy of it elsewhere: without it no "
                    "member can be added, renewed or revoked.\n"
                    "next: {}\n",
                    options.name,
                    folder.string(),
                    keys::day_text(store->end()),
                    command(options, "add site NAME, add viewer NAME, add world"))};
}

Expected<Outcome> add(const Options& options, Timestamp now) {
    // what is wrong with the options, without a store
    if (const auto fine = member_of(options, "world"); !fine) return tl::unexpected(fine.error());
    auto store = open_store(options, KeyStore::Access::kWrite);
    if (!store) return tl::unexpected(store.error());
    const auto member = member_of(options, store->world());
    if (!member) return tl::unexpected(member.error());
    const auto entry = store->add(*member, options.days.value_or(keys::kMemberDays), now);
    if (!entry) return tl::unexpected(entry.error());
    const auto bundle = store->bundle(member->name);
    if (!bundle) return tl::unexpected(bundle.error());
    return Outcome{
        fmt::format("added {}\nnext: {}\n", described(*entry), export_command(options, *bundle))};
}

Expected<Outcome> list(const Options& options, Timestamp now) {
    const auto store = open_store(options, KeyStore::Access::kRead);
    if (!store) return tl::unexpected(store.error());
    const auto entries = store->entries(now);
    if (!entries) return tl::unexpected(entries.error());
    return Outcome{options.json ? list_json(store->world(), *entries)
                                : list_text(store->world(), *entries)};
}

Expected<Outcome> revoke(const Options& options, Timestamp now) {
    if (options.name.empty()) return missing("NAME is missing: that of a member");
    const auto reason = keys::find_reason(options.reason);
    if (!reason || *reason == keys::Reason::kReplaced)
        return missing("reason: " + config::must_be_one_of({"lost", "left"}, options.reason));
    auto store = open_store(options, KeyStore::Access::kWrite);
    if (!store) return tl::unexpected(store.error());
    const auto before = store->bundle(options.name);  // with its place in the tunnel
    if (!before) return tl::unexpected(before.error());
    const auto entry = store->revoke(options.name, *reason, now);
    if (!entry) return tl::unexpected(entry.error());
    return Outcome{fmt::format("revoked {} ({})\n{}",
                               keys::describe(entry->member),
                               keys::reason_text(*reason),
                               steps_after_revocation(options, *store, *before, now))};
}

Expected<Outcome> renew(const Options& options, Timestamp now) {
    if (options.name.empty()) return missing("NAME is missing: that of a member");
    const auto rights = rights_of(options);
    if (!rights) return tl::unexpected(rights.error());
    auto store = open_store(options, KeyStore::Access::kWrite);
    if (!store) return tl::unexpected(store.error());
    const auto entry =
        store->renew(options.name, *rights, options.days.value_or(keys::kMemberDays), now);
    if (!entry) return tl::unexpected(entry.error());
    const auto bundle = store->bundle(options.name);
    if (!bundle) return tl::unexpected(bundle.error());
    return Outcome{fmt::format(
        "renewed {}\n{}", described(*entry), steps_after_renewal(options, *store, *bundle, now))};
}

Expected<Outcome> export_bundle(const Options& options, Timestamp now) {
    if (options.name.empty()) return missing("NAME is missing: that of a member");
    if (options.output.empty()) return missing("-o is missing: the file to write");
    if (auto fine = check_output(options); !fine) return tl::unexpected(fine.error());
    const auto store = open_store(options, KeyStore::Access::kRead);
    if (!store) return tl::unexpected(store.error());
    const auto bundle = store->bundle(options.name);
    if (!bundle) return tl::unexpected(bundle.error());
    if (const auto usable = keys::check(*bundle, now); !usable)
        return make_error(usable.error().kind,
                          keys::describe(bundle->member) + ": " + usable.error().message);
    const auto existing = options.replace ? keys::Existing::kReplace : keys::Existing::kKeep;
    if (auto written =
            keys::write_private_file(options.output, keys::bundle_text(*bundle), existing);
        !written)
        return tl::unexpected(written.error());
    return Outcome{
        fmt::format("wrote {}: the keys{} of {}\n{}"
                    "It is secret: bring it only to the host of {}, for example with "
                    "scp -p, and delete it here.\n",
                    options.output.string(),
                    bundle->tunnel ? " and the tunnel" : "",
                    keys::describe(bundle->member),
                    without_tunnel(options, *store, *bundle),
                    options.name)};
}

Expected<Outcome> check(const Options& options, Timestamp now) {
    if (options.bundle.empty()) {
        const auto folder = find_store(options.keys);
        if (!folder) return tl::unexpected(folder.error());
        if (!keys::is_key_store(*folder)) {  // something missing is not a wrong store
            const auto store = KeyStore::open(*folder, KeyStore::Access::kRead);
            if (!store) return tl::unexpected(store.error());
        }
        return check_store(*folder, options, now);
    }
    const auto bundle = keys::read_bundle(options.bundle);
    if (!bundle) {
        if (bundle.error().kind == ErrorKind::kNotFound) return tl::unexpected(bundle.error());
        return Outcome{bundle.error().message + "\n", 1};
    }
    const auto usable = keys::check(*bundle, now);
    if (!usable)
        return Outcome{fmt::format("{}: {}: {}\n",
                                   options.bundle.string(),
                                   keys::describe(bundle->member),
                                   usable.error().message),
                       1};
    // the list in a bundle may be older than that of the key store, if one is here
    std::string list = "its own list only; where the key store is, the newest";
    if (const auto folder = find_store(options.keys)) {
        const auto store = KeyStore::open(*folder, KeyStore::Access::kRead);
        if (!store && !options.keys.empty()) return tl::unexpected(store.error());
        const auto own = store ? store->bundle(bundle->member.name) : Expected<keys::Bundle>();
        if (store && own && own->identity_ca == bundle->identity_ca) {
            const auto entry = store->entry_of(*bundle, now);
            if (!entry) return tl::unexpected(entry.error());
            if (entry->state == keys::State::kRevoked)
                return Outcome{fmt::format("{}: {}: the key is revoked, says {}\n",
                                           options.bundle.string(),
                                           keys::describe(bundle->member),
                                           folder->string()),
                               1};
            list = "no, says " + folder->string();
        }
    }
    return Outcome{
        fmt::format("{}: usable\nmember       {} {}\nworld        {}\nrights       {}\n"
                    "valid until  {} ({})\nrevoked      {}\ntunnel       {}\n",
                    options.bundle.string(),
                    keys::kind_text(bundle->member.kind),
                    bundle->member.name,
                    bundle->member.world,
                    shown_rights(bundle->member),
                    keys::time_text(usable->end),
                    days_left(usable->end, now),
                    list,
                    tunnel_line(*bundle))};
}

}  // namespace atrium::keys_tool
