#include "tests/unit/physics/things.hpp"
#include "world_server/physics/rigid/collision_shape.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <random>

namespace atrium::physics {
namespace {

using Parts = std::vector<geometry::TriangleMesh>;

RigidObject of_parts(std::uint32_t id, Parts parts, double density, const Eigen::Vector3d& at) {
    RigidObject object{.id = id};
    object.shape = parts.size() == 1 ? ObjectShape::kConvex : ObjectShape::kCompound;
    object.size_m = extents_of(parts);
    object.parts = std::make_shared<const Parts>(std::move(parts));
    object.mass_kg = density * volume_m3(object);
    object.world_from_object.translation = at;
    return object;
}

geometry::TriangleMesh box_hull(const Eigen::Vector3d& centre, const Eigen::Vector3d& size_m) {
    return convex_hull(corners_of_box(centre, size_m), kMaxHullVertices);
}

// A stool: a seat on four legs. Its origin is on the floor between the legs.
Parts stool() {
    Parts parts{box_hull({0, 0, 0.42}, {0.4, 0.4, 0.04})};
    for (const double x : {-0.17, 0.17}) {
        for (const double y : {-0.17, 0.17})
            parts.push_back(box_hull({x, y, 0.2}, {0.05, 0.05, 0.4}));
    }
    return parts;
}

TEST(ConvexHull, IsClosedAndOutwardWithoutInnerPoints) {
    std::vector<Eigen::Vector3d> points = corners_of_box({1, 2, 3}, {0.2, 0.3, 0.4});
    points.emplace_back(1.0, 2.0, 3.0);
    points.emplace_back(1.05, 2.1, 3.1);
    const geometry::TriangleMesh hull = convex_hull(points, kMaxHullVertices);
    const geometry::MeshReport report = geometry::inspect(hull);
    EXPECT_EQ(hull.vertices.size(), 8U);
    EXPECT_TRUE(report.closed && report.manifold);
    EXPECT_NEAR(report.volume_m3, 0.2 * 0.3 * 0.4, 1e-12);
}

TEST(ConvexHull, OfAFineSphereHasFewVerticesAndNearlyItsVolume) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 5000; ++i)
        points.push_back(
            0.1 * Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
    const geometry::TriangleMesh hull = convex_hull(points, kMaxHullVertices);
    EXPECT_LE(hull.vertices.size(), kMaxHullVertices);
    EXPECT_TRUE(geometry::inspect(hull).manifold);
    EXPECT_GT(geometry::volume_m3(hull), 0.88 * 4.0 / 3.0 * EIGEN_PI * 1e-3);
}

TEST(ConvexHull, KeepsItsExtentsWithFewVertices) {
    for (unsigned seed = 1; seed <= 30; ++seed) {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        std::vector<Eigen::Vector3d> points;
        geometry::Aabb box;
        for (int i = 0; i < 2000; ++i) {
            const Eigen::Vector3d direction =
                Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
            points.emplace_back(direction.cwiseProduct(Eigen::Vector3d(0.1, 0.2, 0.3)));
            box.add(points.back());
        }
        const geometry::TriangleMesh hull = convex_hull(points, kMaxHullVertices);
        ASSERT_LE(hull.vertices.size(), kMaxHullVertices);
        EXPECT_EQ(geometry::bounds(hull).min, box.min) << "seed " << seed;
        EXPECT_EQ(geometry::bounds(hull).max, box.max) << "seed " << seed;
    }
}

TEST(ConvexHull, OfFlatPointsIsEmpty) {
    EXPECT_TRUE(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, 64).empty());
    EXPECT_TRUE(convex_hull({{0, 0, 0}, {1, 0, 0}}, 64).empty());
    EXPECT_TRUE(convex_hull({}, 64).empty());
}

TEST(MassProperties, OfARotatedBoxAreRotated) {
    const Eigen::Vector3d size(0.2, 0.3, 0.5);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    const Eigen::Vector3d centre(0.4, -0.2, 0.1);
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& p : corners_of_box(Eigen::Vector3d::Zero(), size))
        points.push_back(centre + turn * p);
    const MassProperties mass = mass_properties({convex_hull(points, 64)});
    EXPECT_NEAR(mass.volume_m3, size.prod(), 1e-12);
    EXPECT_LT((mass.centre - centre).norm(), 1e-12);
    const Eigen::Vector3d squares = size.cwiseAbs2();
    const Eigen::Vector3d moments =
        size.prod() / 12.0 *
        Eigen::Vector3d(
            squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y());
    const Eigen::Matrix3d expected =
        turn.toRotationMatrix() * moments.asDiagonal() * turn.toRotationMatrix().transpose();
    EXPECT_LT((mass.inertia - expected).norm(), 1e-12);
}

