#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "simulation/joint_names.hpp"
#include "simulation/model.hpp"
#include "simulation/room_renderer.hpp"
#include "simulation/simulated_loop.hpp"
#include "simulation/tga.hpp"
#include "tests/unit/simulation/made_person.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace atrium::simulation {
namespace {

namespace fs = std::filesystem;
using made::Names;
using made::PersonOptions;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// An uncompressed TGA of 32 bits, whose lower half has that alpha.
void write_tga(const fs::path& file, std::array<int, 3> rgb, int lower_alpha) {
    constexpr int kSide = 16;
    std::string bytes(18, '\0');
    bytes[2] = 2;
    bytes[12] = bytes[14] = kSide;
    bytes[16] = 32;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            for (const int value : {rgb[2], rgb[1], rgb[0], y < kSide / 2 ? lower_alpha : 255})
                bytes += static_cast<char>(value);
        }
    }
    std::ofstream(file, std::ios::binary) << bytes;
}

class MadeModel : public testing::Test {
protected:
    void SetUp() override {
        std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        folder_ = fs::path(testing::TempDir()) / ("atrium_made_" + name);
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    RoomOptions room(const std::string& model) const {
        RoomOptions options;
        options.model = folder_ / model;
        options.loop_s = 1.0;
        options.noise_lsb = 0.0;
        options.num_empty_frames = 1;
        return options;
    }

    // In centimetres, with biped names and PreRotations.
    static PersonOptions biped() {
        PersonOptions person;
        person.names = Names::kBiped;
        person.units_per_m = 100.0;
        person.fbx_unit_scale = 1.0;
        return person;
    }

    fs::path folder_;
};

// Mean place of the left hand, the joint after upper arm and forearm.
Eigen::Vector3d hand_of(const Model& model, double time_s) {
    // the hand's vertices are the farthest from the body's axis at the left
    PosedSkin skin;
    model.pose(time_s, skin);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int num = 0;
    const made::Body body = made::body_of(made::joints_of({}));
    constexpr std::size_t kHand = made::kLeftArm + 2;
    // vertices of FBX are one per corner, in the order of the triangles
    const bool is_per_corner = skin.positions.size() == 3 * body.triangles.size();
    for (std::size_t v = 0; v < skin.positions.size(); ++v) {
        const std::size_t own =
            is_per_corner ? static_cast<std::size_t>(body.triangles[v / 3][v % 3]) : v;
        if (body.joint[own] != kHand) continue;
        sum += skin.positions[v].cast<double>();
        ++num;
    }
    return sum / std::max(1, num);
}

geometry::Aabb bounds(const Model& model, double time_s) {
    PosedSkin skin;
    model.pose(time_s, skin);
    geometry::Aabb box;
    for (const Eigen::Vector3f& p : skin.positions) box.add(p.cast<double>());
    return box;
}

// Facing +Y the left hand is at -X. It is raised from the side to above the shoulder.
void expect_raises_left_arm(const Model& model, double tolerance_m) {
    const Eigen::Vector3d start = hand_of(model, 0.0);
    const Eigen::Vector3d end = hand_of(model, 0.999);
    const Eigen::Vector3d moved = end - start;
    constexpr double kReach = 0.28 + 0.25 + 0.08;  // from the shoulder to the middle of the hand
    EXPECT_NEAR(moved.x(), kReach, tolerance_m);
    EXPECT_NEAR(moved.y(), 0.0, tolerance_m);
    EXPECT_NEAR(moved.z(), kReach, tolerance_m);
    EXPECT_LT(start.x(), end.x());
}

void expect_stands(const Model& model) {
    const geometry::Aabb box = bounds(model, 0.0);
    EXPECT_NEAR(box.min.z(), 0.0, 0.01);
    EXPECT_NEAR(box.max.z(), 1.80, 0.02);
    EXPECT_NEAR(model.report().height_m, 1.80, 0.02);
    EXPECT_GT(box.size().x(), 1.6);  // the arms
    EXPECT_LT(box.size().y(), 0.5);
}

TEST_F(MadeModel, StandsAndMovesInEveryFormatUnitAndAxis) {
    for (const bool is_z_up : {false, true}) {
        for (const Names names : {Names::kBiped, Names::kMixamo, Names::kUnknown}) {
            PersonOptions person = biped();
            person.names = names;
            person.is_z_up = is_z_up;
            person.is_mesh_turned = names == Names::kBiped;
            made::write_fbx(folder_ / "person.fbx", person);
            const auto model = Model::load(room("person.fbx"));
            ASSERT_TRUE(model) << model.error().message;
            SCOPED_TRACE(is_z_up);
            SCOPED_TRACE(static_cast<int>(names));
            expect_stands(*model);
            expect_raises_left_arm(*model, 0.02);
            EXPECT_EQ(model->report().num_bones, made::kNumJoints);
            EXPECT_THAT(model->report().warnings, IsEmpty());
        }
    }
    PersonOptions person;
    made::write_gltf(folder_ / "person.gltf", person);
    const auto model = Model::load(room("person.gltf"));
    ASSERT_TRUE(model) << model.error().message;
    expect_stands(*model);
    expect_raises_left_arm(*model, 0.02);
    EXPECT_THAT(model->report().warnings, IsEmpty());
}

TEST_F(MadeModel, UnitsThatContradictThePersonAreReplacedAndSaid) {
    PersonOptions person;
    person.units_per_m = 100.0;
    made::write_gltf(folder_ / "cm.gltf", person);  // glTF is in metres
    const auto model = Model::load(room("cm.gltf"));
    ASSERT_TRUE(model) << model.error().message;
    expect_stands(*model);
    EXPECT_THAT(model->report().warnings, ElementsAre(HasSubstr("taken as centimetres: 1.79 m")));
}

TEST_F(MadeModel, AxesThatContradictTheSkeletonAreReplacedAndSaid) {
    PersonOptions person = biped();
    person.is_z_up = true;
    made::write_fbx(folder_ / "person.fbx", person);
    // a file whose settings say +Y
    std::ifstream in(folder_ / "person.fbx");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string up = "P: \"UpAxis\", \"int\", \"Integer\", \"\",";
    const std::size_t at = text.find(up + "2");
    ASSERT_NE(at, std::string::npos);
    text.replace(at, up.size() + 1, up + "1");
    std::ofstream(folder_ / "person.fbx") << text;
    const auto model = Model::load(room("person.fbx"));
    ASSERT_TRUE(model) << model.error().message;
    expect_stands(*model);
    expect_raises_left_arm(*model, 0.02);
    EXPECT_THAT(model->report().warnings,
                ElementsAre(HasSubstr("up is +Z by the skeleton (feet to head), but +Y")));
}

TEST_F(MadeModel, LiesWhereOnlyItsAnimationDoes) {
    for (const bool is_fbx : {true, false}) {
        PersonOptions person = is_fbx ? biped() : PersonOptions{};
        person.is_lying = true;
        const std::string name = is_fbx ? "lying.fbx" : "lying.gltf";
        is_fbx ? made::write_fbx(folder_ / name, person) : made::write_gltf(folder_ / name, person);
        const auto model = Model::load(room(name));
        ASSERT_TRUE(model) << model.error().message;
        const geometry::Aabb box = bounds(*model, 0.0);
        EXPECT_LT(box.size().z(), 0.5) << name;
        EXPECT_NEAR(box.size().y(), 1.80, 0.05) << name;
        EXPECT_NEAR(model->report().height_m, 1.80, 0.02) << name;
    }
}

TEST_F(MadeModel, HasTheVolumeOfAPerson) {
    made::write_fbx(folder_ / "person.fbx", biped());
    const auto model = Model::load(room("person.fbx"));
    ASSERT_TRUE(model) << model.error().message;
    PosedSkin skin;
    model->pose(0.0, skin);
    double litres = 0.0;  // limbs that overlap count twice
    for (const auto& t : model->surface().triangles) {
        const Eigen::Vector3d a = skin.positions[t[0]].cast<double>();
        const Eigen::Vector3d b = skin.positions[t[1]].cast<double>();
        const Eigen::Vector3d c = skin.positions[t[2]].cast<double>();
        litres += 1000.0 * a.dot(b.cross(c)) / 6.0;
    }
    EXPECT_GT(litres, 60.0);
    EXPECT_LT(litres, 120.0);
}

TEST_F(MadeModel, BlackWithoutItsPicturesIsGreyAndNamesThem) {
    PersonOptions person = biped();
    person.colour.setZero();
    person.picture = "C:\\maps\\m001_body_color.tga";
    made::write_fbx(folder_ / "person.fbx", person);
    const auto model = Model::load(room("person.fbx"));
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_TRUE(model->surface().colours.front().isApprox(Eigen::Vector3f::Constant(0.6f)));
    EXPECT_EQ(model->surface().parts.front().texture, -1);
    EXPECT_THAT(model->report().warnings,
                ElementsAre(testing::AllOf(HasSubstr("m001_body_color.tga"), HasSubstr("grey"))));
}

TEST_F(MadeModel, FindsPicturesOfAnotherComputer) {
    PersonOptions person = biped();
    person.colour.setZero();
    person.picture = "C:\\maps\\Body.tga";
    made::write_fbx(folder_ / "person.fbx", person);
    fs::create_directories(folder_ / "Textures");
    write_tga(folder_ / "Textures" / "body.TGA", {200, 40, 20}, 255);
    const auto cameras = ring(1);
    const RoomOptions options = room("person.fbx");
    const fs::path with_picture = cache_file(cameras, options, "cache");
    const auto model = Model::load(options);
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->surface().textures.size(), 1u);
    const ModelTexture& texture = model->surface().textures.front();
    EXPECT_THAT(std::vector<std::uint8_t>(texture.rgba.begin(), texture.rgba.begin() + 4),
                ElementsAre(200, 40, 20, 255));
    EXPECT_TRUE(model->surface().colours.front().isApprox(Eigen::Vector3f::Ones()));
    EXPECT_THAT(model->report().warnings, IsEmpty());
    // a picture that comes or goes renders the room again
    fs::remove_all(folder_ / "Textures");
    EXPECT_NE(cache_file(cameras, options, "cache"), with_picture);
}

