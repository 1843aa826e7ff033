#include "viewer/overlay/proxy_view.hpp"

#include "core/bus/proxy_points.hpp"
#include "viewer/overlay/shape_wires.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;
using renderer::Line;

const Eigen::Vector3f kProxyColour(1, 0, 0);
const ProxyView::Clock::time_point kNow{};

bus::SceneObject object_of(bus::Shape shape, const Eigen::Vector3d& size_m) {
    bus::SceneObject object;
    object.shape = shape;
    object.size_m = size_m;
    return object;
}

// All line ends, in the object's frame.
std::vector<Eigen::Vector3d> ends_of(const bus::SceneObject& object) {
    Eigen::Isometry3d world_from_object = Eigen::Isometry3d::Identity();
    world_from_object.translate(Eigen::Vector3d(1, 2, 3));
    world_from_object.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 1, 0).normalized()));
    std::vector<Line> lines;
    append_shape(object, world_from_object.matrix(), kProxyColour, lines);
    std::vector<Eigen::Vector3d> ends;
    for (const Line& line : lines) {
        for (const Line::End& end : {line.from, line.to})
            ends.push_back(world_from_object.inverse() * end.at_world.cast<double>());
    }
    return ends;
}

TEST(ShapeWires, DrawASphereAsThreeCircles) {
    const auto ends = ends_of(object_of(bus::Shape::kSphere, {0.4, 0.4, 0.4}));
    EXPECT_EQ(ends.size(), 2U * 3U * 32U);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : ends) {
        EXPECT_NEAR(p.norm(), 0.2, 1e-5);
        EXPECT_LT(p.cwiseAbs().minCoeff(), 1e-5) << "a circle must lie in a plane of two axes";
        box.extend(p);
    }
    EXPECT_LT((box.sizes() - Eigen::Vector3d::Constant(0.4)).norm(), 1e-5);
}

TEST(ShapeWires, DrawTheRimsOfACylinder) {
    const auto ends = ends_of(object_of(bus::Shape::kCylinder, {0.2, 0.2, 0.6}));
    ASSERT_FALSE(ends.empty());
    for (const Eigen::Vector3d& p : ends) {
        EXPECT_NEAR(p.head<2>().norm(), 0.1, 1e-5);
        EXPECT_NEAR(std::abs(p.z()), 0.3, 1e-5);
    }
}

TEST(ShapeWires, DrawRoundCapsuleEndsWithinTheHeight) {
    const auto ends = ends_of(object_of(bus::Shape::kCapsule, {0.2, 0.2, 0.6}));
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : ends) {
        const Eigen::Vector3d on_axis(0, 0, std::clamp(p.z(), -0.2, 0.2));
        EXPECT_NEAR((p - on_axis).norm(), 0.1, 1e-5);
        box.extend(p);
    }
    EXPECT_LT((box.sizes() - Eigen::Vector3d(0.2, 0.2, 0.6)).norm(), 1e-5);
}

TEST(ShapeWires, DrawAPlanesOutlineAndNormal) {
    const auto ends = ends_of(object_of(bus::Shape::kPlane, {4, 2, 1}));
    double highest_m = 0.0;
    for (const Eigen::Vector3d& p : ends) {
        highest_m = std::max(highest_m, p.z());
        if (p.norm() < 1e-5 || p.z() > 0.1) continue;
        EXPECT_LT((p.cwiseAbs() - Eigen::Vector3d(2, 1, 0)).norm(), 1e-5);
    }
    EXPECT_NEAR(highest_m, 0.3, 1e-5);
}

TEST(ShapeWires, AreEmptyForSoftObjects) {
    EXPECT_TRUE(ends_of(object_of(bus::Shape::kSoft, {1, 1, 1})).empty());
}

// Two points, one at rest and one that moves.
bus::PersonProxy person() {
    const std::vector<Eigen::Vector3f> places{{0, 0, 1}, {0.3F, 0, 1}};
    const bus::Lattice lattice = bus::lattice_around(places);
    bus::PersonProxy proxy;
    proxy.site = "alice";
    proxy.origin_m = lattice.origin_m;
    proxy.step_m = lattice.step_m;
    proxy.points = {bus::make_proxy_point(lattice, places[0], {0, 0, 0}, {0, 0, 1}),
                    bus::make_proxy_point(lattice, places[1], {0, 2, 0}, {1, 0, 0})};
    return proxy;
}

bool is_line(const Line& line, const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    return (line.from.at_world - from).norm() < 1e-4F && (line.to.at_world - to).norm() < 1e-4F;
}

