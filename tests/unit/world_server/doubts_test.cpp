#include "tests/unit/world_server/world_doubts.hpp"

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(WorldDoubts, NameAJointOutsideTheWorld) {
    const std::string joint = std::string(kRock) +
                              "texture = \"own.png\"\n[[joint]]\nkind = \"hinge\"\na = \"rock\"\n"
                              "axis = [0, 0, 1]\n";
    EXPECT_THAT(doubts(joint + "anchor_m = [0.5, 0, 0]\n"), IsEmpty());
    EXPECT_THAT(doubts(joint + "anchor_m = [500, 0, 0]\n"),
                ElementsAre(HasSubstr("joint_looks_wrong a=rock b=world "
                                      "reason=\"anchor_m [500, 0, 0] is outside")));
}

TEST_F(WorldDoubts, NameASliderThatLeadsOutOfTheWorld) {
    const std::string slider = std::string(kRock) +
                               "texture = \"own.png\"\n[[joint]]\nkind = \"slider\"\na = \"rock\"\n"
                               "axis = [1, 0, 0]\nanchor_m = [0, 0, 0]\n";
    EXPECT_THAT(doubts(slider), IsEmpty());
    EXPECT_THAT(doubts(slider + "limits_m = [0, 0.4]\n"), IsEmpty());
    EXPECT_THAT(doubts(slider + "limits_m = [0, 400]\n"),
                ElementsAre(HasSubstr("limits_m [0, 400]: 400 m from its start, rock is outside")));
    EXPECT_THAT(doubts(slider + "limits_m = [-40, 0]\n"),
                ElementsAre(HasSubstr("-40 m from its start")));
    EXPECT_THAT(doubts(slider + "limits_m = [0, 19]\n"), IsEmpty()) << "inside the bounds";
}

TEST_F(WorldDoubts, NameASoftModelOfLargeTriangles) {
    const std::string soft =
        "[[soft]]\nname = \"jelly\"\nshape = \"model\"\nmodel = \"rock.obj\"\nmass_kg = 1\n"
        "texture = \"own.png\"\nposition_m = [0, 0, 1]\n";
    EXPECT_THAT(doubts(soft),
                ElementsAre(AllOf(HasSubstr("soft_looks_wrong name=jelly model=rock.obj"),
                                  HasSubstr("are 1.1 m long"))));
    EXPECT_THAT(doubts(soft + "scale = 0.1\n"), IsEmpty());
}

TEST_F(WorldDoubts, NameAJointFarFromBothObjects) {
    const std::string two = box("gate", 1, "position_m = [0, 0, 1]") +
                            box("post", 0, "position_m = [1, 0, 1]") + "[[joint]]\na = \"gate\"\n";
    const std::string hinge = two + "kind = \"hinge\"\naxis = [0, 0, 1]\n";
    EXPECT_THAT(doubts(hinge + "b = \"post\"\nanchor_m = [-0.6, 0, 1]\n"), IsEmpty());
    EXPECT_THAT(doubts(hinge + "b = \"post\"\nanchor_m = [1.6, 0, 1]\n"), IsEmpty())
        << "0.4 m from the post";
    EXPECT_THAT(doubts(hinge + "b = \"post\"\nanchor_m = [0, 1, 1]\n"),
                ElementsAre(HasSubstr("joint_looks_wrong a=gate b=post reason=\"anchor_m [0, 1, 1] "
                                      "is 0.8 m away from both objects")));
    EXPECT_THAT(doubts(two + "kind = \"ball\"\nb = \"post\"\nanchor_m = [0, 1, 1]\n"),
                ElementsAre(HasSubstr("0.8 m away")));
    EXPECT_THAT(
        doubts(hinge + "anchor_m = [0, 3, 1]\n"),
        ElementsAre(HasSubstr("joint_looks_wrong a=gate b=world reason=\"anchor_m [0, 3, 1] "
                              "is 2.8 m away from gate")));
    EXPECT_THAT(doubts(box("gate", 1, "position_m = [0, 0, 1]") +
                       "[[joint]]\na = \"gate\"\nkind = \"hinge\"\naxis = [0, 1, 0]\nanchor_m = "
                       "[0, 0, 3]\n"),
                IsEmpty())
        << "a pendulum";
    EXPECT_THAT(doubts(hinge + "anchor_m = [0, 0.6, 1]\n"), IsEmpty()) << "a lever";
    const std::string spring =
        two + "kind = \"spring\"\nb = \"post\"\nstiffness_npm = 10\nanchor_m = ";
    EXPECT_THAT(doubts(spring + "[0.2, 0, 1]\nanchor_b_m = [0.8, 0, 1]\n"), IsEmpty());
    EXPECT_THAT(doubts(spring + "[0, 0, 3]\nanchor_b_m = [0.8, 0, 1]\n"),
                ElementsAre(HasSubstr("anchor_m [0, 0, 3] is 1.8 m away from gate;")));
    EXPECT_THAT(doubts(spring + "[0.2, 0, 1]\nanchor_b_m = [0, 0, 0]\n"),
                ElementsAre(HasSubstr("anchor_b_m [0, 0, 0] is 1.1 m away from post;")));
    const std::string slider = two + "kind = \"slider\"\nb = \"post\"\naxis = [1, 0, 0]\n";
    EXPECT_THAT(doubts(slider + "anchor_m = [0.5, 0, 1]\n"), IsEmpty());
    EXPECT_THAT(doubts(slider + "anchor_m = [0, 3, 1]\n"),
                ElementsAre(HasSubstr("2.8 m away from both objects")));
    EXPECT_THAT(doubts(kFloor + hinge + "b = \"floor\"\nanchor_m = [0, 3, 0.3]\n"), IsEmpty())
        << "a floor is everywhere";
}

