#include "viewer/renderer/person/person_model.hpp"

#include "tests/support/sanitized.hpp"
#include "tests/unit/renderer/synthetic_person.hpp"
#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/outline_strip.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::renderer {
namespace {

using synthetic::Sphere;

const Eigen::Vector3d kGreen(0.2, 0.7, 0.3);

PersonModel build(const geometry::TriangleMesh& mesh, const std::vector<CameraPicture>& pictures) {
    PersonModelScratch scratch;
    PersonModel model;
    build_person_model(mesh, pictures, {}, scratch, model);
    return model;
}

PersonModel build(const std::vector<Sphere>& spheres,
                  const std::vector<geometry::CalibratedCamera>& cameras) {
    std::vector<CameraPicture> pictures;
    for (const auto& camera : cameras)
        pictures.push_back(
            synthetic::picture_of(spheres, camera, [](const auto&) { return kGreen; }));
    return build(synthetic::mesh_of(spheres, 24), pictures);
}

TEST(PersonModel, CameraSeesOnlyFacesTowardsIt) {
    const Sphere sphere{{0.0, 0.0, 1.0}, 0.5};
    const auto camera = synthetic::camera_at({3.0, 0.0, 1.0}, sphere.centre);
    const PersonModel model = build({sphere}, {camera});
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
        const Eigen::Vector3d p = model.vertices_site[v].cast<double>();
        const double cos_angle =
            (p - sphere.centre).normalized().dot((camera.centre_site() - p).normalized());
        if (cos_angle > 0.6) {
            EXPECT_GT(model.cameras[0].quality[v], 0.99f) << p.transpose();
        } else if (cos_angle < -0.12) {
            // the faces around a vertex are tilted by up to 6 degrees
            EXPECT_EQ(model.cameras[0].quality[v], 0.0f) << p.transpose();
        }
    }
}

// Lenses, places and sizes anywhere within the limits of the bus.
class AbsurdPeople {
public:
    explicit AbsurdPeople(unsigned seed) : random_(seed) {}

    PersonModel model() {
        auto mesh = synthetic::mesh_of({kSphere}, 6);
        const double scale = chance() ? power_of_ten(-9.0, 5.0) : 1.0;
        const Eigen::Vector3d shift = chance() ? vector(9e4) : Eigen::Vector3d(0.0, 0.0, 0.0);
        const bool is_flat = chance();
        for (Eigen::Vector3d& p : mesh.vertices) {
            p = (scale * p + shift).cwiseMax(-1e5).cwiseMin(1e5);
            if (is_flat) p.z() = 0.0;
        }
        auto cameras = synthetic::ring(6, kSphere.centre);
        std::vector<CameraPicture> pictures;
        for (auto& camera : cameras) {
            pictures.push_back(
                synthetic::picture_of({kSphere}, camera, [](const auto&) { return kGreen; }));
            spoil(camera);
            pictures.back().camera = camera;
            if (chance()) pictures.back().crop_px.x = -(1 << 20);
            if (chance()) pictures.back().crop_px.width = 1;
        }
        return build(mesh, pictures);
    }
    Eigen::Vector3f eye() { return (chance() ? vector(1e5) : vector(3.0)).cast<float>(); }

private:
    bool chance() { return random_() % 3 == 0; }
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    double power_of_ten(double low, double high) { return std::pow(10.0, between(low, high)); }
    Eigen::Vector3d vector(double reach) {
        return {between(-reach, reach), between(-reach, reach), between(-reach, reach)};
    }
    void spoil(geometry::CalibratedCamera& camera) {
        auto& lens = camera.intrinsics;
        if (chance()) lens.fx = power_of_ten(-300.0, 7.0);
        if (chance()) lens.fy = power_of_ten(-300.0, 7.0);
        if (chance()) lens.cx = between(-1e7, 1e7);
        if (chance()) lens.skew = between(-1e7, 1e7);
        if (chance())
            for (double& k : lens.distortion) k = between(-1.0, 1.0) * power_of_ten(-3.0, 7.0);
        if (chance()) camera.camera_from_site.translation = vector(chance() ? 1e5 : 0.5);
    }

    static inline const Sphere kSphere{{0.0, 0.0, 1.0}, 0.5};
    std::mt19937 random_;
};

