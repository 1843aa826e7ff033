#include "tests/support/world/load_world.hpp"

namespace atrium::test_support {

Expected<world_server::WorldServerConfig> load_world(const std::filesystem::path& file) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    world_server::WorldServerConfig config;
    config::OptionSet set;
    declare(config, set);
    set.read_file(*reader);
    read_world(*reader, config);
    if (const auto read = reader->finish(); !read) return tl::unexpected(read.error());
    if (const auto valid = check(config); !valid) return tl::unexpected(valid.error());
    return config;
}

}  // namespace atrium::test_support
