#include "site_node/region_work.hpp"

#include "core/bus/names.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace atrium::site_node {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

bus::LeftOutTotals left_out_of(const hull::VisualHull& hull) {
    bus::LeftOutTotals totals;
    totals.num_phantoms = hull.num_phantoms_dropped;
    totals.num_fragments = hull.num_fragments_dropped;
    totals.dropped_l = kLitresPerM3 * hull.volume_dropped_m3;
    totals.num_contours_dropped = hull.num_contours_dropped;
    totals.num_contours_repaired = hull.num_contours_repaired;
    return totals;
}

}  // namespace

RegionWork::RegionWork(std::vector<geometry::CalibratedCamera> cameras,
                       HullStage hull,
                       const codec::MeshCodecOptions& options,
                       std::uint64_t settings)
    : cameras_(std::move(cameras)),
      hull_(std::move(hull)),
      meshes_(hull_.regions().size(), options),
      settings_(settings) {
    for (std::uint32_t i = 0; i < hull_.regions().size(); ++i) {
        if (!hull_.regions()[i].is_elsewhere) regions_.push_back(i);
    }
}

Expected<void> RegionWork::take(const bus::RegionOrder& order) {
    delivered_.assign(cameras_.size(), 0);
    auto size = order.contour_sizes.begin();
    auto vertex = order.vertices_px.begin();
    for (std::size_t i = 0; i < order.cameras.size(); ++i) {
        const std::uint32_t camera = order.cameras[i];
        if (camera >= cameras_.size())
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("an order has camera {}, the rig has {} cameras: use one "
                                          "rig on all hosts of the site",
                                          camera,
                                          cameras_.size()));
        delivered_[camera] = 1;
        auto& contours = hull_.contours(camera);
        contours.resize(order.contour_counts[i]);
        for (auto& contour : contours) {
            contour.clear();
            for (std::uint32_t k = 0; k < *size; ++k, ++vertex)
                contour.emplace_back((*vertex)[0], (*vertex)[1]);
            ++size;
        }
    }
    return {};
}

void RegionWork::fail(const Error& error, bus::RegionMeshes& answer) const {
    fail(bus::RegionOutcome::kFailed, bus::as_line(error.message), answer);
}

void RegionWork::fail(bus::RegionOutcome outcome,
                      std::string reason,
                      bus::RegionMeshes& answer) const {
    answer.hull_ms = answer.mesh_ms = 0.0;
    answer.left_out = {};
    answer.left_out.num_regions_failed = regions_.size();
    answer.reason = std::move(reason);
    answer.regions.clear();
    answer.draco.clear();
    for (const std::uint32_t region : regions_) answer.regions.push_back({region, outcome, 0});
}

Expected<void> RegionWork::compute(const bus::RegionOrder& order,
                                   Executor& executor,
                                   bus::RegionMeshes& answer) {
    if (order.settings != settings_) {
        // silhouettes of another rig would give a wrong hull without a sign of it
        fail(bus::RegionOutcome::kOtherRig,
             "its rig or [hull] differs from that of the model part: copy the site's file and its "
             "rig to all hosts, and start their programs anew",
             answer);
        return {};
    }
    if (auto taken = take(order); !taken) return taken;
    const auto hull_begin = Clock::now();
    hull_.compute(delivered_, {}, executor, whole_);
    answer.hull_ms = milliseconds_since(hull_begin);
    meshes_.clear();
    const auto hulls = hull_.region_hulls();
    const auto encode = [&](std::size_t i, std::size_t) {
        meshes_.encode(regions_[i], hulls[regions_[i]].mesh, cameras_);
    };
    executor.parallel_for(regions_.size(), encode);
    if (auto coded = meshes_.result(); !coded) return coded;
    answer.mesh_ms = meshes_.milliseconds();
    answer.left_out = left_out_of(whole_);
    answer.reason.clear();
    answer.regions.clear();
    answer.draco.clear();
    for (const std::uint32_t region : regions_) {
        const hull::HullStatus status = hulls[region].status;
        const auto& draco = meshes_.draco(region);
        bus::RegionOutcome outcome = bus::RegionOutcome::kNobody;
        if (!draco.empty()) {
            outcome = bus::RegionOutcome::kMesh;
        } else if (status != hull::HullStatus::kEmptyIntersection) {
            outcome = bus::RegionOutcome::kFailed;
            ++answer.left_out.num_regions_failed;
            answer.reason =
                fmt::format("{}: {}", hull_.regions()[region].name, hull::to_string(status));
        }
        answer.regions.push_back({region, outcome, static_cast<std::uint32_t>(draco.size())});
        answer.draco.insert(answer.draco.end(), draco.begin(), draco.end());
    }
    return {};
}

}  // namespace atrium::site_node
