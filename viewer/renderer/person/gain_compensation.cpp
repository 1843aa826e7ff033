#include "viewer/renderer/person/gain_compensation.hpp"

#include "viewer/renderer/person/person_model.hpp"
#include "viewer/renderer/person/person_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace atrium::renderer {
namespace {

constexpr float kNotSeen = std::numeric_limits<float>::infinity();
// darker is noise, brighter may be clipped
constexpr float kDarkest = 16.0f;
constexpr float kBrightest = 240.0f;

std::size_t layer_texels(const PersonModel& model) {
    return static_cast<std::size_t>(model.layer_width) *
           static_cast<std::size_t>(model.layer_height);
}

// Log of the mean of the 3 x 3 texels around the centre of a face. Not seen unless all show the
// person.
Eigen::Array3f colour_of(const PersonModel& model, std::size_t camera, std::size_t triangle) {
    const auto& [a, b, c] = model.triangles[triangle];
    const auto& st = model.cameras[camera].layer_coordinates;
    const Eigen::Vector3f middle = st[a] + st[b] + st[c];
    const float s = middle.x() / middle.z() * static_cast<float>(model.layer_width);
    const float t = middle.y() / middle.z() * static_cast<float>(model.layer_height);
    const Eigen::Array3f none = Eigen::Array3f::Constant(kNotSeen);
    if (!(s >= 1.0f && t >= 1.0f && s < static_cast<float>(model.layer_width - 1) &&
          t < static_cast<float>(model.layer_height - 1)))
        return none;
    const auto x = static_cast<std::ptrdiff_t>(s);
    const auto y = static_cast<std::ptrdiff_t>(t);
    Eigen::Array3i sum = Eigen::Array3i::Zero();
    for (std::ptrdiff_t row = y - 1; row <= y + 1; ++row) {
        const std::uint8_t* rgba = model.layers.data() + 4 * camera * layer_texels(model) +
                                   4 * (row * model.layer_width + x - 1);
        for (int i = 0; i < 3; ++i, rgba += 4) {
            if (rgba[3] != 255) return none;
            sum += Eigen::Array3i(rgba[0], rgba[1], rgba[2]);
        }
    }
    const Eigen::Array3f mean = sum.cast<float>() / 9.0f;
    if (mean.minCoeff() < kDarkest || mean.maxCoeff() > kBrightest) return none;
    return mean.log();
}

bool is_well_seen(const PersonModel::Camera& camera,
                  const std::array<std::uint32_t, 3>& triangle,
                  std::size_t t) {
    if (camera.facing[t] < 0.99f) return false;
    return std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) {
        return camera.quality[v] > 0.5f;
    });
}

// Fills `log_colours`. Returns the number of points.
std::size_t look_at_points(const GainCompensationOptions& options,
                           const PersonModel& model,
                           GainCompensationScratch& scratch) {
    const std::size_t stride =
        std::max<std::size_t>(1, (model.triangles.size() - 1) / options.max_points + 1);
    const std::size_t num_points = (model.triangles.size() + stride - 1) / stride;
    scratch.log_colours.clear();
    for (std::size_t c = 0; c < model.cameras.size(); ++c) {
        for (std::size_t t = 0; t < model.triangles.size(); t += stride) {
            scratch.log_colours.push_back(is_well_seen(model.cameras[c], model.triangles[t], t)
                                              ? colour_of(model, c, t)
                                              : Eigen::Array3f(Eigen::Array3f::Constant(kNotSeen)));
        }
    }
    return num_points;
}