TEST_F(WorldDoubts, NameAJointFarFromOneOfItsObjects) {
    const auto joint = [](const std::string& kind, const std::string& shelf, double mass_kg) {
        return box("ball", 1, "position_m = [2, 0, 2]") + box("shelf", mass_kg, shelf) +
               "[[joint]]\nkind = \"" + kind +
               "\"\na = \"ball\"\nb = \"shelf\"\nanchor_m = [2, 0, 1.8]\n";
    };
    EXPECT_THAT(doubts(joint("ball", "position_m = [-3, 0, 2]", 1)),
                ElementsAre(HasSubstr(
                    "joint_looks_wrong a=ball b=shelf reason=\"anchor_m [2, 0, 1.8] is 4.8 m away "
                    "from shelf, but at ball; it is a place in the world, not in an object; if it "
                    "is right, a or b names the wrong one\"")));
    EXPECT_THAT(doubts(joint("ball", "position_m = [0.9, 0, 2]", 1)), IsEmpty()) << "0.9 m away";
    EXPECT_THAT(doubts(joint("ball", "position_m = [2, 0, 0.2]", 1)), IsEmpty()) << "a pendulum";
    EXPECT_THAT(doubts(joint("ball", "position_m = [3.4, 0, 0.8]", 1)), IsEmpty())
        << "a pendulum that starts at 54 degrees";
    EXPECT_THAT(doubts(joint("ball", "position_m = [2, 0, 4]", 1)),
                ElementsAre(HasSubstr("away from shelf")))
        << "on its head";
    EXPECT_THAT(doubts(joint("ball", "position_m = [-3, 0, 2]", 0)), IsEmpty())
        << "a fixed object is like the world";
    EXPECT_THAT(
        doubts(joint("ball", "position_m = [-3, 0, 2]\nroll_pitch_yaw_deg = [0, 0, 90]", 1)),
        ElementsAre(HasSubstr("4.8 m away from shelf")));
}

TEST_F(WorldDoubts, NameAJointThatIsWrittenTwice) {
    const std::string two =
        box("gate", 1, "position_m = [0, 0, 1]") + box("post", 0, "position_m = [0.5, 0, 1]");
    const auto joint = [](const std::string& a, const std::string& b, const std::string& rest) {
        return "[[joint]]\na = \"" + a + "\"\nb = \"" + b + "\"\n" + rest;
    };
    const std::string hinge = "kind = \"hinge\"\nanchor_m = [0.2, 0, 1]\naxis = [0, 0, 1]\n";
    EXPECT_THAT(doubts(two + joint("gate", "post", hinge) + joint("gate", "post", hinge)),
                ElementsAre(HasSubstr("joint_looks_wrong a=gate b=post reason=\"it is there twice, "
                                      "of one kind at one place [0.2, 0, 1]: remove one")));
    EXPECT_THAT(doubts(two + joint("gate", "post", hinge) + joint("post", "gate", hinge)),
                ElementsAre(HasSubstr("it is there twice")));
    const std::string other_axis = "kind = \"hinge\"\nanchor_m = [0.2, 0, 1]\naxis = [0, 1, 0]\n";
    const std::string other_place =
        "kind = \"hinge\"\nanchor_m = [0.2, 0, 1.2]\naxis = [0, 0, 1]\n";
    EXPECT_THAT(doubts(two + joint("gate", "post", hinge) + joint("gate", "post", other_axis) +
                       joint("gate", "post", other_place) + joint("gate", "world", hinge)),
                IsEmpty());
    const auto spring = [](double to_m, const std::string& rest) {
        return "kind = \"spring\"\nstiffness_npm = 10\nanchor_m = [0.2, 0, 1]\nanchor_b_m = [" +
               std::to_string(to_m) + ", 0, 1]\n" + rest;
    };
    EXPECT_THAT(doubts(two + joint("gate", "post", spring(0.3, "")) +
                       joint("gate", "post", spring(0.3, ""))),
                ElementsAre(HasSubstr("it is there twice")));
    EXPECT_THAT(doubts(two + joint("gate", "post", spring(0.3, "")) +
                       joint("gate", "post", spring(0.4, "")) +
                       joint("gate", "post", spring(0.3, "pulls_only = true\n"))),
                IsEmpty());
}

