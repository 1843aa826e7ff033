#include "tools/play/describe.hpp"

#include "core/bus/names.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace atrium::play {
namespace {

double duration_s(const recording::WorldFile& world) {
    return std::chrono::duration<double>(world.duration()).count();
}

double size_mb(const recording::WorldFile& world) {
    std::error_code failure;
    const auto size = std::filesystem::file_size(world.file().path(), failure);
    return failure ? 0.0 : static_cast<double>(size) / 1e6;
}

std::string begin_text(const recording::WorldFile& world) {
    const auto begin = static_cast<std::time_t>(world.begin().ns / 1'000'000'000);
    return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(begin));
}

}  // namespace

std::string describe(const recording::WorldFile& world) {
    std::string text = fmt::format("{}: world {}, {:.1f} s, {:.1f} MB, from {}\n",
                                   world.file().path().string(),
                                   world.world(),
                                   duration_s(world),
                                   size_mb(world),
                                   begin_text(world));
    text += fmt::format(
        "sites: {}\n",
        world.sites().empty() ? "none" : fmt::format("{}", fmt::join(world.sites(), ", ")));
    for (const recording::RecordedProgram& program : world.programs()) {
        text += fmt::format("program: {} {} on {}, version {}\n",
                            bus::kind_name(program.kind),
                            program.name,
                            program.host,
                            program.version);
    }
    for (const auto& [topic, num] : world.num_samples()) {
        text += fmt::format(
            "{:>10} {:<18} {:.1f}/s\n",
            num,
            topic,
            duration_s(world) > 0.0 ? static_cast<double>(num) / duration_s(world) : 0.0);
    }
    if (!world.foreign_topics().empty()) {
        text += fmt::format("of another version of Atrium: {}; what does not fit is refused\n",
                            fmt::join(world.foreign_topics(), ", "));
    }
    if (world.file().is_being_written()) text += "it is still being written\n";
    if (!world.file().fault().empty()) {
        text += fmt::format("damaged: {}; {} chunks are whole, {} are not",
                            world.file().fault(),
                            world.file().contents().chunks.size(),
                            world.file().num_damaged_chunks());
        text += world.file().is_being_written() ? "\n" : "; --repair completes it\n";
    }
    return text;
}

std::string describe_json(const recording::WorldFile& world) {
    nlohmann::json out{{"file", world.file().path().string()},
                       {"world", world.world()},
                       {"version", world.version()},
                       {"begin_ns", world.begin().ns},
                       {"duration_s", duration_s(world)},
                       {"size_mb", size_mb(world)},
                       {"sites", world.sites()},
                       {"num_samples", world.num_samples()},
                       {"foreign_topics", world.foreign_topics()},
                       {"fault", world.file().fault()},
                       {"num_damaged_chunks", world.file().num_damaged_chunks()},
                       {"is_being_written", world.file().is_being_written()}};
    out["programs"] = nlohmann::json::array();
    for (const recording::RecordedProgram& program : world.programs()) {
        out["programs"].push_back({{"kind", bus::kind_name(program.kind)},
                                   {"name", program.name},
                                   {"host", program.host},
                                   {"version", program.version}});
    }
    // A path need not be UTF-8.
    return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace atrium::play