float median(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Computes the ratio of cameras i and j: the median difference, weighted by its certainty.
void compare(const GainCompensationOptions& options,
             std::size_t i,
             std::size_t j,
             std::size_t num_points,
             GainCompensationScratch& scratch) {
    const std::size_t num_cameras = scratch.log_gains.size();
    const Eigen::Array3f* of_i = scratch.log_colours.data() + i * num_points;
    const Eigen::Array3f* of_j = scratch.log_colours.data() + j * num_points;
    for (int channel = 0; channel < 3; ++channel) {
        scratch.differences.clear();
        for (std::size_t p = 0; p < num_points; ++p) {
            if (of_i[p].x() != kNotSeen && of_j[p].x() != kNotSeen)
                scratch.differences.push_back(of_i[p][channel] - of_j[p][channel]);
        }
        if (scratch.differences.size() < options.min_shared) return;
        const float middle = median(scratch.differences);
        scratch.deviations.clear();
        for (const float difference : scratch.differences)
            scratch.deviations.push_back(std::abs(difference - middle));
        // standard error of a median, from the median absolute deviation
        const double sigma = 1.4826 * 1.2533 * static_cast<double>(median(scratch.deviations));
        const double weight =
            1.0 / (options.doubt * options.doubt +
                   sigma * sigma / static_cast<double>(scratch.differences.size()));
        const auto k = static_cast<std::size_t>(channel);
        scratch.weights[i * num_cameras + j][k] = scratch.weights[j * num_cameras + i][k] = weight;
        scratch.ratios[i * num_cameras + j][channel] = middle;
        scratch.ratios[j * num_cameras + i][channel] = -middle;
    }
}

// Solves the least squares of (gain_j - gain_i - ratio_ij) and of the prior on gain_i.
void solve(const GainCompensationOptions& options, GainCompensationScratch& scratch) {
    const std::size_t num_cameras = scratch.log_gains.size();
    const auto size = static_cast<Eigen::Index>(num_cameras);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto k = static_cast<Eigen::Index>(channel);
        scratch.normal_matrix.setZero(size, size);
        scratch.solution.setZero(size);
        for (Eigen::Index i = 0; i < size; ++i) {
            scratch.normal_matrix(i, i) = 1.0 / (options.prior * options.prior);
            for (Eigen::Index j = 0; j < size; ++j) {
                const auto pair = static_cast<std::size_t>(i * size + j);
                const double weight = scratch.weights[pair][channel];
                scratch.normal_matrix(i, i) += weight;
                scratch.normal_matrix(i, j) -= weight;
                scratch.solution[i] -= weight * scratch.ratios[pair][k];
            }
        }
        scratch.solver.compute(scratch.normal_matrix);
        scratch.solver.solveInPlace(scratch.solution);
        for (std::size_t c = 0; c < num_cameras; ++c)
            scratch.log_gains[c][k] = scratch.solution[static_cast<Eigen::Index>(c)];
    }
    // soft threshold: a camera that drifts does not jump
    for (Eigen::Array3d& gain : scratch.log_gains)
        gain = gain.sign() * (gain.abs() - options.dead_zone).max(0.0);
}

void apply(const Eigen::Array3d& log_gain, std::size_t camera, PersonModel& model) {
    std::array<std::uint32_t, 3> factors{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double gain = std::exp(log_gain[static_cast<Eigen::Index>(channel)]);
        factors[channel] = static_cast<std::uint32_t>(std::min(100.0, gain) * 65536.0 + 0.5);
    }
    // no gain below the noise of the camera's picture
    const float num_rows =
        model.cameras[camera].high_st.y() * static_cast<float>(model.layer_height) + 0.5f;
    const auto size =
        static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(model.layer_width);
    auto* rgba =
        reinterpret_cast<std::uint32_t*>(model.layers.data()) + camera * layer_texels(model);
    multiply_colours({rgba, std::min(size, layer_texels(model))}, factors, image::best_row_code());
}

}  // namespace

void compensate_gains(const GainCompensationOptions& options,
                      GainCompensationScratch& scratch,
                      PersonModel& model) {
    const std::size_t num_cameras = model.cameras.size();
    scratch.log_gains.assign(num_cameras, Eigen::Array3d::Zero());
    if (options.max_points == 0 || num_cameras < 2 || model.triangles.empty()) return;
    scratch.weights.assign(num_cameras * num_cameras, {});
    scratch.ratios.assign(num_cameras * num_cameras, Eigen::Array3d::Zero());
    const std::size_t num_points = look_at_points(options, model, scratch);
    for (std::size_t i = 0; i < num_cameras; ++i)
        for (std::size_t j = i + 1; j < num_cameras; ++j)
            compare(options, i, j, num_points, scratch);
    solve(options, scratch);
    for (std::size_t c = 0; c < num_cameras; ++c) {
        if ((scratch.log_gains[c] == 0.0).all()) continue;
        apply(scratch.log_gains[c], c, model);
    }
}

}  // namespace atrium::renderer
