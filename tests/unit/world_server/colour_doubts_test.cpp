// Textures and colours of model files.
#include "tests/unit/world_server/world_doubts.hpp"

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(WorldDoubts, NameATextureOfAModelFileThatIsNotDrawn) {
    EXPECT_THAT(doubts(kRock),
                ElementsAre(AllOf(HasSubstr("texture_not_drawn model=rock.obj"),
                                  HasSubstr("names=\"stone.png\""))));
    EXPECT_THAT(doubts(std::string(kRock) + "texture = \"own.png\"\n"), IsEmpty());
    EXPECT_THAT(doubts("[[scenery]]\nname = \"s\"\nmodel = \"rock.obj\"\n"),
                ElementsAre(HasSubstr("texture_not_drawn")));
}

constexpr const char* kTwoColours =
    "mtllib two.mtl\nv 0 0 0\nv 0.9 0 0\nv 0 0.9 0\nv 0 0 0.9\n"
    "usemtl red\nf 1 3 2\nf 1 2 4\nusemtl green\nf 1 4 3\nf 2 3 4\n";

TEST_F(WorldDoubts, NameColoursOfAModelFileThatAreNotDrawn) {
    put("car.obj", kTwoColours);
    put("two.mtl", "newmtl red\nKd 0.8 0.1 0.1\nnewmtl green\nKd 0.1 0.8 0.1\n");
    const std::string car =
        "[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = \"car.obj\"\nmass_kg = 1\n";
    const auto undrawn = HasSubstr(
        "colour_not_drawn model=car.obj name=car reason=\"its file has 2 colours, but all of it is "
        "drawn in [0.70, 0.70, 0.70]\"");
    EXPECT_THAT(doubts(car), ElementsAre(undrawn));
    EXPECT_THAT(doubts(car + "material = \"plastic\"\n"), ElementsAre(HasSubstr("2 colours")));
    EXPECT_THAT(doubts(car + "colour = [1, 1, 1]\n"), IsEmpty()) << "chosen";
    EXPECT_THAT(doubts(car + "texture = \"own.png\"\n"), IsEmpty());
    EXPECT_THAT(doubts("[[scenery]]\nname = \"s\"\nmodel = \"car.obj\"\n"), IsEmpty())
        << "scenery has the colours of its file";
    const std::string wall = "[[scenery]]\nname = \"s\"\nmodel = \"car.obj\"\n";
    EXPECT_THAT(doubts(wall + "colour = [0.1, 0.2, 0.3]\n"),
                ElementsAre(HasSubstr("colour_not_drawn model=car.obj name=s reason=\"each part of "
                                      "its file has a colour of its own\"")));
    EXPECT_THAT(doubts(wall + "material = \"stone\"\n"), IsEmpty()) << "for its friction";
    put("two.mtl", "newmtl red\nKd 0.8 0.1 0.1\nnewmtl green\nKd 0.8 0.1 0.1\n");
    EXPECT_THAT(doubts(car), IsEmpty()) << "one colour is drawn";
    EXPECT_THAT(doubts(car + "material = \"plastic\"\n"),
                ElementsAre(AllOf(HasSubstr("its colour is [0.80, 0.10, 0.10], but that of its "
                                            "material is drawn, [0.70, 0.10, 0.08]"),
                                  HasSubstr("write colour = [0.80, 0.10, 0.10]"))));
    put("two.mtl", "newmtl other\nKd 1 1 1\n");
    EXPECT_THAT(doubts(car), IsEmpty()) << "the file states no colour";
    put("car.obj", "v 0 0 0\nv 0.9 0 0\nv 0 0.9 0\nv 0 0 0.9\nf 1 3 2\nf 1 2 4\n");
    EXPECT_THAT(doubts(wall + "colour = [0.1, 0.2, 0.3]\n"), IsEmpty()) << "it is drawn";
}

TEST_F(WorldDoubts, NameAFileOfColoursThatIsNotThere) {
    put("car.obj", kTwoColours);
    const std::string car =
        "[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = \"car.obj\"\nmass_kg = 1\n";
    const auto named = HasSubstr(
        "colour_not_drawn model=car.obj names=\"two.mtl\" reason=\"the file of its colours is not "
        "there\"");
    EXPECT_THAT(doubts(car), ElementsAre(named));
    const std::string wall =
        "[[scenery]]\nname = \"s\"\nmodel = \"car.obj\"\ncolour = [0.1, 0.2, 0.3]\n";
    EXPECT_THAT(doubts(wall), ElementsAre(named)) << "and its colour is drawn";
    EXPECT_THAT(doubts(car + "texture = \"own.png\"\n"), IsEmpty());
    put("two.mtl", "newmtl red\nKd 0.8 0.1 0.1\nnewmtl green\nKd 0.8 0.1 0.1\n");
    EXPECT_THAT(doubts(car), IsEmpty());
}

// Assimp asks for parts of the path of as many letters as the missing name, which may be folders.
TEST_F(WorldDoubts, NameAFileOfColoursThatIsNotThereInAnyFolder) {
    for (std::size_t num_letters = 1; num_letters <= 16; ++num_letters) {
        const std::string folder(num_letters, 'f');
        std::filesystem::create_directories(folder_ / folder);
        put(folder + "/car.obj", kTwoColours);
        EXPECT_THAT(doubts("[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = \"" + folder +
                           "/car.obj\"\nmass_kg = 1\n"),
                    ElementsAre(HasSubstr("the file of its colours is not there")))
            << folder;
    }
}

