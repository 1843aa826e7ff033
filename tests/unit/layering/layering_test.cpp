#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

// Checks the rules of docs/architecture.md, "Layers", on every #include of the project.
namespace atrium {
namespace {

namespace fs = std::filesystem;

struct Include {
    std::string file;    // relative to the root
    std::string target;  // as written
};

std::vector<Include> all_includes(const fs::path& root, const std::vector<std::string>& tops) {
    static const std::regex kInclude("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"]");
    std::vector<Include> includes;
    for (const std::string& top : tops) {
        for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
            const std::string suffix = entry.path().extension().string();
            if (suffix != ".hpp" && suffix != ".cpp") continue;
            std::ifstream stream(entry.path());
            std::smatch match;
            for (std::string line; std::getline(stream, line);) {
                if (std::regex_search(line, match, kInclude)) {
                    includes.push_back({fs::relative(entry.path(), root).string(), match[1]});
                }
            }
        }
    }
    return includes;
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& prefixes) {
    for (const auto& prefix : prefixes) {
        if (text.rfind(prefix, 0) == 0) return true;
    }
    return false;
}

class Layering : public testing::Test {
protected:
    std::vector<Include> includes_ =
        all_includes(atrium::test::source_dir(),
                     {"core", "simulation", "site_node", "world_server", "viewer", "tools"});
};

TEST_F(Layering, FindsTheProject) { EXPECT_GT(includes_.size(), 200u); }

// The project folders that a module may include. Its own folder is always allowed.
const std::map<std::string, std::vector<std::string>> kMayInclude{
    {"core/base/", {}},
    {"core/geometry/", {"core/base/"}},
    {"core/image/", {"core/base/"}},
    {"core/model/", {"core/base/", "core/geometry/"}},
    {"core/config/", {"core/base/", "core/geometry/"}},
    {"core/gl/", {"core/base/"}},
    {"core/codec/", {"core/base/", "core/geometry/", "core/image/"}},
    {"core/keys/", {"core/base/", "core/config/"}},
    {"core/bus/", {"core/base/", "core/geometry/", "core/image/", "core/config/", "core/keys/"}},
    {"core/status/", {"core/base/", "core/bus/", "core/geometry/"}},
    {"core/app/", {"core/base/", "core/config/"}},
    {"core/mcap/", {"core/base/"}},
    {"core/recording/", {"core/base/", "core/geometry/", "core/bus/", "core/mcap/"}},
    {"core/presence/", {"core/base/", "core/bus/", "core/app/"}},
    {"simulation/",
     {"core/base/", "core/geometry/", "core/image/", "core/gl/", "core/config/", "core/model/"}},
    {"site_node/capture/", {"core/base/", "core/geometry/", "core/image/", "core/config/"}},
    {"site_node/simulated_room/",
     {"core/base/", "core/config/", "core/app/", "simulation/", "site_node/capture/"}},
    {"site_node/source/",
     {"core/base/",
      "core/config/",
      "core/app/",
      "simulation/",
      "site_node/capture/",
      "site_node/simulated_room/"}},
    {"site_node/segmentation/", {"core/base/", "core/image/"}},
    {"site_node/segmentation_worker/",
     {"core/base/", "core/image/", "core/app/", "site_node/segmentation/"}},
    {"site_node/camouflage/",
     {"core/base/", "core/geometry/", "core/image/", "site_node/segmentation/"}},
    {"site_node/occupied_room/",
     {"core/base/", "core/geometry/", "core/image/", "site_node/segmentation/"}},
    {"site_node/silhouette/", {"core/base/", "core/geometry/", "core/image/"}},
    {"site_node/silhouette_stage/",
     {"core/base/",
      "core/geometry/",
      "core/image/",
      "core/config/",
      "core/app/",
      "site_node/capture/",
      "site_node/hull/",
      "site_node/occupied_room/",
      "site_node/rig_check/",
      "site_node/segmentation/",
      "site_node/segmentation_worker/",
      "site_node/silhouette/"}},
    {"site_node/hull/", {"core/base/", "core/geometry/"}},
    {"site_node/refine/", {"core/base/", "core/geometry/", "core/image/", "site_node/hull/"}},
    {"site_node/texture/", {"core/base/", "core/image/", "core/codec/"}},
    {"site_node/stream/", {"core/base/"}},
    {"site_node/preview/",
     {"core/base/", "core/image/", "core/gl/", "core/app/", "site_node/capture/"}},
    {"world_server/description/",
     {"core/base/",
      "core/geometry/",
      "core/config/",
      "core/model/",
      "core/bus/limits.hpp",
      "core/bus/names.hpp",
      "world_server/physics/"}},
    {"world_server/physics/", {"core/base/", "core/geometry/"}},
    {"site_node/hosts/",
     {"core/base/",
      "core/bus/",
      "core/config/",
      "core/app/",
      "site_node/capture/",
      "site_node/hull/visual_hull.hpp"}},
    {"site_node/record/",
     {"core/base/",
      "core/image/",
      "core/config/",
      "core/app/",
      "site_node/capture/",
      "site_node/segmentation/"}},
    {"site_node/views/", {"core/base/", "site_node/hull/"}},
    {"site_node/rig_check/",
     {"core/base/", "core/geometry/", "site_node/hull/", "site_node/views/"}},
    {"site_node/coherence/", {"core/base/", "core/geometry/"}},
    {"tools/atrium/", {"core/base/", "core/config/", "core/app/"}},
    {"tools/calibrate/",
     {"core/base/",
      "core/geometry/",
      "core/image/",
      "core/config/",
      "core/app/",
      "site_node/capture/",
      "site_node/coherence/",
      "site_node/hull/",
      "site_node/rig_check/",
      "site_node/segmentation/",
      "site_node/silhouette/",
      "site_node/silhouette_stage/",
      "site_node/views/"}},
    {"tools/calibrate/sweep/",
     {"core/base/",
      "core/config/",
      "core/geometry/",
      "core/image/",
      "simulation/room_config.hpp",
      "site_node/capture/",
      "site_node/preview/",
      "site_node/source/",
      "tools/calibrate/adjust/",
      "tools/calibrate/board/",
      "tools/calibrate/wand/"}},
    {"tools/calibrate/adjust/", {"core/base/", "core/geometry/", "core/config/"}},
    {"tools/calibrate/judge/", {"core/base/", "core/geometry/"}},
    {"tools/doctor/", {"core/base/", "core/config/", "core/app/", "core/gl/", "core/keys/"}},
    {"tools/demo/",
     {"core/base/", "core/bus/", "core/config/", "core/app/", "core/status/", "core/keys/"}},
    {"tools/export/",
     {"core/base/",
      "core/bus/",
      "core/codec/",
      "core/config/",
      "core/app/",
      "core/geometry/",
      "core/image/",
      "core/recording/",
      "viewer/receive/person_decoder.hpp",
      "viewer/renderer/person/"}},
    {"tools/keys/", {"core/base/", "core/config/", "core/app/", "core/keys/"}},
    {"tools/tunnel/", {"core/base/", "core/app/", "core/keys/"}},
    {"tools/monitor/", {"core/base/", "core/bus/", "core/config/", "core/app/", "core/status/"}},
    {"tools/play/",
     {"core/base/", "core/bus/", "core/config/", "core/app/", "core/geometry/", "core/recording/"}},
    {"tools/record/",
     {"core/base/", "core/bus/", "core/config/", "core/app/", "core/presence/", "core/recording/"}},
    {"tools/plan/",
     {"core/base/",
      "core/config/",
      "core/app/",
      "site_node/config.hpp",
      "site_node/hosts/",
      "site_node/start_check.hpp"}},
    {"tools/site_control/",
     {"core/base/",
      "core/config/",
      "core/app/",
      "core/presence/",
      "site_node/config.hpp",
      "site_node/hosts/"}},
    {"tools/simulated_cameras/",
     {"core/base/",
      "core/geometry/",
      "core/image/",
      "core/config/",
      "core/app/",
      "simulation/",
      "site_node/capture/",
      "site_node/rig_check/"}},
    {"tools/visual_hull/",
     {"core/base/",
      "core/geometry/",
      "core/image/",
      "core/config/",
      "core/app/",
      "site_node/capture/",
      "site_node/hull/",
      "site_node/rig_check/",
      "site_node/silhouette/",
      "site_node/silhouette_stage/",
      "site_node/views/"}},
    {"viewer/renderer/", {"core/base/", "core/geometry/", "core/image/", "core/gl/"}},
};

// The innermost folder that has a rule.
std::string module_of(const std::string& file) {
    std::string module;
    for (const auto& [folder, allowed] : kMayInclude) {
        if (file.rfind(folder, 0) == 0 && folder.size() > module.size()) module = folder;
    }
    return module;
}

TEST_F(Layering, DependenciesPointOneWay) {
    const std::vector<std::string> project{
        "core/", "simulation/", "site_node/", "world_server/", "viewer/", "tools/"};
    for (const auto& [module, allowed] : kMayInclude) {
        for (const Include& include : includes_) {
            if (module_of(include.file) != module || !starts_with_any(include.target, project))
                continue;
            EXPECT_TRUE(include.target.rfind(module, 0) == 0 ||
                        starts_with_any(include.target, allowed))
                << include.file << " includes " << include.target;
        }
    }
}

// kMayInclude names the rooms of other programs that a tool uses.
TEST_F(Layering, ProgramsDoNotIncludeEachOther) {
    for (const Include& include : includes_) {
        if (include.file.rfind("tools/", 0) == 0) continue;
        for (const std::string program : {"world_server/", "viewer/", "site_node/", "tools/"}) {
            if (include.target.rfind(program, 0) == 0) {
                EXPECT_EQ(include.file.rfind(program, 0), 0u)
                    << include.file << " includes " << include.target;
            }
        }
    }
}

using Folders = std::set<std::string>;

// The folders that each folder includes.
std::map<std::string, Folders> folder_graph(const std::vector<Include>& includes) {
    Folders folders;
    for (const Include& include : includes)
        folders.insert(fs::path(include.file).parent_path().string());
    std::map<std::string, Folders> graph;
    for (const Include& include : includes) {
        const std::string from = fs::path(include.file).parent_path().string();
        const std::string to = fs::path(include.target).parent_path().string();
        if (from != to && folders.contains(to)) graph[from].insert(to);
    }
    return graph;
}

Folders reachable(const std::map<std::string, Folders>& graph, const std::string& start) {
    Folders seen;
    std::vector<std::string> open{start};
    while (!open.empty()) {
        const auto found = graph.find(open.back());
        open.pop_back();
        if (found == graph.end()) continue;
        for (const std::string& next : found->second) {
            if (seen.insert(next).second) open.push_back(next);
        }
    }
    return seen;
}

// Strongly connected components of more than one folder.
std::set<Folders> folder_cycles(const std::vector<Include>& includes) {
    const auto graph = folder_graph(includes);
    std::map<std::string, Folders> below;
    for (const auto& [folder, next] : graph) below[folder] = reachable(graph, folder);
    std::set<Folders> cycles;
    for (const auto& [folder, others] : below) {
        if (!others.contains(folder)) continue;
        Folders cycle;
        for (const std::string& other : others) {
            if (const auto found = below.find(other);
                found != below.end() && found->second.contains(folder))
                cycle.insert(other);
        }
        cycles.insert(cycle);
    }
    return cycles;
}

TEST(FolderCycles, FindsAllFoldersOfALongCycle) {
    const std::vector<Include> includes{{"a/x.cpp", "b/x.hpp"},
                                        {"b/x.hpp", "c/x.hpp"},
                                        {"c/x.hpp", "a/x.hpp"},
                                        {"c/x.hpp", "d/x.hpp"},
                                        {"d/x.hpp", "vector"}};
    EXPECT_EQ(folder_cycles(includes), (std::set<Folders>{{"a", "b", "c"}}));
}

TEST(FolderCycles, AreNotInTheProject) {
    const auto includes = all_includes(
        atrium::test::source_dir(),
        {"core", "simulation", "site_node", "world_server", "viewer", "tools", "bench", "tests"});
    EXPECT_EQ(folder_cycles(includes), std::set<Folders>{});
}

TEST_F(Layering, MiddlewareStaysInItsAdapters) {
    struct Rule {
        std::vector<std::string> headers;
        std::vector<std::string> homes;
    };
    const std::vector<Rule> rules{
        {{"dds/", "ddsc/"}, {"core/bus/"}},
        {{"bullet/", "btBullet", "BulletCollision", "BulletDynamics", "LinearMath/"},
         {"world_server/physics/"}},
        {{"draco/"}, {"core/codec/"}},
        {{"turbojpeg.h"}, {"core/codec/"}},
        {{"libav"}, {"viewer/", "site_node/capture/"}},
        {{"GL/osmesa.h", "glad/"}, {"core/gl/", "simulation/", "viewer/", "site_node/preview/"}},
        {{"EGL/"}, {"core/gl/"}},
        {{"GLFW/"}, {"viewer/", "site_node/preview/"}},
        {{"imgui"}, {"viewer/"}},
        {{"toml.hpp"}, {"core/config/", "tools/calibrate/"}},
        {{"CLI/"},
         {"core/app/",
          "tools/calibrate/",
          "tools/doctor/",
          "tools/keys/",
          "tools/plan/",
          "tools/site_control/",
          "tools/tunnel/",
          "tools/visual_hull/"}},
        {{"openssl/"}, {"core/keys/"}},
        {{"spdlog/"}, {"core/app/"}},
        {{"arv.h"}, {"tools/simulated_cameras/", "site_node/capture/"}},
        {{"assimp/"}, {"core/model/", "simulation/"}},
        {{"ceres/", "glog/"}, {"tools/calibrate/adjust/", "tools/calibrate/refine/"}},
    };
    for (const Include& include : includes_) {
        for (const Rule& rule : rules) {
            if (!starts_with_any(include.target, rule.headers)) continue;
            EXPECT_TRUE(starts_with_any(include.file, rule.homes))
                << include.file << " includes " << include.target;
        }
    }
}

TEST_F(Layering, AlgorithmHeadersIncludeNoLibraries) {
    for (const Include& include : includes_) {
        if (!include.file.ends_with(".hpp")) continue;
        EXPECT_FALSE(
            starts_with_any(
                include.target,
                {"opencv2/", "bullet/", "draco/", "toml.hpp", "GLFW/", "dds/", "openssl/"}) &&
            !include.file.ends_with("_internal.hpp") && include.file.rfind("core/bus/", 0) != 0 &&
            include.file.rfind("world_server/physics/", 0) != 0)
            << include.file << " includes " << include.target;
    }
}

TEST_F(Layering, HasNoCommonOrUtilsFolder) {
    const std::set<std::string> forbidden{"common", "utils", "util", "misc", "helpers"};
    for (const Include& include : includes_) {
        for (const auto& part : fs::path(include.file).parent_path())
            EXPECT_EQ(forbidden.count(part.string()), 0u);
    }
}

}  // namespace
}  // namespace atrium