TEST(ProxyView, DrawsEachSurfelAndItsMotionOverATenthOfASecond) {
    ProxyView view;
    ProxyChanges changes;
    changes.people["alice"] = person();
    view.update(std::move(changes), kNow);
    std::vector<Line> lines;
    view.append_people(lines);
    ASSERT_EQ(lines.size(), 3U);
    EXPECT_TRUE(is_line(lines[0], {0, 0, 1}, {0, 0, 1.015F}))
        << "the line must point out of the surface";
    EXPECT_TRUE(is_line(lines[1], {0.3F, 0, 1}, {0.315F, 0, 1}));
    EXPECT_TRUE(is_line(lines[2], {0.3F, 0, 1}, {0.3F, 0.2F, 1})) << "2 m/s";
    EXPECT_EQ(lines[0].from.colour, colour_of_speed(0.0));
    EXPECT_EQ(lines[2].from.colour, colour_of_speed(2.0));
}

TEST(ProxyView, MarksTouches) {
    bus::PersonProxy proxy = person();
    proxy.touches = {{3, {1, 2, 3}}};
    ProxyView view;
    ProxyChanges changes;
    changes.people["alice"] = proxy;
    view.update(std::move(changes), kNow);
    std::vector<Line> lines;
    view.append_people(lines);
    ASSERT_EQ(lines.size(), 6U);
    for (std::size_t i = 3; i < 6; ++i) {
        const Eigen::Vector3f middle = 0.5F * (lines[i].from.at_world + lines[i].to.at_world);
        EXPECT_LT((middle - Eigen::Vector3f(1, 2, 3)).norm(), 1e-5F);
        EXPECT_NE(lines[i].from.colour, colour_of_speed(0.0))
            << "touches must have their own colour";
    }
}

TEST(ProxyView, ForgetsLostAndSilentPeople) {
    const auto num_lines = [](const ProxyView& view) {
        std::vector<Line> lines;
        view.append_people(lines);
        return lines.size();
    };
    ProxyView view;
    ProxyChanges changes;
    changes.people["alice"] = person();
    view.update(changes, kNow);
    view.update({}, kNow + 900ms);
    EXPECT_EQ(num_lines(view), 3U);
    view.update({}, kNow + 1100ms);
    EXPECT_EQ(num_lines(view), 0U);
    view.update(changes, kNow + 2s);
    EXPECT_EQ(num_lines(view), 3U);
    changes.people["alice"].reset();
    view.update(changes, kNow + 2s);
    EXPECT_EQ(num_lines(view), 0U);
}

TEST(ProxyView, BoundsTheNumberOfLines) {
    bus::PersonProxy proxy = person();
    proxy.points.resize(2048);
    ProxyView view;
    ProxyChanges changes;
    for (int i = 0; i < 100; ++i) {
        proxy.site = "s" + std::to_string(i);
        changes.people[proxy.site] = proxy;
    }
    view.update(std::move(changes), kNow);
    std::vector<Line> lines;
    view.append_people(lines);
    EXPECT_GT(lines.size(), 10'000U);
    EXPECT_LE(lines.size(), 65'536U);
}

TEST(ProxyView, DrawsThePartsOfAModelInTheObjectsFrame) {
    bus::ObjectProxy proxy;
    proxy.object = 5;
    proxy.origin_m = {-0.1, 0, 0};
    proxy.step_m = 0.001;
    proxy.vertices = {{0, 0, 0}, {200, 0, 0}, {0, 300, 0}};
    proxy.edges = {{0, 1}, {2, 0}};
    ProxyView view;
    ProxyChanges changes;
    changes.objects[5] = proxy;
    view.update(std::move(changes), kNow);
    Eigen::Isometry3d world_from_object = Eigen::Isometry3d::Identity();
    world_from_object.translate(Eigen::Vector3d(0, 0, 2));
    world_from_object.rotate(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitZ()));
    std::vector<Line> lines;
    EXPECT_FALSE(view.append_edges(6, world_from_object.matrix(), kProxyColour, lines));
    EXPECT_TRUE(lines.empty());
    EXPECT_TRUE(view.append_edges(5, world_from_object.matrix(), kProxyColour, lines));
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_TRUE(is_line(lines[0], {0, -0.1F, 2}, {0, 0.1F, 2}));
    EXPECT_TRUE(is_line(lines[1], {-0.3F, -0.1F, 2}, {0, -0.1F, 2}));
    EXPECT_EQ(lines[0].from.colour, kProxyColour);
}

TEST(ColourOfSpeed, RunsFromBlueOverGreenAndYellowToRed) {
    const Eigen::Vector3f rest = colour_of_speed(0.0);
    EXPECT_GT(rest.z(), std::max(rest.x(), rest.y()));
    const Eigen::Vector3f slow = colour_of_speed(0.5);
    EXPECT_GT(slow.y(), 2.0F * std::max(slow.x(), slow.z()));
    const Eigen::Vector3f quick = colour_of_speed(1.5);
    EXPECT_GT(std::min(quick.x(), quick.y()), 4.0F * quick.z());
    EXPECT_GT(colour_of_speed(3.0).x(), 4.0F * colour_of_speed(3.0).y());
    EXPECT_TRUE(colour_of_speed(30.0).isApprox(colour_of_speed(3.0)));
}

}  // namespace
}  // namespace atrium::viewer