TEST_F(MadeModel, TransparentPlacesAreHoles) {
    PersonOptions person = biped();
    person.picture = "body.tga";
    made::write_fbx(folder_ / "whole.fbx", person);
    person.opacity_picture = "body.tga";
    made::write_fbx(folder_ / "holes.fbx", person);
    write_tga(folder_ / "body.tga", {200, 40, 20}, 0);
    const auto covered = [&](const char* name) {
        auto renderer = RoomRenderer::create(ring(1), room(name));
        image::YuvImage picture;
        image::Mask mask;
        renderer->render(0.0, 0, Scene::kPerson, 0, picture, &mask);
        std::size_t num = 0;
        for (int y = 0; y < mask.height; ++y) {
            for (int x = 0; x < mask.width; ++x) num += mask.at(x, y) != 0 ? 1 : 0;
        }
        return num;
    };
    const std::size_t whole = covered("whole.fbx");
    const std::size_t holes = covered("holes.fbx");
    EXPECT_GT(whole, 3000u);
    EXPECT_LT(holes, whole * 95 / 100);
    EXPECT_GT(holes, whole / 4);
}

TEST_F(MadeModel, MotionOfAnotherToolMovesIt) {
    PersonOptions cmu;
    cmu.names = Names::kCmu;
    made::write_bvh(folder_ / "raise.bvh", cmu);
    for (const bool arms_hang : {false, true}) {
        for (const Names names : {Names::kBiped, Names::kMixamo}) {
            PersonOptions person = names == Names::kBiped ? biped() : PersonOptions{};
            person.names = names;
            person.has_animation = false;
            person.arms_hang = arms_hang;
            const std::string file = names == Names::kBiped ? "still.fbx" : "still.gltf";
            names == Names::kBiped ? made::write_fbx(folder_ / file, person)
                                   : made::write_gltf(folder_ / file, person);
            RoomOptions options = room(file);
            const auto still = Model::load(options);
            ASSERT_TRUE(still) << still.error().message;
            EXPECT_THAT(still->report().warnings, ElementsAre(HasSubstr("has no animation")));
            options.motion_file = folder_ / "raise.bvh";
            const auto model = Model::load(options);
            ASSERT_TRUE(model) << model.error().message;
            SCOPED_TRACE(file);
            SCOPED_TRACE(arms_hang);
            expect_stands(*model);
            expect_raises_left_arm(*model, 0.03);
            EXPECT_THAT(model->report().warnings, IsEmpty());
        }
    }
}

