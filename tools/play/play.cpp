#include "tools/play/play.hpp"

#include "core/app/lasting_log.hpp"
#include "core/app/log.hpp"
#include "core/base/split_list.hpp"
#include "core/bus/bus_options.hpp"
#include "core/bus/names.hpp"
#include "core/recording/topic_roles.hpp"
#include "tools/play/commands.hpp"
#include "tools/play/describe.hpp"
#include "tools/play/keyboard.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <thread>

namespace atrium::play {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kListen{1200};
constexpr std::chrono::milliseconds kLookPeriod{100};
constexpr std::chrono::seconds kTellPeriod{10};

tl::unexpected<Error> wrong(const std::string& message) {
    return make_error(ErrorKind::kConfiguration, message);
}

Expected<void> check_site(const recording::WorldFile& world,
                          const char* option,
                          const std::string& site) {
    if (std::ranges::binary_search(world.sites(), site)) return {};
    return wrong(fmt::format(
        "{}: the recording has no site '{}'; it has {}",
        option,
        site,
        world.sites().empty() ? "none" : fmt::format("{}", fmt::join(world.sites(), ", "))));
}

Expected<recording::PlaySelection> add_names(const PlayConfig& config,
                                             const recording::WorldFile& world,
                                             recording::PlaySelection selection) {
    for (const std::string& pair : split_list(config.rename)) {
        const auto equals = pair.find('=');
        const std::string from = pair.substr(0, equals);
        const std::string to = equals == std::string::npos ? "" : pair.substr(equals + 1);
        if (!bus::is_valid_name(to))
            return wrong(
                fmt::format("rename: '{}': write RECORDED=NEW, both names of sites", pair));
        if (auto known = check_site(world, "rename", from); !known)
            return tl::unexpected(known.error());
        selection.names[from] = to;
    }
    return selection;
}

Expected<recording::PlaySelection> add_places(const PlayConfig& config,
                                              recording::PlaySelection selection) {
    for (const std::string& text : split_list(config.place, ';')) {
        const auto equals = text.find('=');
        const std::string site = text.substr(0, equals);
        double x = 0.0;
        double y = 0.0;
        double yaw_deg = 0.0;
        char behind = '\0';
        const bool is_read =
            equals != std::string::npos &&
            std::sscanf(text.c_str() + equals + 1, "%lf,%lf,%lf%c", &x, &y, &yaw_deg, &behind) == 3;
        const bool is_sane = std::isfinite(x) && std::isfinite(y) && std::isfinite(yaw_deg) &&
                             std::abs(x) < 1e4 && std::abs(y) < 1e4;
        if (!is_read || !is_sane || !bus::is_valid_name(site)) {
            return wrong(
                fmt::format("place: '{}': write SITE=X,Y,YAW (metres and degrees, in the "
                            "world), several with ';' between",
                            text));
        }
        geometry::RigidTransform place;
        place.rotation = Eigen::Quaterniond(
            Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ()));
        place.translation = {x, y, 0.0};
        selection.places[site] = place;
    }
    return selection;
}

// The sites that are played, by the names that they get.
std::vector<std::string> played_names(const recording::WorldFile& world,
                                      const recording::PlaySelection& selection) {
    std::vector<std::string> names;
    for (const std::string& site : world.sites()) {
        if (!selection.sites.empty() && !selection.sites.contains(site)) continue;
        const auto renamed = selection.names.find(site);
        names.push_back(renamed == selection.names.end() ? site : renamed->second);
    }
    return names;
}

// Two sites of one name would be one on the bus; and places are for sites that are played.
Expected<void> check_played_names(const recording::WorldFile& world,
                                  const recording::PlaySelection& selection) {
    std::set<std::string> names;
    for (const std::string& name : played_names(world, selection)) {
        if (!names.insert(name).second)
            return wrong(fmt::format("rename: two sites would be named '{}'", name));
    }
    for (const auto& [site, place] : selection.places) {
        if (names.contains(site)) continue;
        return wrong(fmt::format(
            "place: no site is played as '{}'; there are {}", site, fmt::join(names, ", ")));
    }
    return {};
}

