#include "site_node/views/views_file.hpp"
#include "tools/visual_hull/tool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace atrium::hull_tool {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

// Three cameras on the axes, 8 m away. Each sees a square of 1 m.
json cube_document() {
    const std::vector<std::vector<double>> rotations{{0, 1, 0, 0, 0, -1, -1, 0, 0},
                                                     {-1, 0, 0, 0, 0, -1, 0, -1, 0},
                                                     {1, 0, 0, 0, -1, 0, 0, 0, -1}};
    json document;
    for (std::size_t i = 0; i < rotations.size(); ++i) {
        document["views"].push_back(
            {{"name", "cam" + std::to_string(i)},
             {"width", 640},
             {"height", 480},
             {"fx", 1600.0},
             {"fy", 1600.0},
             {"cx", 320.0},
             {"cy", 240.0},
             {"rotation", rotations[i]},
             {"translation", {0.0, 0.0, 8.0}},
             {"contours", {{{220.3, 140.3}, {419.7, 140.4}, {419.8, 339.7}, {220.2, 339.6}}}}});
    }
    return document;
}

class HullTool : public testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("atrium_hull_tool_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        options_.views_file = folder_ / "views.json";
        write(cube_document().dump());
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void write(const std::string& text) const { std::ofstream(options_.views_file) << text; }
    std::string error_with(const json& document) const {
        write(document.dump());
        const auto report = run(options_);
        return report ? "no error" : report.error().message;
    }
    std::string written(const std::string& name) {
        options_.output = folder_ / name;
        EXPECT_TRUE(run(options_));
        std::ostringstream bytes;
        bytes << std::ifstream(options_.output, std::ios::binary).rdbuf();
        return bytes.str();
    }

    std::filesystem::path folder_;
    ToolOptions options_;
};

TEST_F(HullTool, ReportsOneJsonObject) {
    options_.repeat = 3;
    options_.threads = 2;
    const auto text = run(options_);
    ASSERT_TRUE(text) << text.error().message;
    const json report = json::parse(*text);
    EXPECT_EQ(
        report.at("triangles").get<int>(),
        2 * report.at("vertices").get<int>() - 2 * report.at("euler_characteristic").get<int>());
    EXPECT_EQ(report.at("components"), 1);
    EXPECT_EQ(report.at("closed"), true);
    EXPECT_EQ(report.at("manifold"), true);
    EXPECT_NEAR(report.at("volume_m3").get<double>(), 1.0, 0.1);
    ASSERT_EQ(report.at("views").size(), 3u);
    for (const json& view : report.at("views")) {
        EXPECT_GT(view.at("coverage").get<double>(), 0.98);
        EXPECT_EQ(view.at("excess_px"), 0);
    }
    EXPECT_EQ(report.at("views")[2].at("name"), "cam2");
    for (const char* stage :
         {"silhouettes", "pencils", "sweep", "assembly", "total", "total_min", "total_median"}) {
        EXPECT_GE(report.at("milliseconds").at(stage).get<double>(), 0.0) << stage;
    }
}

TEST_F(HullTool, ReportsAnEmptyHullIfOneCameraSeesNobody) {
    json document = cube_document();
    document["views"][1]["contours"] = json::array();
    write(document.dump());
    const auto text = run(options_);
    ASSERT_TRUE(text);
    const json report = json::parse(*text);
    EXPECT_EQ(report.at("vertices"), 0);
    EXPECT_EQ(report.at("status"), "empty intersection");
    EXPECT_TRUE(report.at("views")[1].at("coverage").is_null());
    EXPECT_EQ(report.at("views")[0].at("coverage"), 0.0);
}

// The first camera sees only one half of the cube. The other half lies outside its picture.
json half_seen_document() {
    json document = cube_document();
    document["views"][0]["cx"] = 639.5;
    document["views"][0]["contours"] = {
        {{539.8, 140.3}, {639.5, 140.4}, {639.5, 339.7}, {539.7, 339.6}}};
    return document;
}