TEST_F(MadeModel, MotionOfItsOwnToolMovesIt) {
    PersonOptions person = biped();
    made::write_fbx(folder_ / "moving.fbx", person);
    person.has_animation = false;
    made::write_fbx(folder_ / "still.fbx", person);
    RoomOptions options = room("still.fbx");
    options.motion_file = folder_ / "moving.fbx";
    const auto model = Model::load(options);
    ASSERT_TRUE(model) << model.error().message;
    expect_stands(*model);
    expect_raises_left_arm(*model, 0.02);
}

TEST_F(MadeModel, SaysWhatIsMissing) {
    const auto error_of = [&](const std::string& model, const std::string& motion) {
        RoomOptions options = room(model);
        if (!motion.empty()) options.motion_file = folder_ / motion;
        const auto loaded = Model::load(options);
        return loaded ? std::string() : loaded.error().message;
    };
    PersonOptions person;
    person.has_animation = false;
    made::write_gltf(folder_ / "still.gltf", person);
    person.has_skin = false;
    made::write_gltf(folder_ / "stiff.gltf", person);
    person.has_animation = true;
    made::write_gltf(folder_ / "boneless.gltf", person);
    PersonOptions motion;
    motion.names = Names::kCmu;
    made::write_bvh(folder_ / "raise.bvh", motion);
    motion.names = Names::kUnknown;
    made::write_bvh(folder_ / "unknown.bvh", motion);

    EXPECT_THAT(error_of("stiff.gltf", "raise.bvh"), HasSubstr("no bones with weights"));
    EXPECT_THAT(error_of("still.gltf", "unknown.bvh"),
                testing::AllOf(HasSubstr("0 of the model's bones are known by name"),
                               HasSubstr("The motion has: node_0"),
                               HasSubstr("The model has: ")));
    EXPECT_THAT(error_of("still.gltf", "still.gltf"), HasSubstr("no animation that moves"));
    EXPECT_THAT(error_of("still.gltf", "none.bvh"), HasSubstr("no such file"));
    EXPECT_THAT(error_of("raise.bvh", ""), HasSubstr("Give it as simulation.motion_file"));
    const auto boneless = Model::load(room("boneless.gltf"));
    ASSERT_TRUE(boneless) << boneless.error().message;
    EXPECT_THAT(boneless->report().warnings, ElementsAre(HasSubstr("no bone weights")));
    RoomOptions alone;
    alone.motion_file = folder_ / "raise.bvh";
    const auto without_model = check(alone);
    ASSERT_FALSE(without_model);
    EXPECT_THAT(without_model.error().message, HasSubstr("needs simulation.model"));
}