TEST_F(WorldDoubts, ReadColoursWhereverTheModelSaysTheyAre) {
    put("two.mtl", "newmtl red\nKd 0.8 0.1 0.1\nnewmtl green\nKd 0.1 0.8 0.1\n");
    const std::string without_key =
        std::string(kTwoColours).substr(std::string("mtllib two.mtl").size());
    for (const char* written : {"two.mtl",
                                "./two.mtl",
                                "TWO.MTL",
                                "/home/anna/two.mtl",
                                "C:\\Users\\anna\\my desk\\Two.mtl"}) {
        put("car.obj", std::string("mtllib ") + written + without_key);
        EXPECT_THAT(doubts("[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = "
                           "\"car.obj\"\nmass_kg = 1\n"),
                    ElementsAre(HasSubstr("its file has 2 colours")))
            << written;
    }
    put("two-again.obj", "mtllib car.mtl" + without_key);
    put("two-again.mtl", "newmtl red\nKd 0.8 0.1 0.1\nnewmtl green\nKd 0.1 0.8 0.1\n");
    EXPECT_THAT(doubts("[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = "
                       "\"two-again.obj\"\nmass_kg = 1\n"),
                ElementsAre(HasSubstr("its file has 2 colours")))
        << "both were renamed";
}

TEST_F(WorldDoubts, NameColoursOfAGltfFile) {
    const std::string car =
        "[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = \"car.gltf\"\nmass_kg = 1\n";
    const std::string two =
        R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.8,0.1,0.1,1]}},)"
        R"({"pbrMetallicRoughness":{"baseColorFactor":[0.05,0.05,0.05,1]}}],)";
    put("car.gltf", tetrahedron_gltf(R"(,"material":0)", R"(,"material":1)", two));
    EXPECT_THAT(doubts(car), ElementsAre(HasSubstr("name=car reason=\"its file has 2 colours")));
    put("car.gltf", tetrahedron_gltf(R"(,"material":1)", R"(,"material":1)", two));
    EXPECT_THAT(doubts(car + "material = \"steel\"\n"),
                ElementsAre(HasSubstr("its colour is [0.05, 0.05, 0.05], but")));
    put("car.gltf", tetrahedron_gltf("", "", ""));
    EXPECT_THAT(doubts(car + "material = \"steel\"\n"), IsEmpty()) << "no material";
}

TEST_F(WorldDoubts, NameGlassThatIsDrawnOpaque) {
    const std::string car =
        "[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = \"car.gltf\"\nmass_kg = 1\n";
    const auto glass = [](const std::string& mode, double alpha) {
        return R"("materials":[{"alphaMode":")" + mode +
               R"(","pbrMetallicRoughness":{"baseColorFactor":[0.8,0.1,0.1,)" +
               std::to_string(alpha) + "]}}],";
    };
    const auto named = ElementsAre(
        HasSubstr("transparency_not_drawn model=car.gltf reason=\"its file has transparent parts"));
    const std::string both = R"(,"material":0)";
    put("car.gltf", tetrahedron_gltf(both, both, glass("BLEND", 0.25)));
    EXPECT_THAT(doubts(car), named);
    EXPECT_THAT(doubts("[[scenery]]\nname = \"s\"\nmodel = \"car.gltf\"\n"), named);
    put("car.gltf", tetrahedron_gltf(both, both, glass("BLEND", 1.0)));
    EXPECT_THAT(doubts(car), IsEmpty());
    put("car.gltf", tetrahedron_gltf(both, both, glass("OPAQUE", 0.25)));
    EXPECT_THAT(doubts(car), IsEmpty()) << "the alpha has no meaning";
    put("two.mtl", "newmtl red\nKd 0.8 0.1 0.1\nd 0.3\nnewmtl green\nKd 0.8 0.1 0.1\n");
    put("car.obj", kTwoColours);
    EXPECT_THAT(doubts("[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = \"car.obj\"\n"
                       "mass_kg = 1\n"),
                ElementsAre(HasSubstr("transparency_not_drawn model=car.obj")));
}

// Read without them, the geometry would be another one.
TEST_F(WorldDoubts, RefuseAGltfFileThatNeedsAnUnknownPacking) {
    std::string text = tetrahedron_gltf("", "", "");
    const auto error_of = [&](const std::string& required) {
        put("car.gltf", R"({"extensionsRequired":[)" + required + "]," + text.substr(1));
        put("world.toml",
            "[[object]]\nname = \"car\"\nshape = \"convex\"\nmodel = \"car.gltf\"\nmass_kg = 1\n");
        const auto config = test_support::load_world(folder_ / "world.toml");
        return config ? "" : config.error().message;
    };
    EXPECT_EQ(error_of(""), "");
    EXPECT_EQ(error_of(R"("KHR_materials_unlit", 7)"), "");
    EXPECT_THAT(
        error_of(R"("KHR_materials_unlit","KHR_mesh_quantization")"),
        HasSubstr("needs the glTF extension KHR_mesh_quantization, which is not read: export "
                  "it with numbers of full size (gltfpack -noq)"));
    EXPECT_THAT(error_of(R"("EXT_meshopt_compression")"), HasSubstr("export it uncompressed"));
    EXPECT_THAT(error_of(R"("EXT_mesh_gpu_instancing")"), HasSubstr("without instances"));
}

}  // namespace
}  // namespace atrium::world_server
