#pragma once

#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/conclude_up.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace atrium::calibrate {

/// Concludes one thing after the other; each step leaves its sentences.
class Concluder {
public:
    Concluder(const ForeignRig& foreign, const Said& said) : foreign_(foreign), said_(said) {
        for (const ForeignCamera& camera : foreign.cameras) {
            cameras_.push_back({camera.name, camera.lens, {}});
            poses_.push_back(*camera.pose);
        }
    }

    Expected<Conclusion> run() {
        result_.told = foreign_.notes;
        result_.checks = foreign_.checks;
        result_.problems = foreign_.problems;
        read_poses();
        if (auto scaled = find_scale(); !scaled) return tl::unexpected(scaled.error());
        if (auto found = find_heights(); !found) return tl::unexpected(found.error());
        find_up();
        find_floor();
        check_by_tape();
        result_.rig.cameras = cameras_;
        result_.rig.rate_hz = said_.rate_hz;
        return std::move(result_);
    }

private:
    void read_poses();
    void place_cameras(const Reading& reading);
    bool looks_mirrored(double aim_m) const;
    void unify_units(const Reading& wanted, bool is_said);
    void report_elsewhere(std::size_t camera,
                          const std::vector<bool>& looks,
                          const Reading& common);
    void report_same_poses();
    Expected<void> find_scale();
    Expected<double> said_scale() const;
    Expected<void> find_heights();
    void find_up();
    void report_floor(double aim_m, bool is_of_file);
    std::string measured_text() const;
    void find_floor();
    void check_by_tape();
    Expected<std::size_t> index_of(const std::string& name) const;

    void scale(double factor) {
        for (auto& camera : cameras_) camera.camera_from_site.translation *= factor;
    }
    void move(const geometry::RigidTransform& old_from_new) {
        for (auto& camera : cameras_)
            camera.camera_from_site = camera.camera_from_site * old_from_new;
    }
    void tell(std::string text) { result_.told.push_back(std::move(text)); }
    void check(std::string text) { result_.checks.push_back(std::move(text)); }
    void problem(std::string text) { result_.problems.push_back(std::move(text)); }

    const ForeignRig& foreign_;
    const Said& said_;
    std::vector<geometry::CalibratedCamera> cameras_;
    std::vector<ForeignPose> poses_;
    bool is_frame_of_camera_ = false;  // of one that stands at the origin of the file
    bool is_turned_ = false;           // into a frame that is not the file's
    bool is_turned_axis_ = false;      // z of the new frame is another axis of the file
    Measurements measured_;
    std::optional<double> floor_m_;  // from the measured heights, along the new z
    bool has_floor_ = false;         // false: a usual one is assumed
    Conclusion result_;
};

}  // namespace atrium::calibrate
