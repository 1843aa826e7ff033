#pragma once

#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <vector>

// Simpler ways to texture a person, to compare with the viewer's: with the same pictures, fallback
// colours and shader, but different weights.
namespace atrium::bench {

using CameraWeights = std::vector<std::vector<float>>;  // [camera][vertex]

/// (a) The one camera nearest to the eye, as seen from the middle of the person, wherever it sees
/// the surface. Elsewhere the fallback colour.
CameraWeights nearest_camera(const renderer::PersonModel& model, const Eigen::Vector3d& eye_site);

/// The same, but each vertex uses the nearest camera that sees it.
CameraWeights nearest_seeing_camera(const renderer::PersonModel& model,
                                    const Eigen::Vector3d& eye_site);

/// (b) All cameras that the surface faces, with equal weights, whatever is in between.
CameraWeights all_facing_cameras(const renderer::PersonModel& model);

/// Draws one model with given weights. The GL context is current during its lifetime.
class WeightedDrawing {
public:
    explicit WeightedDrawing(const renderer::PersonModel& model);
    void draw(const CameraWeights& weights,
              const Eigen::Matrix4d& clip_from_site,
              const Eigen::Vector3d& eye_site);

private:
    void lay_out(const CameraWeights& weights, const Eigen::Vector3f& eye_site);

    const renderer::PersonModel& model_;
    gl::ShaderProgram shader_;
    gl::VertexArray layout_;
    gl::Buffer vertices_;
    gl::Texture pictures_;
    std::vector<float> data_;
};

}  // namespace atrium::bench
