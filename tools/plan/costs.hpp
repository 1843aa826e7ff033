#pragma once

#include "core/base/expected.hpp"

#include <filesystem>
#include <string>

namespace atrium::plan {

/// A cost of a picture: fixed + slope * x.
struct Cost {
    double fixed = 0.0;
    double slope = 0.0;

    double of(double x) const { return fixed + slope * x; }
};

/// What the work of a site costs on one core of a machine: deploy/costs.toml, which
/// bench/site/site_costs.sh writes. For one person whom every camera sees whole.
struct Costs {
    std::string machine;
    std::string measured;
    double score = 0.0;                // of one core of that machine
    Cost silhouette_ms;                // of a picture, over its megapixels
    Cost texture_ms;                   // of a picture, over its megapixels
    Cost texture_bytes;                // of a picture, over its megapixels
    Cost segments;                     // of a silhouette, over the square root of the megapixels
    double hull_us_per_segment = 0.0;  // with one view; grows with `hull_power`
    double hull_power = 0.0;
    double hull_two_threads = 1.0;  // so many times as fast as one thread
    double triangles_per_segment = 0.0;
    double mesh_ms_per_ktriangle = 0.0;
    double mesh_bytes_per_triangle = 0.0;
    Cost message_ms;  // to write and take a message, over its kilobytes

    /// Time of a hull of so many views with so many segments in all.
    double hull_ms(std::size_t num_views, double num_segments, int num_threads) const;
};

/// Errors name file, line and key.
Expected<Costs> load_costs(const std::filesystem::path& file);

}  // namespace atrium::plan
