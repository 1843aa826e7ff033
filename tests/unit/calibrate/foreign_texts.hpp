#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "tests/support/random.hpp"

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

/// Calibrations as other programs write them, from known cameras. Written from the formats'
/// documentation, without the code under test.
namespace atrium::calibrate::test {

using Cameras = std::vector<geometry::CalibratedCamera>;

/// The rotation into a level camera at `eye` that looks at `target`, both in the site frame.
Eigen::Matrix3d level_rotation(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

/// Cameras around a room, in metres, +Z up, floor at 0; all look at about (0, 0, 1), nearly level.
Cameras random_room(atrium::test::Random& random, int num_cameras);

/// The same cameras in a frame of other axes: `file_from_site` turns points.
Cameras in_frame(Cameras cameras, const Eigen::Matrix3d& file_from_site);

std::string opencv_yaml(const Cameras& cameras, double units_per_m);
std::string opencv_xml(const Cameras& cameras);
std::string opencv_json(const Cameras& cameras);
/// The two files of EasyMocap: K_name, dist_name; R_name (vector), Rot_name, T_name.
std::string easymocap_intri(const Cameras& cameras);
std::string easymocap_extri(const Cameras& cameras);
std::string qualisys_xml(const Cameras& cameras);
std::string vicon_xcp(const Cameras& cameras);
std::string anipose_toml(const Cameras& cameras, double units_per_m);
std::string caliscope_toml(const Cameras& cameras);
std::string kalibr_yaml(const Cameras& cameras);
std::string colmap_cameras_txt(const Cameras& cameras);
/// Images are called `name`/0001.jpg.
std::string colmap_images_txt(const Cameras& cameras, double units_per_m);
std::string colmap_cameras_bin(const Cameras& cameras);
std::string colmap_images_bin(const Cameras& cameras);

/// A folder of this test alone.
class Folder {
public:
    Folder();
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::filesystem::path write(const std::string& name, const std::string& text) const;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// The largest difference of two rigs in anything but names: metres, pixels or coefficients.
double difference(std::span<const geometry::CalibratedCamera> a,
                  std::span<const geometry::CalibratedCamera> b);

}  // namespace atrium::calibrate::test
