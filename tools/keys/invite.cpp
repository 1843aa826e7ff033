#include "core/keys/private_file.hpp"
#include "tools/keys/commands.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::keys_tool {
namespace {

using keys::KeyStore;
using keys::Kind;
using keys::Member;

// Adds the member, unless there is one of that name and kind, and the world server, which is the
// hub. Says what it added.
Expected<std::string> add_missing(KeyStore& store,
                                  const Member& member,
                                  const Options& options,
                                  Timestamp now) {
    std::string said;
    const auto entries = store.entries(now);
    if (!entries) return tl::unexpected(entries.error());
    const int days = options.days.value_or(keys::kMemberDays);
    const auto add = [&](const Member& added) -> Expected<void> {
        const auto entry = store.add(added, days, now);
        if (!entry) return tl::unexpected(entry.error());
        said += "added " + described(*entry) + "\n";
        return {};
    };
    const bool has_world_server = std::ranges::any_of(
        *entries, [](const keys::Entry& entry) { return entry.member.kind == Kind::kWorld; });
    if (!has_world_server && member.kind != Kind::kWorld) {
        if (auto added = add({store.world(), Kind::kWorld, store.world(), {}}); !added)
            return tl::unexpected(added.error());
    }
    const auto known = std::ranges::find_if(*entries, [&](const keys::Entry& entry) {
        return entry.member.name == member.name && entry.member.kind == member.kind;
    });
    if (known == entries->end()) {
        if (auto added = add(member); !added) return tl::unexpected(added.error());
    } else if (options.rights && known->member.rights != member.rights) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format(
                "{} has other rights; run `{}` before",
                keys::describe(known->member),
                command(options,
                        fmt::format("renew {} --rights {}", member.name, *options.rights))));
    }
    return said;
}

// No --replace helps against a member of another kind.
Expected<void> check_name(const KeyStore& store, const Member& member, Timestamp now) {
    const auto entries = store.entries(now);
    if (!entries) return tl::unexpected(entries.error());
    for (const keys::Entry& other : *entries) {
        if (other.member.name != member.name || other.member.kind == member.kind) continue;
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("the name {} is taken by a {}; choose another one",
                                      member.name,
                                      keys::kind_text(other.member.kind)));
    }
    return {};
}

std::string program_of(Kind kind) {
    switch (kind) {
        case Kind::kSite:
            return "atrium site --config FILE";
        case Kind::kViewer:
            return "atrium viewer";
        case Kind::kWorld:
            return "atrium world --config FILE";
        case Kind::kMonitor:
            break;
    }
    return "atrium monitor";
}

}  // namespace

Expected<Outcome> invite(const Options& options, Timestamp now) {
    if (const auto fine = member_of(options, "world"); !fine) return tl::unexpected(fine.error());
    if (auto fine = check_output(options); !fine) return tl::unexpected(fine.error());
    std::string hub;
    if (!options.hub.empty()) {
        const auto parsed = keys::parse_hub(options.hub);
        if (!parsed) return tl::unexpected(parsed.error());
        hub = *parsed;
    }
    auto store = open_store(options, KeyStore::Access::kWrite);
    if (!store) return tl::unexpected(store.error());
    const auto member = member_of(options, store->world());
    if (!member) return tl::unexpected(member.error());
    // before anything is added
    if (hub.empty() && store->hub().empty())
        return make_error(ErrorKind::kConfiguration,
                          "the tunnel has no hub yet: give the address of the world server's host, "
                          "as others reach it over the internet, with --hub HOST");
    if (auto fine = check_name(*store, *member, now); !fine) return tl::unexpected(fine.error());
    const auto file = options.output.empty() ? std::filesystem::path(member->name + ".invitation")
                                             : options.output;
    std::error_code ignored;
    if (!options.replace && std::filesystem::exists(file, ignored))
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: exists already; add --replace to overwrite it, or give "
                                      "another file with -o",
                                      file.string()));
    const auto said = add_missing(*store, *member, options, now);
    if (!said) return tl::unexpected(said.error());
    // before it has a place: the hub would let a revoked member in
    auto bundle = store->bundle(member->name);
    if (!bundle) return tl::unexpected(bundle.error());
    if (const auto usable = keys::check(*bundle, now); !usable)
        return make_error(usable.error().kind,
                          keys::describe(bundle->member) + ": " + usable.error().message);
    if (auto placed = store->add_place(member->name, hub); !placed)
        return tl::unexpected(placed.error());
    bundle = store->bundle(member->name);
    if (!bundle) return tl::unexpected(bundle.error());
    if (auto written =
            keys::write_private_file(file, keys::bundle_text(*bundle), keys::Existing::kReplace);
        !written)
        return tl::unexpected(written.error());
    const keys::Tunnel& tunnel = *bundle->tunnel;
    const std::string text = fmt::format("{}wrote {}: keys and tunnel of {}\n",
                                         *said,
                                         file.string(),
                                         keys::describe(bundle->member));
    if (tunnel.is_hub())
        return Outcome{
            fmt::format("{}It is secret. On the host of the world server, {}, which must "
                        "let in UDP port {}:\n"
                        "  sudo atrium tunnel up {}\n"
                        "  {} --join {}\n",
                        text,
                        tunnel.hub.substr(0, tunnel.hub.find(':')),
                        keys::port_of_hub(tunnel.hub),
                        file.filename().string(),
                        program_of(member->kind),
                        file.filename().string())};
    const std::string& hub_name = tunnel.places.front().name;
    const std::string hub_file = hub_name + ".invitation";
    return Outcome{
        fmt::format("{}It is secret: bring it only to {}, for example with scp -p, and delete it "
                    "here. There:\n"
                    "  sudo atrium tunnel up {}\n"
                    "  {} --join {}\n"
                    "The world server's host, {}, must know of the new place and let in UDP port "
                    "{}. Its file, to bring there:\n"
                    "  {}\n"
                    "and there:\n"
                    "  sudo atrium tunnel up {}\n"
                    "  {} --join {}\n",
                    text,
                    member->name,
                    file.filename().string(),
                    program_of(member->kind),
                    file.filename().string(),
                    tunnel.hub.substr(0, tunnel.hub.find(':')),
                    keys::port_of_hub(tunnel.hub),
                    command(options, fmt::format("export {} -o {} --replace", hub_name, hub_file)),
                    hub_file,
                    program_of(Kind::kWorld),
                    hub_file)};
}

}  // namespace atrium::keys_tool
