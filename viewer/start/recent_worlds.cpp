#include "viewer/start/recent_worlds.hpp"

#include "core/app/log.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "core/config/table_reader.hpp"
#include "viewer/config/user_files.hpp"

#include <fmt/format.h>

#include <utility>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;

bool is_same(const bus::BusOptions& a, const bus::BusOptions& b) {
    return a.world == b.world && a.domain == b.domain && a.network == b.network &&
           a.peers == b.peers && a.interface == b.interface;
}

Expected<std::vector<bus::BusOptions>> read_worlds(const fs::path& file) {
    std::vector<bus::BusOptions> worlds;
    std::error_code failure;
    if (file.empty() || !fs::exists(file, failure)) return worlds;
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    for (config::TableReader& table : reader->tables("world")) {
        bus::BusOptions world;
        table.require("name");
        table.read("name", world.world);
        table.read("domain", world.domain, {0, bus::kMaxDomain});
        table.read("network", world.network);
        table.read("peers", world.peers);
        table.read("interface", world.interface);
        if (!bus::is_valid_name(world.world))
            table.reject("name", "must have 1 to 63 characters of [A-Za-z0-9_.-]");
        if (worlds.size() < RecentWorlds::kMax) worlds.push_back(std::move(world));
    }
    if (auto read = reader->finish(); !read) return tl::unexpected(read.error());
    return worlds;
}

}  // namespace

RecentWorlds::RecentWorlds(fs::path file) : file_(std::move(file)) {
    auto worlds = read_worlds(file_);
    if (worlds) {
        worlds_ = std::move(*worlds);
        return;
    }
    app::log::warn("recent_worlds_unreadable reason=\"{}\"; kept as {}.damaged",
                   worlds.error().message,
                   file_.string());
    keep_damaged(file_);
}

Expected<void> RecentWorlds::add(const bus::BusOptions& world) {
    std::erase_if(worlds_, [&](const bus::BusOptions& known) { return is_same(known, world); });
    worlds_.insert(worlds_.begin(), world);
    if (worlds_.size() > kMax) worlds_.resize(kMax);
    return save();
}

Expected<void> RecentWorlds::forget(const bus::BusOptions& world) {
    std::erase_if(worlds_, [&](const bus::BusOptions& known) { return is_same(known, world); });
    return save();
}

Expected<void> RecentWorlds::save() const {
    if (file_.empty()) return {};
    std::string text = "# Worlds that the viewer joined last (docs/viewer_window.md)\n\n";
    for (const bus::BusOptions& known : worlds_) {
        text += fmt::format(
            "[[world]]\nname = {}\ndomain = {}\nnetwork = {}\npeers = {}\ninterface = {}\n\n",
            quoted(known.world),
            known.domain,
            quoted(known.network),
            quoted(known.peers),
            quoted(known.interface));
    }
    return replace_file(file_, text);
}

}  // namespace atrium::viewer