TEST(PersonModel, StaysFiniteForAbsurdCamerasAndMeshes) {
    for (unsigned seed = 0; seed < (test::kSanitized ? 60 : 400); ++seed) {
        AbsurdPeople people(seed);
        const PersonModel model = people.model();
        for (const auto& camera : model.cameras) {
            for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
                ASSERT_TRUE(camera.layer_coordinates[v].allFinite()) << seed;
                ASSERT_TRUE(camera.quality[v] >= 0.0f && camera.quality[v] <= 1.0f) << seed;
            }
        }
        for (const auto& colour : model.fallback) ASSERT_TRUE(colour.allFinite()) << seed;
        BlendScratch scratch;
        BlendedMesh blended;
        const Eigen::Vector3f eye = people.eye();
        blend_for_view(model, eye, scratch, blended);
        for (const VertexBlend& blend : scratch.vertices)
            for (const float weight : blend.weights)
                ASSERT_TRUE(weight >= 0.0f && weight <= 1.0f) << seed << " " << weight;
        OutlineStrip strip;
        strip.find(model, eye, scratch);
        for (const float value : strip.vertices()) ASSERT_TRUE(std::isfinite(value)) << seed;
    }
}

TEST(PersonModel, EdgeOnFaceTakesNothingFromThatCamera) {
    const Sphere sphere{{0.0, 0.0, 1.0}, 0.5};
    const auto cameras = synthetic::ring(8, sphere.centre);
    const PersonModel model = build({sphere}, cameras);
    const auto cos_of = [&](std::size_t t, std::size_t c) {
        const auto& [i, j, k] = model.triangles[t];
        const Eigen::Vector3f& p = model.vertices_site[i];
        const Eigen::Vector3f normal =
            (model.vertices_site[j] - p).cross(model.vertices_site[k] - p).normalized();
        return normal.dot((model.cameras[c].centre_site - p).normalized());
    };
    std::size_t num_edge_on = 0;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
        for (std::size_t t = 0; t < model.triangles.size(); ++t) {
            if (cos_of(t, c) < 0.02f) {
                EXPECT_EQ(model.cameras[c].facing[t], 0.0f);
                num_edge_on += cos_of(t, c) > -0.02f ? 1 : 0;
            }
            if (cos_of(t, c) > 0.21f) {
                EXPECT_EQ(model.cameras[c].facing[t], 1.0f);
            }
        }
    }
    EXPECT_GT(num_edge_on, 100u);

    // and the drawn triangles have no weight of that camera
    BlendScratch scratch;
    BlendedMesh blended;
    blend_for_view(model, Eigen::Vector3f(1.5f, 1.5f, 1.2f), scratch, blended);
    for (std::size_t g = 0; g < blended.groups.size(); ++g) {
        const std::size_t n = kCamerasPerTriangle[g];
        const std::size_t stride = floats_per_vertex(n);
        std::vector<float> vertices(blended.groups[g].num_vertices() * stride);
        lay_out(model, blended, g, vertices);
        for (std::size_t v = 0; v + 2 < blended.groups[g].num_vertices(); v += 3) {
            const float* corner = vertices.data() + v * stride;
            const auto at = [&](std::size_t i) {
                return Eigen::Vector3f(
                    corner[i * stride], corner[i * stride + 1], corner[i * stride + 2]);
            };
            const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
            for (std::size_t i = 0; i < 3 * n; ++i) {
                const float* own = corner + i / n * stride + 6;
                const auto camera = static_cast<std::size_t>(own[i % n]);
                const Eigen::Vector3f to_camera = model.cameras[camera].centre_site - at(0);
                if (own[n + 4 * (i % n) + 3] > 0.0f) {
                    EXPECT_GT(normal.dot(to_camera.normalized()), 0.02f);
                }
            }
        }
    }
}

