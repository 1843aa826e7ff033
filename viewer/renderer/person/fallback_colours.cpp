#include "viewer/renderer/person/fallback_colours.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace atrium::renderer {
namespace {

constexpr float kLeastQuality = 0.02f;
constexpr float kLeastWeight = 1.0f;  // of 255: less has no colour
// From this weight on a vertex is certain. Texels at an outline, which mix with the background,
// weigh 48 at most.
constexpr float kCertainWeight = 96.0f;
constexpr float kNeighbourWeight = 8.0f;  // of each neighbour, beside a vertex's own colour
constexpr int kMaxSteps = 24;             // edges; vertices farther away get the mean colour
constexpr int kSmoothings = 8;

bool has_bare_corner(const std::array<std::uint32_t, 3>& triangle,
                     const std::vector<std::uint8_t>& is_coloured) {
    const auto& [a, b, c] = triangle;
    return (is_coloured[a] & is_coloured[b] & is_coloured[c]) == 0;
}

void add_up(std::span<const std::vector<std::int32_t>> texels,
            const PersonModel& model,
            FallbackScratch& scratch) {
    const std::size_t layer_bytes = static_cast<std::size_t>(model.layer_width) *
                                    static_cast<std::size_t>(model.layer_height) * 4;
    scratch.seen.assign(model.vertices_site.size(), Eigen::Vector4f::Zero());
    for (std::size_t c = 0; c < model.cameras.size(); ++c) {
        const float* quality = model.cameras[c].quality.data();
        const std::int32_t* texel = texels[c].data();
        const std::uint8_t* layer = model.layers.data() + c * layer_bytes;
        for (std::size_t v = 0; v < scratch.seen.size(); ++v) {
            if (quality[v] <= kLeastQuality) continue;
            const std::uint8_t* rgba = layer + 4 * std::ptrdiff_t{texel[v]};
            const Eigen::Vector4i colour(rgba[0], rgba[1], rgba[2], rgba[3]);
            scratch.seen[v] += quality[v] * colour.cast<float>();
        }
    }
}

// Gives each vertex the colour that cameras see, and returns the mean of the certain ones.
Eigen::Vector3f colour_seen(FallbackScratch& scratch, PersonModel& model) {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    std::size_t num_certain = 0;
    model.fallback.assign(scratch.seen.size(), Eigen::Vector3f::Zero());
    scratch.is_coloured.assign(scratch.seen.size(), 0);
    scratch.uncertain.clear();
    for (std::size_t v = 0; v < scratch.seen.size(); ++v) {
        const Eigen::Vector4f& seen = scratch.seen[v];
        if (seen.w() > kLeastWeight) model.fallback[v] = seen.head<3>() / seen.w();
        if (seen.w() < kCertainWeight) {
            scratch.uncertain.push_back(static_cast<std::uint32_t>(v));
            continue;
        }
        scratch.is_coloured[v] = 1;
        mean += model.fallback[v];
        ++num_certain;
    }
    return num_certain > 0 ? Eigen::Vector3f(mean / static_cast<float>(num_certain))
                           : Eigen::Vector3f::Constant(0.5f);
}

// Uncertain vertices take over the colour of the nearest certain ones along the surface.
void spread(const Eigen::Vector3f& mean, FallbackScratch& scratch, PersonModel& model) {
    std::vector<std::uint8_t>& is_coloured = scratch.is_coloured;
    std::size_t num_left = scratch.uncertain.size();
    for (int step = 0; step < kMaxSteps && num_left > 0; ++step) {
        const std::size_t before = num_left;
        for (const std::uint32_t t : scratch.around) {
            const auto& triangle = model.triangles[t];
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint32_t from = triangle[i];
                const std::uint32_t to = triangle[(i + 1) % 3];
                if (is_coloured[from] == 0 || is_coloured[to] != 0) continue;
                model.fallback[to] = model.fallback[from];
                is_coloured[to] = 1;
                --num_left;
            }
        }
        if (num_left == before) break;
    }
    for (const std::uint32_t v : scratch.uncertain)
        if (is_coloured[v] == 0) model.fallback[v] = mean;
}

void smooth(FallbackScratch& scratch, PersonModel& model) {
    // the fourth component is the weight: 1 of a colour
    scratch.colours.resize(model.fallback.size());
    for (std::size_t v = 0; v < model.fallback.size(); ++v) {
        scratch.colours[v] << model.fallback[v], 1.0f;
        scratch.colours[v] *= kNeighbourWeight;
    }
    scratch.sums.assign(model.fallback.size(), Eigen::Vector4f::Zero());
    for (int i = 0; i < kSmoothings; ++i) {
        for (const std::uint32_t v : scratch.uncertain) scratch.sums[v] = scratch.seen[v];
        for (const std::uint32_t t : scratch.around) {
            const auto& [a, b, c] = model.triangles[t];
            const Eigen::Vector4f of_a = scratch.colours[a];
            const Eigen::Vector4f of_b = scratch.colours[b];
            const Eigen::Vector4f of_c = scratch.colours[c];
            scratch.sums[a] += of_b + of_c;
            scratch.sums[b] += of_c + of_a;
            scratch.sums[c] += of_a + of_b;
        }
        for (const std::uint32_t v : scratch.uncertain)
            scratch.colours[v] = scratch.sums[v] * (kNeighbourWeight / scratch.sums[v].w());
    }
    for (const std::uint32_t v : scratch.uncertain)
        model.fallback[v] = scratch.colours[v].head<3>() / kNeighbourWeight;
}

}  // namespace

void find_fallback_colours(std::span<const std::vector<std::int32_t>> texels,
                           FallbackScratch& scratch,
                           PersonModel& model) {
    add_up(texels, model, scratch);
    const Eigen::Vector3f mean = colour_seen(scratch, model);
    if (scratch.uncertain.empty()) return;
    scratch.around.clear();
    for (std::uint32_t t = 0; t < model.triangles.size(); ++t)
        if (has_bare_corner(model.triangles[t], scratch.is_coloured)) scratch.around.push_back(t);
    spread(mean, scratch, model);
    smooth(scratch, model);
}

}  // namespace atrium::renderer
