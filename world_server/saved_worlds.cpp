#include "world_server/saved_worlds.hpp"

#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "core/config/option_set.hpp"
#include "world_server/description/world_text.hpp"
#include "world_server/state_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <system_error>

namespace atrium::world_server {
namespace {

namespace fs = std::filesystem;
constexpr const char* kEnding = ".toml";
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{8} << 20U;  // 2048 objects need 1 MB

tl::unexpected<Error> refuse_world(std::string why) {
    return make_error(ErrorKind::kInvalidData, std::move(why));
}

std::string quoted(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '"' || c == '\\') escaped += '\\';
        escaped += c;
    }
    return "\"" + escaped + "\"";
}

// A relative path if there is one, so that the folders can move together.
std::string models_path(const fs::path& models, const fs::path& folder) {
    std::error_code failure;
    const fs::path relative = fs::relative(models, folder, failure);
    return failure || relative.empty() ? fs::absolute(models, failure).string() : relative.string();
}

std::uint32_t num_objects_in(const fs::path& file) {
    std::ifstream in(file);
    std::uint32_t num = 0;
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("[[object]]") || line.starts_with("[[soft]]")) ++num;
    return num;
}

Timestamp time_of(const fs::directory_entry& file) {
    std::error_code failure;
    const auto written = file.last_write_time(failure);
    if (failure) return {};
    const auto age = fs::file_time_type::clock::now() - written;
    const auto now = Timestamp::now();
    return {std::max<std::int64_t>(
        0, now.ns - std::chrono::duration_cast<std::chrono::nanoseconds>(age).count())};
}

}  // namespace

std::string world_text(const WorldServerConfig& config,
                       const Scene& scene,
                       const fs::path& folder) {
    const WorldDescription& description = scene.description();
    std::string table = fmt::format(
        "tick_hz = {}\nsend_hz = {}\nmax_objects = {}\nmax_sites = {}\nhalf_extent_m = {}\n"
        "lowest_z_m = {}\n",
        config.tick_hz,
        config.send_hz,
        config.max_objects,
        config.max_sites,
        description.world.half_extent_m,
        description.world.lowest_z_m);
    if (!description.models_folder.empty()) {
        table += "models = " + quoted(models_path(description.models_folder, folder)) +
                 "  # folder of models and textures, relative to this file\n";
    }
    return "# Saved by world_server from world " + config.bus.world + ".\n\n" +
           to_toml(description, scene.current_objects(), scene.current_soft_objects(), table);
}

Expected<void> SavedWorldsFolder::open() const {
    if (!is_on()) return {};
    std::error_code failure;
    fs::create_directories(folder_, failure);
    if (failure) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("world.saved_folder: {}: cannot create the folder: {}",
                                      folder_.string(),
                                      failure.message()));
    }
    if (const auto writable = check_writable(folder_ / "check.toml"); !writable) {
        return make_error(ErrorKind::kUnavailable,
                          "world.saved_folder: " + writable.error().message);
    }
    return {};
}

Expected<fs::path> SavedWorldsFolder::file_of(const std::string& name) const {
    if (!is_on()) {
        return refuse_world(
            "the world server has no folder of saved worlds (its option world.saved_folder)");
    }
    if (!bus::is_valid_name(name) || name.front() == '.') {
        return refuse_world(
            "the name of a saved world must have 1 to 63 characters of A-Z a-z 0-9 _ . - and not "
            "begin with a dot");
    }
    return folder_ / (name + kEnding);
}

Expected<void> SavedWorldsFolder::save(const std::string& name, const std::string& text) const {
    const auto file = file_of(name);
    if (!file) return tl::unexpected(file.error());
    std::error_code failure;
    if (!fs::exists(*file, failure) && list({}).worlds.size() >= max_worlds_) {
        return refuse_world(fmt::format(
            "{} worlds are saved already (world.max_saved): save over one of them", max_worlds_));
    }
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    return write_atomically(*file, {bytes, text.size()});
}

Expected<WorldServerConfig> SavedWorldsFolder::load(const std::string& name,
                                                    const WorldServerConfig& config) const {
    const auto file = file_of(name);
    if (!file) return tl::unexpected(file.error());
    std::error_code failure;
    const auto size = fs::file_size(*file, failure);
    if (failure) return refuse_world(fmt::format("there is no saved world '{}'", name));
    if (size > kMaxFileBytes)
        return refuse_world(fmt::format("saved world '{}' is too large: {} bytes", name, size));
    auto reader = config::TableReader::load(*file);
    if (!reader) return tl::unexpected(reader.error());
    WorldServerConfig read;
    config::OptionSet options;
    declare(read, options);
    options.read_file(*reader);
    read_world(*reader, read);
    if (auto fine = reader->finish(); !fine) return tl::unexpected(fine.error());
    WorldServerConfig loaded = config;
    const std::size_t max_objects = static_cast<std::size_t>(config.max_objects);
    static_cast<WorldDescription&>(loaded) = static_cast<const WorldDescription&>(read);
    // a file from the network's side decides on objects, not on who may do what
    loaded.rights = config.rights;
    loaded.placements = config.placements;
    loaded.world.max_speed_mps = config.world.max_speed_mps;
    loaded.world.people = config.world.people;
    loaded.loaded = name;
    if (loaded.objects.size() + loaded.soft.size() > max_objects) {
        return refuse_world(fmt::format("saved world '{}' has {} objects, world.max_objects is {}",
                                        name,
                                        loaded.objects.size() + loaded.soft.size(),
                                        max_objects));
    }
    if (auto fine = check(loaded); !fine) return tl::unexpected(fine.error());
    return loaded;
}

bus::SavedWorlds SavedWorldsFolder::list(const std::string& world) const {
    bus::SavedWorlds saved;
    saved.world = world;
    saved.is_on = is_on();
    std::error_code failure;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, failure)) {
        const std::string name = entry.path().stem().string();
        if (!entry.is_regular_file(failure) || entry.path().extension() != kEnding ||
            !bus::is_valid_name(name) || name.front() == '.')
            continue;
        saved.worlds.push_back({name, time_of(entry), num_objects_in(entry.path())});
    }
    std::sort(saved.worlds.begin(), saved.worlds.end(), [](const auto& a, const auto& b) {
        return a.name < b.name;
    });
    if (saved.worlds.size() > bus::kMaxSavedWorlds) saved.worlds.resize(bus::kMaxSavedWorlds);
    return saved;
}

}  // namespace atrium::world_server