TEST(CollisionShape, OfAConvexBoxHasTheMassPropertiesOfABox) {
    const Eigen::Vector3d size(0.2, 0.3, 0.5);
    RigidObject box = box_at(2, {0, 0, 0}, size);
    const RigidObject convex = of_parts(3, {box_hull({0.1, 0.2, 0.3}, size)}, 500.0, {0, 0, 0});
    EXPECT_NEAR(convex.mass_kg, box.mass_kg, 1e-9);
    const CollisionShape of_box(box);
    const CollisionShape of_convex(convex);
    EXPECT_LT((of_convex.inertia() - of_box.inertia()).norm(), 1e-5 * of_box.inertia().norm());
    EXPECT_LT((of_convex.object_from_body().translation - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(),
              1e-9);
    EXPECT_EQ(of_convex.inner_radius_m(), of_box.inner_radius_m());
}

TEST(Shapes, ComeToRestOnTheFloor) {
    World world({});
    ASSERT_EQ(world.add(floor_plane()), AddResult::kAdded);
    const RigidObject convex =
        of_parts(2, {box_hull({0, 0, 0}, {0.2, 0.3, 0.1})}, 500, {0, 0, 0.5});
    const RigidObject compound = of_parts(3, stool(), 600, {1, 0, 0.3});
    RigidObject on_its_back = of_parts(4, stool(), 600, {2, 0, 1.0});
    on_its_back.world_from_object.rotation = Eigen::AngleAxisd(EIGEN_PI, Eigen::Vector3d::UnitX());
    for (const RigidObject& object : {convex, compound, on_its_back})
        ASSERT_EQ(world.add(object), AddResult::kAdded);
    run(world, 4.0);
    const double heights_m[] = {0.05, 0.0, 0.44};
    for (std::uint32_t id = 2; id <= 4; ++id) {
        const RigidState state = state_of(world, id);
        EXPECT_NEAR(state.world_from_object.translation.z(), heights_m[id - 2], 0.006) << id;
        EXPECT_LT(state.linear_velocity.norm(), 0.02) << id;
        EXPECT_LT(state.angular_velocity.norm(), 0.05) << id;
    }
}

TEST(Shapes, CompoundFallsAsOneAndReportsItsFrame) {
    World world({});
    const RigidObject object = of_parts(2, stool(), 600, {0, 0, 10});
    ASSERT_EQ(world.add(object), AddResult::kAdded);
    const RigidState before = state_of(world, 2);
    EXPECT_LT((before.world_from_object.translation - Eigen::Vector3d(0, 0, 10)).norm(), 1e-5)
        << "the state must be that of the model's frame, not of the centre of mass";
    run(world, 1.0);
    const RigidState after = state_of(world, 2);
    EXPECT_NEAR(after.world_from_object.translation.z(), 10.0 - 4.905, 0.1);
    EXPECT_LT(after.angular_velocity.norm(), 1e-3);
    EXPECT_NEAR(after.linear_velocity.z(), -9.81, 0.2);
}

TEST(Shapes, OffCentrePushTurnsAConvexAboutItsCentreOfMass) {
    World world({.gravity = Eigen::Vector3d::Zero()});
    // the frame is at one end of a rod
    const RigidObject rod = of_parts(2, {box_hull({0.5, 0, 0}, {1.0, 0.1, 0.1})}, 500, {0, 0, 0});
    ASSERT_EQ(world.add(rod), AddResult::kAdded);
    ASSERT_TRUE(world.push(2, {0, rod.mass_kg, 0}));
    run(world, 0.5);
    const RigidState state = state_of(world, 2);
    EXPECT_LT(state.angular_velocity.norm(), 1e-4) << "a push at the centre must not turn it";
    EXPECT_NEAR(state.world_from_object.translation.y(), 0.5, 0.02);
}

TEST(Shapes, RefuseBadParts) {
    World world({});
    RigidObject object = of_parts(2, stool(), 600, {0, 0, 1});
    object.shape = ObjectShape::kConvex;
    EXPECT_EQ(find_problem(object)->field, "model") << "five parts";
    object.shape = ObjectShape::kCompound;
    EXPECT_FALSE(find_problem(object));
    object.size_m *= 2.0;
    EXPECT_EQ(find_problem(object)->field, "size_m");
    object.parts = nullptr;
    EXPECT_EQ(find_problem(object)->field, "model");
    EXPECT_EQ(world.add(object), AddResult::kInvalid);
}

TEST(Shapes, RestOnSolidScenery) {
    World world({});
    StaticMesh table{.mesh = box_hull({0, 0, 0.5}, {2, 2, 1}), .friction = 0.6, .restitution = 0.1};
    ASSERT_TRUE(world.add_static(table));
    ASSERT_EQ(world.add(box_at(2, {0.1, 0.2, 1.3})), AddResult::kAdded);
    run(world, 3.0);
    EXPECT_NEAR(state_of(world, 2).world_from_object.translation.z(), 1.1, 0.008);
    EXPECT_EQ(world.num_objects(), 1U) << "scenery must not count as an object";
    EXPECT_FALSE(world.add_static({})) << "without triangles";
    table.mesh.triangles[0][1] = 1000;
    EXPECT_FALSE(world.add_static(table)) << "an index beyond the vertices";
}

}  // namespace
}  // namespace atrium::physics