TEST_F(WorldDoubts, NameAnAnchorInTheFrameOfItsObject) {
    const std::string hinge = box("crate", 1, "position_m = [3.55, 2, 0.2]") +
                              "[[joint]]\na = \"crate\"\nkind = \"hinge\"\naxis = [0, 0, 1]\n";
    EXPECT_THAT(
        doubts(hinge + "anchor_m = [0.2, 0, 0]\n"),
        ElementsAre(HasSubstr("joint_looks_wrong a=crate b=world reason=\"anchor_m [0.2, 0, "
                              "0] is 3.6 m away from crate; it is a place in the world")));
    EXPECT_THAT(doubts(hinge + "anchor_m = [3.75, 2, 0.2]\n"), IsEmpty());
    EXPECT_THAT(doubts(hinge + "anchor_m = [3.55, 2, 2.2]\n"), IsEmpty()) << "hangs from above";
    EXPECT_THAT(doubts(hinge + "anchor_m = [0, 0, 0.35]\n"),
                ElementsAre(HasSubstr("it is a place in the world")))
        << "a little above the crate in its frame";
    EXPECT_THAT(doubts(hinge + "anchor_m = [1, 0, 0]\n"), ElementsAre(HasSubstr("is 3 m away")))
        << "outside the crate in its frame, too";
    const std::string near_hinge = box("crate", 1, "position_m = [0.45, 0, 0.2]") +
                                   "[[joint]]\na = \"crate\"\nkind = \"hinge\"\naxis = [0, 0, 1]\n";
    EXPECT_THAT(doubts(near_hinge + "anchor_m = [0, 0, 0]\n"),
                ElementsAre(HasSubstr("it is a place in the world")))
        << "the world's origin near by";
    EXPECT_THAT(doubts(near_hinge + "anchor_m = [0.01, 0, 0]\n"), IsEmpty()) << "meant so";
}

TEST_F(WorldDoubts, NameAnAnchorNearTwoObjectsButInTheFrameOfOne) {
    // a gong of 0.8 m below a beam
    const std::string gong = box("gong", 5, "position_m = [0, 0, 0.8]") +
                             box("beam", 0, "position_m = [0, 0, 1.25]") +
                             "[[joint]]\na = \"gong\"\nb = \"beam\"\nkind = \"hinge\"\n"
                             "axis = [1, 0, 0]\nanchor_m = ";
    EXPECT_THAT(doubts(gong + "[0, 0, 1.02]\n"), IsEmpty());
    EXPECT_THAT(doubts(gong + "[0, 0, 0.22]\n"),
                ElementsAre(HasSubstr("anchor_m [0, 0, 0.22] is 0.38 m away from both objects; it "
                                      "is a place in the world, not in an object; meant in gong, "
                                      "it is [0, 0, 1.02]")));
    EXPECT_THAT(doubts(gong + "[0.35, 0, 0.2]\n"), IsEmpty()) << "at neither in any frame";
}

TEST_F(WorldDoubts, NameGravityThatDoesNotPointDown) {
    EXPECT_THAT(doubts("[world]\ngravity = [0, -9.81, 0]\n"),
                ElementsAre(HasSubstr("world_looks_wrong reason=\"gravity [0, -9.81, 0] does not "
                                      "point down; +Z is up: [0, 0, -9.81]\"")));
    EXPECT_THAT(doubts("[world]\ngravity = [0, 0, 9.81]\n"), ElementsAre(HasSubstr("not point")));
    EXPECT_THAT(doubts("[world]\ngravity = [0, 0, 0]\n"), IsEmpty());
    EXPECT_THAT(doubts("[world]\ngravity = [1, 0, -1.62]\n"), IsEmpty());
}