TEST_F(HullTool, CutsAtTheBoundsAndDropsSmallBodies) {
    const json whole = json::parse(*run(options_));
    options_.bounds = geometry::Aabb{{-1, -1, 0.01}, {1, 1, 1}};
    const json upper = json::parse(*run(options_));
    options_.bounds = geometry::Aabb{{-1, -1, -1}, {1, 1, 0.01}};
    const json lower = json::parse(*run(options_));
    EXPECT_NEAR(upper.at("volume_m3").get<double>() + lower.at("volume_m3").get<double>(),
                whole.at("volume_m3").get<double>(),
                1e-6);
    EXPECT_NEAR(upper.at("volume_m3").get<double>(), 0.5, 0.06);
    options_.min_litres = 2000.0;
    const json none = json::parse(*run(options_));
    EXPECT_EQ(none.at("status"), "empty intersection");
    EXPECT_EQ(none.at("fragments_dropped"), 1);
}

TEST_F(HullTool, ExcludesViews) {
    const double volume = json::parse(*run(options_)).at("volume_m3");
    options_.without = {"cam1"};
    const json report = json::parse(*run(options_));
    ASSERT_EQ(report.at("views").size(), 2u);
    EXPECT_EQ(report.at("views")[1].at("name"), "cam2");
    EXPECT_EQ(report.at("views_left_out"), json({"cam1"}));
    EXPECT_GT(report.at("volume_m3").get<double>(), volume);
    options_.without = {"cam1", "north"};
    EXPECT_THAT(run(options_).error().message,
                testing::AllOf(HasSubstr("--without"), HasSubstr("\"north\""), HasSubstr("cam2")));
    options_.without = {"cam1", "cam1"};
    EXPECT_EQ(run(options_).error().message, "--without: view \"cam1\" is named twice");
    options_.without = {"cam1", "cam0"};
    EXPECT_THAT(run(options_).error().message, HasSubstr("too few views"));
}

TEST_F(HullTool, KeepsSpaceOutsideAPictureOnlyWithPartialViews) {
    write(half_seen_document().dump());
    EXPECT_NEAR(json::parse(*run(options_)).at("volume_m3").get<double>(), 0.5, 0.06);
    options_.partial = true;
    options_.bounds = geometry::Aabb{{-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}};
    const json report = json::parse(*run(options_));
    EXPECT_NEAR(report.at("volume_m3").get<double>(), 1.0, 0.1);
    EXPECT_EQ(report.at("manifold"), true);
    for (const json& view : report.at("views")) {
        EXPECT_GT(view.at("coverage").get<double>(), 0.98);
        EXPECT_EQ(view.at("excess_px"), 0);
    }
    options_.min_views = 3;  // only two views see one of the halves
    EXPECT_NEAR(json::parse(*run(options_)).at("volume_m3").get<double>(), 0.5, 0.06);
    options_.min_views = 4;
    EXPECT_THAT(run(options_).error().message, HasSubstr("--min-views"));
}

TEST_F(HullTool, NamesFileViewAndKeyOfAnError) {
    const auto error_after = [&](auto change) {
        json document = cube_document();
        change(document);
        return error_with(document);
    };
    EXPECT_THAT(error_after([](json& d) { d.erase("views"); }),
                HasSubstr("views.json: document: key \"views\""));
    EXPECT_THAT(error_after([](json& d) { d["views"][1].erase("fx"); }),
                HasSubstr("view \"cam1\": key \"fx\" is missing"));
    EXPECT_THAT(error_after([](json& d) { d["views"][1]["fy"] = -1; }),
                HasSubstr("view \"cam1\".fy: must be positive"));
    EXPECT_THAT(error_after([](json& d) { d["views"][2]["width"] = 1e9; }),
                HasSubstr("view \"cam2\".width"));
    EXPECT_THAT(
        error_after([](json& d) { d["views"][2]["width"] = d["views"][2]["height"] = 8193; }),
        HasSubstr("view \"cam2\": width times height must be at most 67108864"));
    EXPECT_THAT(error_after([](json& d) { d["views"][0]["rotation"][4] = 0.5; }),
                HasSubstr("view \"cam0\".rotation"));
    EXPECT_THAT(error_after([](json& d) { d["views"][0]["contours"][0][2] = "x"; }),
                HasSubstr("view \"cam0\".contours[0][2]: must be [x, y]"));
    EXPECT_THAT(error_after([](json& d) { d["views"][1]["name"] = "cam0"; }),
                HasSubstr("used twice"));
    EXPECT_THAT(error_after([](json& d) {
                    d["views"].erase(1);
                    d["views"].erase(1);
                }),
                HasSubstr("too few views"));
    EXPECT_THAT(error_after([](json& d) {
                    d["views"][1]["distortion"] = {0.1, 0, 0, 0, 0};
                }),
                AllOf(HasSubstr("views[1]: unknown key \"distortion\""), HasSubstr("skew")));
    EXPECT_THAT(error_after([](json& d) { d["cameras"] = 3; }),
                HasSubstr("document: unknown key \"cameras\""));
    std::string twice = cube_document().dump();
    twice.insert(twice.rfind("\"fx\""), "\"fx\":1500,");
    write(twice);
    EXPECT_THAT(run(options_).error().message, HasSubstr("views[2]: key \"fx\" is repeated"));
    write("{\"views\": [");
    EXPECT_THAT(run(options_).error().message, HasSubstr("views.json: "));
    options_.views_file = folder_ / "none.json";
    EXPECT_EQ(run(options_).error().kind, ErrorKind::kNotFound);
}

