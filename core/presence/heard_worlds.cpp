#include "core/presence/heard_worlds.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

namespace atrium::presence {
namespace {

constexpr std::size_t kMaxListed = 8;

std::string counted(std::size_t num, const char* what) {
    return fmt::format("{} {}{}", num, what, num == 1 ? "" : "s");
}

}  // namespace

std::vector<HeardWorld> worlds_of(std::span<const bus::HeardProgram> programs) {
    std::map<std::string, HeardWorld> by_name;
    for (const auto& [world, presence] : programs) {
        if (!presence.is_holder) continue;
        HeardWorld& heard = by_name[world];
        heard.name = world;
        if (presence.kind == bus::ProgramKind::kWorldServer)
            heard.servers.push_back(presence.host);
        else if (presence.kind == bus::ProgramKind::kSiteNode)
            heard.sites.push_back(presence.name);
        else if (presence.kind == bus::ProgramKind::kViewer)
            ++heard.num_viewers;
        else
            ++heard.num_others;
    }
    std::vector<HeardWorld> worlds;
    for (auto& [name, world] : by_name) {
        std::ranges::sort(world.servers);
        std::ranges::sort(world.sites);
        worlds.push_back(std::move(world));
    }
    return worlds;
}

std::string describe(const HeardWorld& world) {
    std::string text = world.servers.empty()
                           ? "no world server"
                           : fmt::format("world server on {}", fmt::join(world.servers, " and "));
    text += ", " + counted(world.sites.size(), "site");
    const std::size_t num = std::min(world.sites.size(), kMaxListed);
    const std::vector<std::string> first(world.sites.begin(),
                                         world.sites.begin() + static_cast<std::ptrdiff_t>(num));
    if (num > 0) text += fmt::format(": {}", fmt::join(first, ", "));
    if (num < world.sites.size()) text += ", ...";
    if (world.num_viewers > 0) text += "; " + counted(world.num_viewers, "viewer");
    if (world.num_others > 0) text += "; " + counted(world.num_others, "other program");
    return text;
}

}  // namespace atrium::presence
