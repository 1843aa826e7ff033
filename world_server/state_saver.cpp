#include "world_server/state_saver.hpp"

#include "core/app/log.hpp"
#include "world_server/saved_worlds.hpp"

#include <fmt/format.h>

#include <utility>

namespace atrium::world_server {

void StateSaver::run(std::stop_token stop) {
    // the next save tries again
    while (const auto world = slot_.take(stop)) static_cast<void>(save(*world));
}

Expected<void> StateSaver::save(const SavedWorld& world) {
    const auto bytes = encode(world);
    if (const auto written = write_atomically(file_, bytes); !written) {
        app::log::error("save_failed {}", written.error().message);
        return written;
    }
    ++num_saves_;
    app::log::info("state_saved file={} tick={} objects={} soft={} bytes={}",
                   file_.string(),
                   world.state.tick,
                   world.state.objects.size(),
                   world.state.soft.size(),
                   bytes.size());
    return {};
}

namespace {

// The description that a state belongs to: the world file's, or that of a saved world.
Expected<WorldServerConfig> description_of(const SavedWorld& saved,
                                           const WorldServerConfig& config) {
    if (saved.loaded.empty()) return config;
    if (saved.world_file != 0 && saved.world_file != config.world_file_hash) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("world state: is of the saved world '{}', but the world file "
                                      "was changed since that was loaded",
                                      saved.loaded));
    }
    const SavedWorldsFolder folder(config.saved_folder, static_cast<std::size_t>(config.max_saved));
    return folder.load(saved.loaded, config);
}

}  // namespace

Expected<std::optional<Scene>> load_scene(const WorldServerConfig& config) {
    const auto refuse = [&](const Error& why) -> Expected<std::optional<Scene>> {
        const auto aside = put_aside(config.state_file);
        return make_error(
            why.kind,
            why.message + "; " + (aside ? "kept as " + aside->string() : aside.error().message));
    };
    const auto bytes = read_file(config.state_file);
    if (!bytes && bytes.error().kind == ErrorKind::kNotFound) return std::nullopt;
    if (!bytes) return refuse(bytes.error());
    const auto saved = decode(*bytes);
    if (!saved) return refuse(saved.error());
    const auto described = description_of(*saved, config);
    if (!described) return refuse(described.error());
    auto scene = Scene::restore(*described, *saved);
    if (!scene) return refuse(scene.error());
    return std::optional<Scene>(std::move(*scene));
}

Expected<Scene> start_scene(const WorldServerConfig& config, Scene described) {
    if (config.state_file.empty()) return described;
    if (const auto writable = check_writable(config.state_file); !writable)
        return make_error(writable.error().kind, "world.state_file: " + writable.error().message);
    auto saved = load_scene(config);
    if (!saved) {
        app::log::error("restore_failed {}; the world starts as described", saved.error().message);
        return described;
    }
    if (!*saved) return described;
    const std::string& loaded = (*saved)->loaded();
    app::log::info("state_restored file={} tick={}{}",
                   config.state_file.string(),
                   (*saved)->world().counters().num_ticks,
                   loaded.empty() ? ""
                                  : fmt::format(" saved_world={} reason=\"it was loaded before, so "
                                                "the objects are its own, not those of the world "
                                                "file\" advice=\"delete the state file to begin "
                                                "with the world file\"",
                                                loaded));
    return std::move(**saved);
}

}  // namespace atrium::world_server
