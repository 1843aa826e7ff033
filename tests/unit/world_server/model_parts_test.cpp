// The hulls of models of objects.
#include "world_server/description/model_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace atrium::world_server {
namespace {

using physics::ObjectShape;

// Two tetrahedra, 1 m apart along x, as STL: each corner of each triangle is a vertex of its own.
std::string two_tetrahedra() {
    const Eigen::Vector3d corners[] = {{0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0}, {0, 0, 0.2}};
    const int faces[][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    std::ostringstream text;
    text << "solid pair\n";
    for (const double x_m : {0.0, 1.0}) {
        for (const auto& face : faces) {
            text << "facet normal 0 0 0\nouter loop\n";
            for (const int corner : face) {
                const Eigen::Vector3d at = corners[corner] + x_m * Eigen::Vector3d::UnitX();
                text << "vertex " << at.x() << " " << at.y() << " " << at.z() << "\n";
            }
            text << "endloop\nendfacet\n";
        }
    }
    text << "endsolid pair\n";
    return text.str();
}

class ModelPartsTest : public testing::Test {
protected:
    ModelPartsTest()
        : file_(std::filesystem::temp_directory_path() /
                ("atrium-parts-" + std::to_string(getpid()) + ".stl")) {}
    ~ModelPartsTest() override { std::filesystem::remove(file_); }

    std::filesystem::path file_;
};

// STL has no parts: what is not connected is a part, or a tray of five boards would be solid.
TEST_F(ModelPartsTest, CompoundOfAnStlHasAHullForEachConnectedSurface) {
    std::ofstream(file_) << two_tetrahedra();
    const auto compound = load_model_parts(file_, 1.0, ObjectShape::kCompound);
    ASSERT_TRUE(compound) << compound.error().message;
    ASSERT_EQ(compound->parts->size(), 2U);
    for (const geometry::TriangleMesh& hull : *compound->parts) {
        EXPECT_EQ(hull.vertices.size(), 4U);
        EXPECT_NEAR(geometry::bounds(hull).size().x(), 0.2, 1e-6);
    }
    EXPECT_NEAR(geometry::bounds(compound->parts->at(1)).min.x(), 1.0, 1e-6);
    const auto convex = load_model_parts(file_, 1.0, ObjectShape::kConvex);
    ASSERT_TRUE(convex) << convex.error().message;
    ASSERT_EQ(convex->parts->size(), 1U);
    EXPECT_NEAR(geometry::bounds(convex->parts->front()).size().x(), 1.2, 1e-6);
}

TEST_F(ModelPartsTest, TooManyConnectedSurfacesAreAnError) {
    std::ofstream file(file_);
    file << "solid dust\n";
    for (int i = 0; i < 65; ++i) {
        for (int k = 0; k < 3; ++k) {
            file << "facet normal 0 0 0\nouter loop\nvertex " << i << " 0 0\nvertex " << i
                 << ".5 0 " << k << "\nvertex " << i << " 0.5 0\nendloop\nendfacet\n";
        }
    }
    file << "endsolid dust\n";
    file.close();
    const auto compound = load_model_parts(file_, 0.1, ObjectShape::kCompound);
    ASSERT_FALSE(compound);
    EXPECT_THAT(compound.error().message,
                testing::HasSubstr("has 65 parts, a compound at most 64; shape = \"convex\""));
}

}  // namespace
}  // namespace atrium::world_server
