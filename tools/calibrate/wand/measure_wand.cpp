#include "tools/calibrate/wand/measure_wand.hpp"

#include "core/base/median.hpp"
#include "tools/calibrate/adjust/place_wands.hpp"
#include "tools/calibrate/wand/lateness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace atrium::calibrate {
namespace {

constexpr int kFields = 8;  // of a picture, along each side

class Measurement {
public:
    explicit Measurement(WandSolution& solution)
        : solution_(solution), ranges_(ranges_of(solution.bundle)) {}

    void measure() {
        const Bundle& bundle = solution_.bundle;
        std::vector<std::uint8_t> fields(bundle.cameras.size() * kFields * kFields, 0);
        double all = 0.0, num_all = 0.0;
        for (const Sighting& sighting : bundle.sightings) {
            CameraFigures& figures = solution_.cameras[sighting.camera];
            const Eigen::Vector2d error = error_px(bundle, sighting);
            if (!sighting.is_used) {
                figures.num_outliers += error.allFinite() ? 1 : 0;
                continue;
            }
            ++figures.num_used;
            figures.rms_px += error.squaredNorm();
            figures.mean_x_px += error.x();
            figures.mean_y_px += error.y();
            all += error.squaredNorm();
            num_all += 2.0;
            const BundleCamera& camera = bundle.cameras[sighting.camera];
            const auto field = [](double at, int size) {
                return std::clamp(static_cast<int>(at * kFields / size), 0, kFields - 1);
            };
            fields[(sighting.camera * kFields +
                    static_cast<std::size_t>(field(sighting.px.y(), camera.height))) *
                       kFields +
                   static_cast<std::size_t>(field(sighting.px.x(), camera.width))] = 1;
        }
        solution_.rms_px = std::sqrt(all / std::max(1.0, num_all));
        find_middle();
        for (std::size_t c = 0; c < solution_.cameras.size(); ++c) {
            CameraFigures& figures = solution_.cameras[c];
            const double n = std::max<double>(1.0, static_cast<double>(figures.num_used));
            figures.rms_px = std::sqrt(figures.rms_px / (2.0 * n));
            figures.mean_x_px /= n;
            figures.mean_y_px /= n;
            const auto begin = fields.begin() + static_cast<std::ptrdiff_t>(c * kFields * kFields);
            figures.coverage =
                static_cast<double>(std::count(begin, begin + kFields * kFields, 1)) /
                (kFields * kFields);
            const BundleCamera& camera = bundle.cameras[c];
            const double distance = (camera.centre_world() - solution_.middle_world).norm();
            figures.middle_mm = 1000.0 * figures.rms_px * distance / camera.lens[0];
        }
        measure_length();
        for (std::size_t c = 0; c < solution_.cameras.size(); ++c)
            solution_.cameras[c].late_instants = small_lateness(solution_, c);
        measure_lights();
    }

private:
    void find_middle() {
        const Bundle& bundle = solution_.bundle;
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const WandPose& wand : bundle.wands) {
            if (!wand.is_placed) continue;
            sum += wand.world_from_wand.translation;
            ++solution_.num_instants;
        }
        solution_.middle_world =
            sum / std::max<double>(1.0, static_cast<double>(solution_.num_instants));
    }

    // Of the two lights that are furthest apart, each triangulated on its own.
    void measure_length() {
        const Bundle& bundle = solution_.bundle;
        const auto& lights = bundle.wand.lights_m;
        std::size_t a = 0, b = 0;
        for (std::size_t i = 0; i < lights.size(); ++i)
            for (std::size_t j = i + 1; j < lights.size(); ++j)
                if ((lights[i] - lights[j]).norm() > (lights[a] - lights[b]).norm()) a = i, b = j;
        if (a == b) return;
        double sum = 0.0, count = 0.0;
        for (const InstantRange& range : ranges_) {
            std::vector<const Sighting*> of_a, of_b;
            for (std::size_t s = range.begin; s < range.end; ++s) {
                const Sighting& sighting = bundle.sightings[s];
                if (!sighting.is_used) continue;
                if (sighting.light == a) of_a.push_back(&sighting);
                if (sighting.light == b) of_b.push_back(&sighting);
            }
            const auto at_a = triangulate(bundle, of_a), at_b = triangulate(bundle, of_b);
            if (!at_a || !at_b) continue;
            const double error = (*at_a - *at_b).norm() - (lights[a] - lights[b]).norm();
            sum += error * error;
            count += 1.0;
        }
        solution_.wand_length_rms_m = std::sqrt(sum / std::max(1.0, count));
    }

    // Where the lights of a line are, seen one by one, beside where the wand's file has them.
    void measure_lights() {
        const Bundle& bundle = solution_.bundle;
        const std::size_t n = bundle.wand.size();
        solution_.light_offsets_m.assign(n, 0.0);
        if (bundle.wand.form() != WandForm::kLine || n < 3) return;
        std::vector<std::vector<double>> offsets(n);
        for (const InstantRange& range : ranges_) {
            std::vector<std::vector<const Sighting*>> of_light(n);
            for (std::size_t s = range.begin; s < range.end; ++s)
                if (bundle.sightings[s].is_used)
                    of_light[bundle.sightings[s].light].push_back(&bundle.sightings[s]);
            for (std::size_t light = 0; light < n; ++light) {
                const auto at = triangulate(bundle, of_light[light]);
                if (!at) continue;
                const geometry::RigidTransform& pose =
                    bundle.wands[of_light[light].front()->instant].world_from_wand;
                const Eigen::Vector3d along =
                    pose.rotation * (bundle.wand.lights_m.back() - bundle.wand.lights_m.front());
                offsets[light].push_back(
                    along.normalized().dot(*at - pose * bundle.wand.lights_m[light]));
            }
        }
        for (std::size_t light = 0; light < n; ++light)
            solution_.light_offsets_m[light] = median_of(std::move(offsets[light]));
    }

    WandSolution& solution_;
    std::vector<InstantRange> ranges_;
};

}  // namespace

void measure_wand(WandSolution& solution) { Measurement(solution).measure(); }

}  // namespace atrium::calibrate