TEST(PersonModel, HiddenPartsAreNotSeen) {
    const Sphere front{{1.0, 0.0, 1.0}, 0.12};
    const Sphere back{{-0.5, 0.0, 1.0}, 0.35};
    const auto camera = synthetic::camera_at({3.0, 0.0, 1.0}, {0.0, 0.0, 1.0});
    const PersonModel model = build({front, back}, {camera});
    int num_hidden = 0;
    int num_seen = 0;
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
        const Eigen::Vector3d p = model.vertices_site[v].cast<double>();
        if ((p - back.centre).norm() > back.radius_m + 0.01) continue;
        const Eigen::Vector3d to_camera = (camera.centre_site() - p).normalized();
        if ((p - back.centre).normalized().dot(to_camera) < 0.55) continue;
        const double miss = (front.centre - p).cross(to_camera).norm();
        if (miss < front.radius_m) {
            EXPECT_EQ(model.cameras[0].quality[v], 0.0f) << p.transpose();
            ++num_hidden;
        } else if (miss > front.radius_m + 0.03) {
            EXPECT_GT(model.cameras[0].quality[v], 0.9f) << p.transpose();
            ++num_seen;
        }
    }
    EXPECT_GT(num_hidden, 20);
    EXPECT_GT(num_seen, 10);
}

TEST(PersonModel, LayerCoordinatesFollowTheLensDistortion) {
    const Sphere sphere{{0.3, 0.2, 1.1}, 0.5};
    auto camera = synthetic::camera_at({3.0, 0.0, 1.0}, {0.0, 0.0, 1.0});
    camera.intrinsics.distortion = {-0.2, 0.05, 0.001, -0.002, 0.0};
    const auto picture =
        synthetic::picture_of({sphere}, camera, [](const auto&) { return kGreen; });
    const PersonModel model = build(synthetic::mesh_of({sphere}, 12), {picture});
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
        const Eigen::Vector3d n =
            (model.vertices_site[v].cast<double>() - sphere.centre) / sphere.radius_m;
        if (n.dot(camera.centre_site() - sphere.centre) < 0.0) continue;  // never looked up
        const Eigen::Vector3d p_camera =
            camera.camera_from_site * model.vertices_site[v].cast<double>();
        const Eigen::Vector2d px = camera.intrinsics.distort(camera.intrinsics.project(p_camera));
        const Eigen::Vector3f& st = model.cameras[0].layer_coordinates[v];
        // half resolution: the centre of texel i lies at crop + 2 i + 0.5, with a border of one
        // texel
        const double x = st.x() / st.z() * model.layer_width - 0.5 - 1.0;
        const double y = st.y() / st.z() * model.layer_height - 0.5 - 1.0;
        EXPECT_NEAR(picture.crop_px.x + 2 * x + 0.5, px.x(), 0.01);
        EXPECT_NEAR(picture.crop_px.y + 2 * y + 0.5, px.y(), 0.01);
    }
}

TEST(PersonModel, LayersHoldNothingFromOutsideTheMask) {
    const Sphere sphere{{0.0, 0.0, 1.0}, 0.5};
    const PersonModel model =
        build({sphere}, {synthetic::camera_at({3.0, 0.0, 1.0}, sphere.centre)});
    for (std::size_t i = 0; i < model.layers.size(); i += 4) {
        // the pictures are magenta outside the mask; colours are multiplied by alpha
        if (model.layers[i + 3] == 0) {
            EXPECT_EQ(model.layers[i], 0);
        } else {
            EXPECT_NEAR(255.0 * model.layers[i + 1] / model.layers[i + 3], 255 * kGreen.y(), 3.0);
        }
    }
}

TEST(PersonModel, UnseenVerticesTakeTheirNeighboursColour) {
    const Sphere sphere{{0.0, 0.0, 1.0}, 0.5};
    const PersonModel model =
        build({sphere}, {synthetic::camera_at({3.0, 0.0, 1.0}, sphere.centre)});
    for (const Eigen::Vector3f& colour : model.fallback)
        EXPECT_LT((colour.cast<double>() - kGreen).norm(), 0.02);
}

TEST(PersonModel, IsGreyWithoutPictures) {
    const PersonModel model = build(synthetic::mesh_of({{{0.0, 0.0, 1.0}, 0.5}}, 8), {});
    EXPECT_TRUE(model.cameras.empty());
    ASSERT_FALSE(model.fallback.empty());
    EXPECT_EQ(model.fallback.front(), Eigen::Vector3f::Constant(0.5f));
}

class CameraBlend : public testing::Test {
protected:
    const Sphere sphere_{{0.0, 0.0, 1.0}, 0.5};
    const std::vector<geometry::CalibratedCamera> cameras_ = synthetic::ring(8, sphere_.centre);
    const PersonModel model_ = build({sphere_}, cameras_);
    BlendScratch scratch_;