TEST_F(WorldDoubts, NameRotationsInRadians) {
    const auto turned = [](const std::string& angles) {
        return box("b", 1, "roll_pitch_yaw_deg = [" + angles + "]");
    };
    for (const char* radians :
         {"1.57, 0, 0", "0, 0, -3.14159", "0.52, 0, 1.571", "0, 0.785, 0", "1.570796, 0, 0"}) {
        EXPECT_THAT(doubts(turned(radians)),
                    ElementsAre(HasSubstr("object_looks_wrong name=b reason=\"roll_pitch_yaw_deg")))
            << radians;
    }
    EXPECT_THAT(doubts(turned("1.57, 0, 0")), ElementsAre(HasSubstr("degrees are [90, 0, 0]")));
    for (const char* degrees : {"0, 0, 0",
                                "1, 0, 0",
                                "0, 2, 0",
                                "0.5, 0, 5",
                                "2.1, 0, 0",
                                "5.5, 0, 0",
                                "0, 5.75, 0",
                                "1.57, 0, 30",
                                "90, 0, 0",
                                "0, 0, 0.01",
                                "0, 0, 1.563218",  // as a saved world may have it
                                "1.25, 1.5, 0"})
        EXPECT_THAT(doubts(turned(degrees)), IsEmpty()) << degrees;
    const std::string puppet =
        "[[puppet]]\nname = \"pierrot\"\nposition_m = [0, 0, 1]\nroll_pitch_yaw_deg = ";
    EXPECT_THAT(doubts(puppet + "[0, 0, -1.571]\n"),
                ElementsAre(HasSubstr("object_looks_wrong name=pierrot reason=\"roll_pitch_yaw_deg "
                                      "= [0, 0, -1.571] turns it by hardly anything")))
        << "one line for all parts";
    EXPECT_THAT(doubts(puppet + "[0, 0, 90]\n"), IsEmpty());
    EXPECT_THAT(doubts("[[site]]\nname = \"alice\"\nposition_m = [0, 0, 0]\nyaw_deg = 3.14\n"),
                ElementsAre(AllOf(HasSubstr("site_looks_wrong name=alice reason=\"yaw_deg = 3.14"),
                                  HasSubstr("the degrees are 180\""))));
}

TEST_F(WorldDoubts, NameLimitsOfAHingeInRadians) {
    const std::string hinge = box("gate", 1, "") +
                              "[[joint]]\na = \"gate\"\nkind = \"hinge\"\naxis = [0, 0, 1]\n"
                              "anchor_m = [0, 0, 0]\n";
    EXPECT_THAT(
        doubts(hinge + "limits_deg = [-1.57, 1.57]\n"),
        ElementsAre(HasSubstr("joint_looks_wrong a=gate b=world reason=\"limits_deg [-1.57, "
                              "1.57] is hardly any motion in degrees; as radians it would "
                              "be -90 to 90 degrees")));
    EXPECT_THAT(doubts(hinge + "limits_deg = [0, 3.2]\n"), ElementsAre(HasSubstr("0 to 183")));
    EXPECT_THAT(doubts(hinge + "limits_deg = [0, 0]\n"), IsEmpty()) << "held on purpose";
    EXPECT_THAT(doubts(hinge + "limits_deg = [-1, 5]\n"), IsEmpty());
}

TEST_F(WorldDoubts, NameLimitsOfABallJointInRadians) {
    const std::string ball =
        box("lamp", 1, "") + "[[joint]]\na = \"lamp\"\nkind = \"ball\"\nanchor_m = [0, 0, 0]\n";
    EXPECT_THAT(doubts(ball + "swing_deg = 1.2\n"),
                ElementsAre(HasSubstr("joint_looks_wrong a=lamp b=world reason=\"swing_deg 1.2 is "
                                      "hardly any motion in degrees; as radians it would be 69 "
                                      "degrees")));
    EXPECT_THAT(doubts(ball + "twist_deg = 1.57\n"), ElementsAre(HasSubstr("twist_deg 1.57")));
    EXPECT_THAT(doubts(ball + "swing_deg = 20\ntwist_deg = 0\n"), IsEmpty());
}