// Somebody of the recording who is in the world already: two of one name would fight.
Expected<void> check_nobody_is_there(const bus::Participant& participant,
                                     const recording::WorldFile& world,
                                     const recording::PlaySelection& selection) {
    auto reader = bus::Reader<bus::Presence>::create(participant);
    if (!reader) return tl::unexpected(reader.error());
    auto waiter = bus::Waiter::create(participant);
    if (!waiter) return tl::unexpected(waiter.error());
    waiter->add(*reader);
    std::vector<bus::Presence> here;
    const Clock::time_point end = Clock::now() + kListen;
    for (Clock::time_point now = Clock::now(); now < end; now = Clock::now()) {
        waiter->wait(std::chrono::ceil<std::chrono::milliseconds>(end - now));
        reader->take([&](bus::Presence&& program) { here.push_back(std::move(program)); });
    }
    for (const recording::RecordedProgram& played : world.programs()) {
        const bool is_site = played.kind == bus::ProgramKind::kSiteNode;
        if (!selection.sites.empty() && (!is_site || !selection.sites.contains(played.name)))
            continue;
        const auto renamed = selection.names.find(played.name);
        const std::string& name =
            is_site && renamed != selection.names.end() ? renamed->second : played.name;
        const auto same = std::ranges::find_if(here, [&](const bus::Presence& program) {
            return program.kind == played.kind && program.name == name;
        });
        if (same == here.end()) continue;
        const std::string place = fmt::format(
            "'{}' of the recording is in this world already, on "
            "{} (pid {}, or a player of its recording)",
            name,
            same->host,
            same->pid);
        if (is_site)
            return wrong(
                fmt::format("{}; give it another name: --rename {}=NAME", place, played.name));
        return wrong(
            fmt::format("{}; play into another world (--world), or only the people "
                        "(--sites {})",
                        place,
                        fmt::join(world.sites(), ",")));
    }
    return {};
}

class Session {
public:
    Session(const PlayConfig& config, recording::Player& player)
        : config_(config), player_(player) {}

    // Until the end of the recording, q or the stop.
    void run(const std::stop_token& stop) {
        Keyboard keyboard;
        const bool shows_line = keyboard.has_keys() && ::isatty(STDERR_FILENO) != 0;
        while (!stop.stop_requested()) {
            for (const std::string& input : keyboard.read(kLookPeriod)) {
                if (keyboard.has_keys()) {
                    if (!obey_key(player_, input)) return end_line(shows_line);
                } else {
                    const CommandResult result = obey(player_, input);
                    std::printf("%s\n", result.answer.c_str());
                    std::fflush(stdout);
                    if (result.quits) return;
                }
                has_commands_ = true;
            }
            const recording::PlayState state = player_.state();
            tell(state, shows_line);
            // Whoever commands it may want to see more.
            const bool waits_for_more = has_commands_ && keyboard.is_open();
            if (state.is_at_end && !waits_for_more) break;
        }
        end_line(shows_line);
    }

private:
    void tell(const recording::PlayState& state, bool shows_line) {
        if (const auto line = left_out_.update(state)) faults_.warn("faults", *line);
        if (shows_line) {
            std::fprintf(stderr, "\r\033[K%s", state_text(state).c_str());
            std::fflush(stderr);
        } else if (Clock::now() >= due_) {
            due_ = Clock::now() + kTellPeriod;
            app::log::info("{} written={}", state_text(state), state.num_written);
        }
    }
    static void end_line(bool shows_line) {
        if (shows_line) std::fputs("\n", stderr);
    }

    const PlayConfig& config_;
    recording::Player& player_;
    app::log::LastingLog faults_;
    recording::LeftOut left_out_;
    Clock::time_point due_ = Clock::now() + kTellPeriod;
    bool has_commands_ = false;
};

Expected<void> play_world(const PlayConfig& config,
                          const std::shared_ptr<const recording::WorldFile>& world,
                          const std::stop_token& stop) {
    auto selection = selection_of(config, *world);
    if (!selection) return tl::unexpected(selection.error());
    bus::BusOptions bus = config.bus;
    if (bus.world.empty()) bus.world = world->world();
    auto participant = bus::Participant::create(bus);
    if (!participant) return tl::unexpected(participant.error());
    app::log::info("{}", participant->network().line);
    for (const std::string& warning : participant->network().warnings)
        app::log::warn("{}", warning);
    if (auto free = check_nobody_is_there(*participant, *world, *selection); !free) return free;
    const std::vector<std::string> played = played_names(*world, *selection);
    auto player = recording::Player::create(world, *participant, std::move(*selection));
    if (!player) return tl::unexpected(player.error());
    const auto time = [](double value_s) { return from_milliseconds(value_s * 1e3); };
    (*player)->set_speed(config.speed);
    (*player)->set_loop(config.loop);
    (*player)->set_marks(time(config.from_s),
                         config.to_s > 0.0 ? time(config.to_s) : world->duration());
    (*player)->seek(time(config.from_s));
    if (config.paused)
        (*player)->show_first();
    else
        (*player)->play();
    app::log::info("playing file={} world={} seconds={:.1f} sites={}",
                   world->file().path().string(),
                   bus.world,
                   std::chrono::duration<double>(world->duration()).count(),
                   fmt::join(played, ","));
    {
        const std::jthread playing([&](std::stop_token own) { (*player)->run(std::move(own)); });
        Session(config, **player).run(stop);
    }
    const recording::PlayState state = (*player)->state();
    app::log::info("played written={} refused={} damaged={} late={}",
                   state.num_written,
                   state.num_refused,
                   state.num_damaged,
                   state.num_late);
    if (state.num_written == 0 && state.num_refused + state.num_damaged > 0) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("nothing could be played: {}", state.fault));
    }
    return {};
}

