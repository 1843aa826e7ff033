#include "tools/demo/start_checks.hpp"

#include "core/app/process.hpp"
#include "core/base/split_list.hpp"
#include "core/config/spelling.hpp"
#include "core/config/table_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <system_error>

namespace atrium::demo {
namespace {

namespace fs = std::filesystem;

// Where the demo's files are, if the program lies in a build folder of the repository.
std::string where_to_start() {
    std::error_code ignored;
    const fs::path root = app::program_folder().parent_path().parent_path();
    if (!fs::is_directory(root / "deploy" / "sites", ignored))
        return "start the demo in the root of the repository";
    return fmt::format("start the demo in {}", root.string());
}

Expected<void> check_file(const std::string& option, const fs::path& file) {
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) return {};
    return make_error(ErrorKind::kNotFound,
                      fmt::format("{}: there is no file {}; {}, or give --{} FILE",
                                  option,
                                  file.string(),
                                  where_to_start(),
                                  option));
}

std::vector<std::string> site_files(const fs::path& folder) {
    std::vector<std::string> names;
    std::error_code failure;
    for (fs::directory_iterator file(folder, failure), end; !failure && file != end;
         file.increment(failure)) {
        if (file->path().extension() == ".toml") names.push_back(file->path().stem());
    }
    std::sort(names.begin(), names.end());
    return names;
}

Expected<DemoSite> read_site(const std::string& name, const fs::path& folder) {
    const fs::path file = folder / (name + ".toml");
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) {
        const std::vector<std::string> names = site_files(folder);
        std::string hint = config::ask_which(config::names_meant_by(name, names));
        if (!hint.empty()) hint += ' ';
        return make_error(ErrorKind::kNotFound,
                          fmt::format("sites: there is no {}; {}available: {}",
                                      file.string(),
                                      hint,
                                      fmt::join(names, ", ")));
    }
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    DemoSite site{.name = name, .file = file, .motion = {}};
    reader->read("site.name", site.name);
    return site;
}

Expected<std::vector<DemoSite>> read_sites(const DemoConfig& config) {
    if (split_list(config.sites).empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "sites: name at least one, for example alice,bob");
    }
    const fs::path folder = config.deploy / "sites";
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) {
        return make_error(ErrorKind::kNotFound,
                          fmt::format("deploy: there is no folder {}; {}, or give --deploy FOLDER",
                                      folder.string(),
                                      where_to_start()));
    }
    std::vector<DemoSite> sites;
    for (const std::string& name : split_list(config.sites)) {
        if (name.find('/') != std::string::npos || name.ends_with(".toml")) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("sites: give names of files in {}, such as alice, not paths; got '{}'",
                            folder.string(),
                            name));
        }
        auto site = read_site(name, folder);
        if (!site) return tl::unexpected(site.error());
        if (std::ranges::any_of(sites, [&](const DemoSite& s) { return s.name == site->name; })) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("sites: two of them are called '{}'; each needs a site.name of its own",
                            site->name));
        }
        sites.push_back(std::move(*site));
    }
    return sites;
}

}  // namespace

void use_installed(DemoConfig& config, const fs::path& programs) {
    if (config.programs.empty()) config.programs = programs;
    const fs::path installed = programs.parent_path() / "deploy";
    std::error_code ignored;
    if (!fs::is_directory(installed, ignored)) return;
    const DemoConfig usual;
    const auto replace = [&](fs::path& path, const fs::path& delivered) {
        if (path == delivered && !fs::exists(path, ignored))
            path = (installed / path.lexically_relative(usual.deploy)).lexically_normal();
    };
    replace(config.world, usual.world);
    replace(config.viewer, usual.viewer);
    replace(config.deploy, usual.deploy);
}

Expected<std::vector<DemoSite>> check_start(const DemoConfig& config) {
    auto sites = read_sites(config);
    if (!sites) return sites;
    const std::vector<std::string> motions = split_list(config.motions);
    if (!motions.empty() && motions.size() != sites->size()) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("motions: give one for each of the {} sites, or none; got {}",
                                      sites->size(),
                                      motions.size()));
    }
    for (std::size_t i = 0; i < motions.size(); ++i) (*sites)[i].motion = motions[i];
    if (auto world = check_file("world", config.world); !world)
        return tl::unexpected(world.error());
    if (auto viewer = check_file("viewer", config.viewer); !viewer)
        return tl::unexpected(viewer.error());
    for (const char* program : {"world_server", "site_node", "viewer"}) {
        const fs::path file = config.programs / program;
        if (access(file.c_str(), X_OK) == 0) continue;
        return make_error(ErrorKind::kNotFound,
                          fmt::format("programs: there is no program {}; build it with `make "
                                      "programs`, or give --programs FOLDER",
                                      file.string()));
    }
    return sites;
}

fs::path models_for_viewer(const DemoConfig& config) {
    auto viewer = config::TableReader::load(config.viewer);
    auto world = config::TableReader::load(config.world);
    if (!viewer || !world || viewer->has("viewer.models")) return {};
    fs::path models = world->folder().empty() ? "." : world->folder();
    world->read("world.models", models);
    return models;
}

}  // namespace atrium::demo