    float weight(const BlendScratch& blend, std::size_t vertex, std::size_t camera) const {
        const VertexBlend& b = blend.vertices[vertex];
        for (std::size_t k = 0; k < kCamerasPerVertex; ++k)
            if (b.cameras[k] == camera && b.weights[k] > 0.0f) return b.weights[k];
        return 0.0f;
    }
};

TEST_F(CameraBlend, WeightsSumToOneOverSeeingCameras) {
    choose_cameras(model_, Eigen::Vector3f(2.0f, 1.0f, 1.5f), scratch_);
    for (std::size_t v = 0; v < model_.vertices_site.size(); ++v) {
        float sum = 0.0f;
        float best_quality = 0.0f;
        for (std::size_t c = 0; c < model_.cameras.size(); ++c) {
            sum += weight(scratch_, v, c);
            best_quality = std::max(best_quality, model_.cameras[c].quality[v]);
            if (model_.cameras[c].quality[v] == 0.0f) {
                EXPECT_EQ(weight(scratch_, v, c), 0.0f);
            }
        }
        if (best_quality > 0.3f) {
            EXPECT_NEAR(sum, 1.0f, 1e-5f);
        }
    }
}

TEST_F(CameraBlend, CameraAtTheEyeDominates) {
    for (std::size_t c = 0; c < model_.cameras.size(); ++c) {
        choose_cameras(model_, model_.cameras[c].centre_site, scratch_);
        for (std::size_t v = 0; v < model_.vertices_site.size(); ++v)
            if (model_.cameras[c].quality[v] > 0.95f) {
                EXPECT_GT(weight(scratch_, v, c), 0.6f);
            }
    }
}

TEST_F(CameraBlend, SmallStepOfTheEyeChangesWeightsALittle) {
    BlendScratch next;
    float largest = 0.0f;
    for (int step = 0; step < 400; ++step) {
        const auto eye = [](float angle) {
            return Eigen::Vector3f(2.5f * std::cos(angle), 2.5f * std::sin(angle), 1.6f);
        };
        constexpr float kStep = 0.002f;  // [rad]: a distance of 5 mm
        choose_cameras(model_, eye(0.015f * static_cast<float>(step)), scratch_);
        choose_cameras(model_, eye(0.015f * static_cast<float>(step) + kStep), next);
        for (std::size_t v = 0; v < model_.vertices_site.size(); ++v)
            for (std::size_t c = 0; c < model_.cameras.size(); ++c)
                largest = std::max(largest, std::abs(weight(scratch_, v, c) - weight(next, v, c)));
    }
    EXPECT_GT(largest, 0.0f);
    EXPECT_LT(largest, 0.02f);  // a switch without fading would be near 0.3
}

// Sorts the coordinates of the triangles' corners to make their order irrelevant.
std::vector<std::array<float, 9>> sorted(std::vector<std::array<float, 9>> triangles) {
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

TEST_F(CameraBlend, DrawsEveryTriangleThatFacesTheEyeOnce) {
    const Eigen::Vector3f eye(2.0f, 1.0f, 1.5f);
    BlendedMesh blended;
    blend_for_view(model_, eye, scratch_, blended);
    std::vector<std::array<float, 9>> facing;
    for (const auto& [a, b, c] : model_.triangles) {
        const Eigen::Vector3f& p = model_.vertices_site[a];
        const Eigen::Vector3f& q = model_.vertices_site[b];
        const Eigen::Vector3f& r = model_.vertices_site[c];
        if (!((q - p).cross(r - p).dot(eye - p) > 0.0f)) continue;
        facing.push_back({p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), r.x(), r.y(), r.z()});
    }
    std::vector<std::array<float, 9>> drawn;
    for (std::size_t g = 0; g < blended.groups.size(); ++g) {
        const std::size_t stride = floats_per_vertex(kCamerasPerTriangle[g]);
        std::vector<float> vertices(blended.groups[g].num_vertices() * stride);
        lay_out(model_, blended, g, vertices);
        for (auto at = vertices.begin(); at != vertices.end();) {
            std::array<float, 9>& triangle = drawn.emplace_back();
            for (auto to = triangle.begin(); to != triangle.end(); to += 3) {
                std::copy_n(at, 3, to);
                at += static_cast<std::ptrdiff_t>(stride);
            }
        }
    }
    EXPECT_EQ(sorted(drawn), sorted(facing));
}

}  // namespace
}  // namespace atrium::renderer