TEST(JointNames, KnowsTheUsualTools) {
    const auto known = [](std::vector<std::string> names) {
        std::size_t num = 0;
        for (const auto& joint : human_joints(names)) num += joint ? 1 : 0;
        return num;
    };
    EXPECT_EQ(known({"mixamorig1:Hips", "mixamorig1:LeftUpLeg", "mixamorig1:RightForeArm"}), 3u);
    EXPECT_EQ(known({"Bip001 Pelvis", "Bip001 L Thigh", "Bip001 R UpperArm", "Bip001 Head"}), 4u);
    EXPECT_EQ(known({"pelvis", "thigh_l", "lowerarm_r", "spine_01", "clavicle_l"}), 5u);
    EXPECT_EQ(known({"J_Bip_C_Hips", "J_Bip_L_UpperArm", "J_Bip_R_LowerLeg"}), 3u);
    EXPECT_EQ(known({"DEF-upper_arm.L", "DEF-shin.R", "DEF-spine"}), 3u);
    EXPECT_EQ(known({"Camera", "Lamp", "Bip01", "Armature"}), 0u);
    const auto biovision = human_joints(
        std::vector<std::string>{"LeftCollar", "LeftShoulder", "LeftElbow", "LeftHip", "Hips"});
    EXPECT_THAT(biovision,
                ElementsAre(HumanJoint::kLeftClavicle,
                            HumanJoint::kLeftUpperArm,
                            HumanJoint::kLeftForearm,
                            HumanJoint::kLeftThigh,
                            HumanJoint::kHips));
}

TEST(Tga, ReadsRunsAndRejectsTruncation) {
    std::vector<std::uint8_t> file(18, 0);
    file[2] = 10;
    file[12] = 4;
    file[14] = 2;
    file[16] = 24;
    file[17] = 0x20;
    // four blue pixels as a run, four others one by one
    file.insert(file.end(), {0x83, 255, 0, 0, 0x03, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    const auto picture = read_tga(file);
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->bgra[0], 255);
    EXPECT_EQ(picture->bgra[4 * 4 + 2], 3);
    EXPECT_EQ(picture->bgra[4 * 7], 10);
    for (std::size_t size = 0; size < file.size(); ++size)
        EXPECT_FALSE(read_tga(std::span(file).first(size))) << size;
}

}  // namespace
}  // namespace atrium::simulation