TEST_F(WorldDoubts, SizesOfScenery) {
    const auto rock = [](const std::string& rest) {
        return std::string(
                   "[[scenery]]\nname = \"rock\"\nmodel = \"rock.obj\"\n"
                   "texture = \"own.png\"\n") +
               rest;
    };
    // 0.9 units; the world is 40 m wide
    EXPECT_THAT(doubts(kFloor + rock("solid = true\n")), testing::IsEmpty());
    EXPECT_THAT(
        doubts(kFloor + rock("solid = true\nscale = 100\n")),
        testing::ElementsAre(testing::HasSubstr("it is 90 x 90 x 90 m large, more than twice")));
    EXPECT_THAT(doubts(kFloor + rock("solid = true\nscale = 0.05\n")),
                testing::ElementsAre(testing::HasSubstr(
                    "it is 0.045 x 0.045 x 0.045 m large: check its scale; 1 reads metres\"")));
    EXPECT_THAT(doubts(kFloor + rock("solid = true\nscale = 0.06\n")), testing::IsEmpty());
    EXPECT_THAT(doubts(kFloor + rock("scale = 100\n")), testing::IsEmpty()) << "a landscape";
    EXPECT_THAT(doubts(kFloor + rock("scale = 1000\n")),
                testing::ElementsAre(testing::HasSubstr("it is 900 x 900 x 900 m large, more")));
}

TEST_F(WorldDoubts, PlacesOfScenery) {
    const auto rock = [](const std::string& rest) {
        return "[[scenery]]\nname = \"rock\"\nmodel = \"rock.obj\"\ntexture = \"own.png\"\n" +
               rest + "\n";
    };
    const auto outside = testing::HasSubstr(
        "scenery_looks_wrong name=rock reason=\"all of it is 280 m or more outside the world's "
        "bounds, [-20, -20, -1] to [20, 20, 20]");
    EXPECT_THAT(doubts(kFloor + rock("position_m = [300, 0, 0]")), ElementsAre(outside));
    EXPECT_THAT(doubts(kFloor + rock("position_m = [300, 0, 0]\nsolid = true")),
                ElementsAre(outside));
    EXPECT_THAT(doubts(kFloor + rock("position_m = [80, 0, 0]")), IsEmpty()) << "a backdrop";
    EXPECT_THAT(doubts(kFloor + rock("position_m = [80, 0, 0]\nsolid = true")),
                ElementsAre(HasSubstr("60 m or more outside")));
    EXPECT_THAT(doubts(kFloor + rock("position_m = [0, 0, -3]")),
                ElementsAre(HasSubstr("scenery_looks_wrong name=rock reason=\"all of it is below "
                                      "floor, where nobody sees it")));
    EXPECT_THAT(doubts(kFloor + rock("position_m = [0, 0, -0.5]")), IsEmpty()) << "it looks out";
    EXPECT_THAT(doubts(kFloor + rock("position_m = [4.5, 0, -3]")), IsEmpty())
        << "beside what is drawn of the floor";
    const std::string hall = box("hall", 0, "position_m = [0, 0, 1]");
    EXPECT_THAT(doubts(hall + rock("position_m = [-0.1, -0.1, 0.9]\nscale = 0.2")),
                ElementsAre(HasSubstr("all of it is inside hall")));
    EXPECT_THAT(doubts(hall + rock("position_m = [-0.1, -0.1, 0.9]")), IsEmpty());
}

TEST_F(WorldDoubts, SceneryThatLiesOnItsSide) {
    // 4 m high along +Y, 2 m wide and deep about its trunk
    put("palm.obj",
        "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv 0 4 0\n"
        "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
    const auto palm = [](const std::string& rest) {
        return "[[scenery]]\nname = \"palm\"\nmodel = \"palm.obj\"\n" + rest + "\n";
    };
    const auto lies = ElementsAre(HasSubstr(
        "scenery_looks_wrong name=palm reason=\"half of it is below floor, as if it lay on "
        "its side: if its file has +Y up, write roll_pitch_yaw_deg = [90, 0, 0]\""));
    EXPECT_THAT(doubts(kFloor + palm("position_m = [1, 2, 0]")), lies);
    EXPECT_THAT(doubts(kFloor + palm("roll_pitch_yaw_deg = [90, 0, 0]")), IsEmpty());
    EXPECT_THAT(doubts(kFloor + palm("position_m = [0, 0, 1]")), IsEmpty()) << "lies on the floor";
    EXPECT_THAT(doubts(palm("")), IsEmpty()) << "no floor";
}

}  // namespace
}  // namespace atrium::world_server