// Completes a file that was cut off; names chunks inside that are damaged, which nothing mends.
Expected<void> repair(const std::filesystem::path& path, const std::stop_token& stop) {
    auto file = mcap::File::open(path);
    if (!file) return tl::unexpected(file.error());
    if (!file->fault().empty()) {
        if (auto done = mcap::repair(path); !done) return done;
        app::log::info("repaired file={} fault=\"{}\"", path.string(), file->fault());
        return {};
    }
    const std::size_t num_chunks = file->contents().chunks.size();
    std::size_t num_damaged = 0;
    for (std::size_t i = 0; i < num_chunks; ++i) {
        if (stop.stop_requested()) return make_error(ErrorKind::kInternal, "stopped");
        const auto chunk = file->read(i);
        if (chunk) continue;
        ++num_damaged;
        app::log::warn("damaged reason=\"{}\"", chunk.error().message);
    }
    if (num_damaged == 0) {
        app::log::info("complete file={}: nothing to repair", path.string());
        return {};
    }
    return make_error(ErrorKind::kInvalidData,
                      fmt::format("{}: {} of {} chunks are damaged, which nothing can repair; the "
                                  "others can be played",
                                  path.string(),
                                  num_damaged,
                                  num_chunks));
}

}  // namespace

void declare(PlayConfig& config, config::OptionSet& options) {
    options.add("file", config.file, "the recording; also without the name of the option");
    options.add("sites",
                config.sites,
                "sites, \"a,b\", that are played, without anything else of the recording: to join "
                "a living world; empty: everything");
    options.add("topics", config.topics, "topics, \"a,b\", that are played; empty: all");
    options.add("rename", config.rename, "other names for sites: \"alice=anna,bob=ben\"");
    options.add("place",
                config.place,
                "other places of sites in the world: \"anna=1,0,90;ben=-1,0,-90\" (x, y [m], turn "
                "about the vertical [degrees]); a living world server's own places count more");
    options.add("speed", config.speed, "speed; 1: as recorded", {0.05, 20});
    options.add("from", config.from_s, "begin here [s]", {0, 1e9});
    options.add("to", config.to_s, "end here [s]; 0: at the end", {0, 1e9});
    options.add("loop", config.loop, "begin again at the end");
    options.add("paused", config.paused, "show the first moment, and wait for a key or command");
    options.add("info", config.info, "print what the recording has, and exit");
    options.add("json", config.json, "print --info as one line of JSON");
    options.add("repair",
                config.repair,
                "complete a file that was cut off, in place; then do the rest, or exit if nothing "
                "else is asked for");
    bus::declare(config.bus, options);
}

Expected<void> check(const PlayConfig& config) {
    if (config.file.empty()) return wrong("FILE is missing: the recording, FILE.mcap");
    if (config.to_s > 0.0 && config.to_s <= config.from_s)
        return wrong(fmt::format("to: must be later than from ({:g})", config.from_s));
    return {};
}

Expected<recording::PlaySelection> selection_of(const PlayConfig& config,
                                                const recording::WorldFile& world) {
    recording::PlaySelection selection;
    for (const std::string& site : split_list(config.sites)) {
        if (auto known = check_site(world, "sites", site); !known)
            return tl::unexpected(known.error());
        selection.sites.insert(site);
    }
    const auto there = world.num_samples();
    for (const std::string& topic : split_list(config.topics)) {
        if (!there.contains(topic)) {
            std::vector<std::string> names;
            for (const auto& [name, num] : there) names.push_back(name);
            return wrong(fmt::format("topics: the recording has no topic '{}'; it has {}",
                                     topic,
                                     fmt::join(names, ", ")));
        }
        selection.topics.insert(topic);
    }
    auto named = add_names(config, world, std::move(selection));
    if (!named) return named;
    auto placed = add_places(config, std::move(*named));
    if (!placed) return placed;
    if (auto good = check_played_names(world, *placed); !good) return tl::unexpected(good.error());
    return placed;
}

Expected<void> run_play(const PlayConfig& config, std::stop_token stop) {
    if (config.repair) {
        if (auto done = repair(config.file, stop); !done) return done;
    }
    auto world = recording::WorldFile::open(config.file);
    if (!world) return tl::unexpected(world.error());
    if (config.info) {
        const std::string text = config.json ? describe_json(**world) + "\n" : describe(**world);
        std::fputs(text.c_str(), stdout);
        return {};
    }
    if (config.repair) return {};
    for (const std::string& line : (*world)->warnings()) app::log::warn("{}", line);
    const double length_s = std::chrono::duration<double>((*world)->duration()).count();
    if (config.from_s >= length_s && config.from_s > 0.0) {
        return wrong(fmt::format(
            "from: {:g} s is behind the end: the recording has {:.1f} s", config.from_s, length_s));
    }
    return play_world(config, *world, stop);
}

}  // namespace atrium::play
