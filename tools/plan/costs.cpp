#include "tools/plan/costs.hpp"

#include "core/config/table_reader.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::plan {
namespace {

constexpr config::Range kMost{-1e6, 1e9};

void read(config::TableReader& table, const char* key, double& value) {
    table.require(key);
    table.read(key, value, kMost);
}

void read(config::TableReader& table, const char* key, Cost& cost) {
    double values[2] = {};
    table.require(key);
    table.read(key, values, 2, kMost);
    cost = {values[0], values[1]};
}

}  // namespace

// Amdahl's law, by the share that two threads showed to be serial.
double Costs::hull_ms(std::size_t num_views, double num_segments, int num_threads) const {
    const double one_thread = 1e-3 * num_segments * hull_us_per_segment *
                              std::pow(static_cast<double>(num_views), hull_power);
    const double serial = std::clamp(2.0 / hull_two_threads - 1.0, 0.0, 1.0);
    return one_thread * (serial + (1.0 - serial) / num_threads);
}

Expected<Costs> load_costs(const std::filesystem::path& file) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    Costs costs;
    config::TableReader machine = reader->table("machine");
    machine.read("name", costs.machine);
    machine.read("measured", costs.measured);
    read(machine, "score", costs.score);
    config::TableReader picture = reader->table("picture");
    read(picture, "silhouette_ms", costs.silhouette_ms);
    read(picture, "texture_ms", costs.texture_ms);
    read(picture, "texture_bytes", costs.texture_bytes);
    read(picture, "segments", costs.segments);
    config::TableReader hull = reader->table("hull");
    read(hull, "us_per_segment", costs.hull_us_per_segment);
    read(hull, "power", costs.hull_power);
    read(hull, "two_threads", costs.hull_two_threads);
    config::TableReader mesh = reader->table("mesh");
    read(mesh, "triangles_per_segment", costs.triangles_per_segment);
    read(mesh, "ms_per_ktriangle", costs.mesh_ms_per_ktriangle);
    read(mesh, "bytes_per_triangle", costs.mesh_bytes_per_triangle);
    config::TableReader message = reader->table("message");
    read(message, "ms", costs.message_ms);
    if (auto done = reader->finish(); !done) return tl::unexpected(done.error());
    return costs;
}

}  // namespace atrium::plan