TEST_F(HullTool, RefusesUnknownMeshFormatsBeforeItComputes) {
    options_.output = folder_ / "hull.stl";
    EXPECT_THAT(run(options_).error().message, HasSubstr(".ply, .obj, .gltf or .glb"));
}

TEST_F(HullTool, ReportsAnUnwritableOutputFirst) {
    options_.output = folder_ / "none" / "hull.ply";
    options_.views_file = folder_ / "none.json";
    const auto report = run(options_);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(report.error().message,
                HasSubstr("hull.ply: cannot create: No such file or directory"));
    std::filesystem::create_directory(folder_ / "meshes");
    options_.output = folder_ / "mehses" / "hull.ply";
    EXPECT_THAT(run(options_).error().message, HasSubstr("meshes?"));
}

TEST_F(HullTool, KeepsTheOldOutputWithoutAHull) {
    options_.views_file = folder_ / "none.json";
    options_.output = folder_ / "new.ply";
    EXPECT_FALSE(run(options_));
    EXPECT_FALSE(std::filesystem::exists(options_.output));
    options_.output = folder_ / "old.ply";
    std::ofstream(options_.output) << "old";
    EXPECT_FALSE(run(options_));
    EXPECT_EQ(std::filesystem::file_size(options_.output), 3u);
}

TEST_F(HullTool, WritesAPlyWithAMatchingHeader) {
    const json report = json::parse(*run(options_));
    const std::string ply = written("hull.ply");
    const std::string header = ply.substr(0, ply.find("end_header\n") + 11);
    EXPECT_THAT(header, HasSubstr("element vertex " + report.at("vertices").dump() + "\n"));
    EXPECT_EQ(ply.size() - header.size(),
              24 * report.at("vertices").get<std::size_t>() +
                  13 * report.at("triangles").get<std::size_t>());
}

