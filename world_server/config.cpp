#include "world_server/config.hpp"

#include "core/bus/bus_options.hpp"
#include "core/bus/limits.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace atrium::world_server {
namespace {

// "w.toml:9: ", or nothing.
std::string before(const std::string& where) { return where.empty() ? where : where + ": "; }

// "[-4, -4, -0.5] to [4, 4, 4] m; it is at [150, 0, 50]".
std::string place_and_bounds(const Eigen::Vector3d& place_m, const geometry::Aabb& box) {
    return fmt::format("[{}] to [{}] m; it is at [{}]",
                       fmt::join(box.min, ", "),
                       fmt::join(box.max, ", "),
                       fmt::join(place_m, ", "));
}

}  // namespace

void declare(WorldServerConfig& config, config::OptionSet& set) {
    set.add("world.tick_hz", config.tick_hz, "steps of the simulation per second [Hz]", {30, 1000});
    set.add("world.send_hz", config.send_hz, "states published per second [Hz]", {1, 1000});
    set.add("world.seconds", config.seconds, "run time [s]; 0: until Ctrl-C", {0, 1e9});
    set.add("world.max_objects",
            config.max_objects,
            "maximum number of objects, including added ones",
            {1, static_cast<double>(bus::kMaxObjects)});
    set.add("world.state_file",
            config.state_file,
            "state file: saved at the end, restored at the start; empty: none");
    set.add("world.save_every_s",
            config.save_every_s,
            "time between saves [s]; 0: only at the end and on command",
            {0, 86400});
    set.add("world.saved_folder",
            config.saved_folder,
            "folder of worlds that viewers with the right `save` save and load; created if needed; "
            "empty: none");
    set.add("world.max_saved", config.max_saved, "maximum number of saved worlds", {1, 256});
    set.add("world.max_sites",
            config.max_sites,
            "maximum number of sites; further ones are refused",
            {1, 64});
    physics::WorldOptions& world = config.world;
    set.add("world.half_extent_m",
            world.half_extent_m,
            "distance from the origin along x, y or z beyond which an object is reset [m]",
            {1, 1000});
    set.add("world.lowest_z_m",
            world.lowest_z_m,
            "height below which an object is reset [m]",
            {-1000, 0});
    set.add(
        "physics.max_speed_mps", world.max_speed_mps, "speed limit of objects [m/s]", {0.1, 100});
    set.add(
        "physics.person_friction", world.people.contacts.friction, "friction of people", {0, 10});
    set.add("physics.person_restitution",
            world.people.contacts.restitution,
            "bounce of people",
            {0, 1});
    physics::PersonShapeOptions& person = config.person;
    set.add("physics.region_m",
            person.motion.region_m,
            "size of the regions of a person that move as one [m]",
            {0.05, 1});
    set.add("physics.person_max_speed_mps",
            person.max_speed_mps,
            "speed limit of people's surfaces [m/s]",
            {0.1, 50});
    set.add("physics.person_rest_speed_mps",
            person.rest_speed_mps,
            "surfaces slower than this count as at rest, with a flickering outline [m/s]",
            {0.001, 1});
    set.add(
        "recording.file",
        config.recording.file,
        "run with the people of this recording (FILE.mcap of `atrium record`) instead of living "
        "ones, without a network, as fast as the machine can; empty: a live world");
    set.add_alias("recording");
    set.add("recording.output",
            config.recording.output,
            "write the recording again, with this world's objects and their motion; empty: no");
    set.add("recording.hashes",
            config.recording.hashes,
            "log the hash of the world's state after each recorded second");
    set.add("recording.commands",
            config.recording.commands,
            "obey the commands and edits of the recording, too");
    set.add("recording.real_time", config.recording.real_time, "run as fast as it was recorded");
    set.add("recording.threads",
            config.recording.threads,
            "threads that prepare the meshes of the recording; 0: one per core, at most 4",
            {0, 64});
    bus::declare(config.bus, set);
    app::declare(config.process, set);
}

Expected<void> check(const WorldServerConfig& config) {
    const auto wrong = [](std::string text) {
        return make_error(ErrorKind::kConfiguration, std::move(text));
    };
    if (config.send_hz > config.tick_hz) {
        return wrong(fmt::format("{}world.send_hz: must not exceed world.tick_hz ({}), got {}",
                                 before(config.rates_at),
                                 config.tick_hz,
                                 config.send_hz));
    }
    const bool is_live = config.recording.file.empty();
    if (is_live && !config.recording.output.empty())
        return wrong("recording.output: needs recording.file, the recording to run");
    if (config.objects.size() > static_cast<std::size_t>(config.max_objects)) {
        return wrong(fmt::format(
            "{}world.max_objects: must be at least the {} objects described, got {} (default {}, "
            "at most {})",
            before(config.max_objects_at.empty() ? config.objects_at : config.max_objects_at),
            config.objects.size(),
            config.max_objects,
            WorldServerConfig{}.max_objects,
            bus::kMaxObjects));
    }
    const geometry::Aabb box = box_of(config.world);
    for (const WorldObject& object : config.objects) {
        const physics::RigidObject& rigid = object.rigid;
        if (rigid.mass_kg > 0.0 && !box.contains(rigid.world_from_object.translation)) {
            return wrong(fmt::format("{}object '{}': must start inside the world's bounds, {}",
                                     before(object.where),
                                     object.name,
                                     place_and_bounds(rigid.world_from_object.translation, box)));
        }
    }
    for (const WorldSoftObject& soft : config.soft) {
        const Eigen::Vector3d start = physics::start_place(soft.object);
        if (!box.contains(start)) {
            return wrong(fmt::format("{}soft object '{}': must start inside the world's bounds, {}",
                                     before(soft.where),
                                     soft.name,
                                     place_and_bounds(start, box)));
        }
    }
    if (config.placements.size() > static_cast<std::size_t>(config.max_sites)) {
        return wrong(
            fmt::format("{}world.max_sites: must be at least the {} sites described, got {}",
                        before(config.max_sites_at),
                        config.placements.size(),
                        config.max_sites));
    }
    return {};
}

}  // namespace atrium::world_server