TEST_F(HullTool, WritesAnObjWithOneBasedIndices) {
    std::istringstream obj(written("hull.OBJ"));
    int num_vertices = 0;
    int lowest = 1 << 30;
    int highest = 0;
    for (std::string line; std::getline(obj, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        num_vertices += kind == "v" ? 1 : 0;
        for (int index = 0; kind == "f" && words >> index;) {
            lowest = std::min(lowest, index);
            highest = std::max(highest, index);
        }
    }
    EXPECT_EQ(lowest, 1);
    EXPECT_EQ(highest, num_vertices);
}

TEST_F(HullTool, WritesGltfWithAConsistentBuffer) {
    const json report = json::parse(*run(options_));
    const json gltf = json::parse(written("hull.gltf"));
    const std::size_t bytes = 12 * report.at("vertices").get<std::size_t>() +
                              12 * report.at("triangles").get<std::size_t>();
    EXPECT_EQ(gltf.at("buffers")[0].at("byteLength").get<std::size_t>(), bytes);
    const std::string uri = gltf.at("buffers")[0].at("uri");
    const std::string prefix = "data:application/octet-stream;base64,";
    ASSERT_EQ(uri.rfind(prefix, 0), 0u);
    EXPECT_EQ(uri.size() - prefix.size(), (bytes + 2) / 3 * 4);
    EXPECT_EQ(gltf.at("accessors")[0].at("count"), report.at("vertices"));
    const std::string glb = written("hull.glb");
    EXPECT_EQ(glb.substr(0, 4), "glTF");
    EXPECT_EQ(glb.size() % 4, 0u);
}

TEST_F(HullTool, WritesUnitNormalsThatPointOutwardsToPly) {
    const json report = json::parse(*run(options_));
    const std::size_t plain = written("plain.ply").size();
    options_.normals = true;
    const std::string ply = written("hull.ply");
    const std::size_t begin = ply.find("end_header\n") + 11;
    const std::string declared = "property float nx\nproperty float ny\nproperty float nz\n";
    EXPECT_THAT(ply.substr(0, begin), HasSubstr(declared));
    const auto num_vertices = report.at("vertices").get<std::size_t>();
    EXPECT_EQ(ply.size(), plain + declared.size() + 12 * num_vertices);
    for (std::size_t i = 0; i < num_vertices; ++i) {
        Eigen::Vector3d p;
        Eigen::Vector3f n;
        std::memcpy(p.data(), ply.data() + begin + 36 * i, 24);
        std::memcpy(n.data(), ply.data() + begin + 36 * i + 24, 12);
        EXPECT_NEAR(n.norm(), 1.0f, 1e-5f);
        EXPECT_GT(n.cast<double>().dot(p), 0.0);  // the cube is around the origin
    }
}

TEST_F(HullTool, WritesNormalsToObjAndGltf) {
    const json report = json::parse(*run(options_));
    const auto num_vertices = report.at("vertices").get<std::size_t>();
    const auto num_triangles = report.at("triangles").get<std::size_t>();
    options_.normals = true;
    std::istringstream obj(written("hull.obj"));
    std::size_t num_normals = 0;
    for (std::string line; std::getline(obj, line);) {
        num_normals += line.rfind("vn ", 0) == 0 ? 1 : 0;
        if (line.rfind("f ", 0) != 0) continue;
        std::istringstream words(line.substr(2));
        for (std::string word; words >> word;) {
            const std::size_t slashes = word.find("//");
            ASSERT_NE(slashes, std::string::npos);
            EXPECT_EQ(word.substr(0, slashes), word.substr(slashes + 2));
        }
    }
    EXPECT_EQ(num_normals, num_vertices);
    const json gltf = json::parse(written("hull.gltf"));
    const json& primitive = gltf.at("meshes")[0].at("primitives")[0];
    const json& accessor = gltf.at("accessors")[primitive["attributes"]["NORMAL"].get<int>()];
    EXPECT_EQ(accessor.at("count"), num_vertices);
    EXPECT_EQ(accessor.at("type"), "VEC3");
    const json& view = gltf.at("bufferViews")[accessor.at("bufferView").get<int>()];
    EXPECT_EQ(view.at("byteLength"), 12 * num_vertices);
    EXPECT_EQ(gltf.at("buffers")[0].at("byteLength"), 24 * num_vertices + 12 * num_triangles);
}

TEST_F(HullTool, DecimatesTheWrittenMesh) {
    // a square with cut corners: it has short edges to remove
    json document = cube_document();
    for (json& view : document["views"]) {
        view["contours"] = {{{220.3, 150.1},
                             {230.2, 140.3},
                             {409.6, 140.4},
                             {419.7, 150.2},
                             {419.8, 329.5},
                             {409.4, 339.7},
                             {230.5, 339.6},
                             {220.2, 329.8}}};
    }
    write(document.dump());
    const json exact = json::parse(*run(options_));
    EXPECT_FALSE(exact.contains("decimated_triangles"));
    options_.decimate_mm = 60.0;
    options_.output = folder_ / "hull.ply";
    const json report = json::parse(*run(options_));
    EXPECT_EQ(report.at("triangles"), exact.at("triangles"));
    EXPECT_LT(report.at("decimated_triangles"), exact.at("triangles"));
    EXPECT_GT(report.at("distance_bound_mm").get<double>(), 1.0);
    EXPECT_LE(report.at("distance_bound_mm").get<double>(), 60.0);
    EXPECT_THAT(written("hull.ply"),
                HasSubstr("element face " + report.at("decimated_triangles").dump() + "\n"));
}

}  // namespace
}  // namespace atrium::hull_tool
