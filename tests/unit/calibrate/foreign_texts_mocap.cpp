// The formats of motion capture programs and of COLMAP.
#include "tests/unit/calibrate/foreign_texts.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace atrium::calibrate::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d rotation_matrix(const geometry::CalibratedCamera& camera) {
    return camera.camera_from_site.rotation.toRotationMatrix();
}

template <typename T>
void append(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace

std::string qualisys_xml(const Cameras& cameras) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<calibration calibrated=\"2024-03-01\" type=\"regular\" "
        "wandLength=\"601.1\">\n<results std-dev=\"0.7\"/>\n<cameras>\n<camera active=\"1\" "
        "serial=\"10999\" model=\"Oqus 400\"><transform x=\"nan\"/></camera>\n";
    for (const auto& camera : cameras) {
        const auto& k = camera.intrinsics;
        const Vector3d p =
            -1000.0 * (rotation_matrix(camera).transpose() * camera.camera_from_site.translation);
        // axes of OpenGL: +X right, +Y up, +Z behind
        Matrix3d r = rotation_matrix(camera);
        r.row(1) *= -1;
        r.row(2) *= -1;
        const auto& d = k.distortion;
        // a window of the sensor that begins at (8, 4)
        text += fmt::format(
            "<camera active=\"1\" calibrated=\"true\" message=\"\" serial=\"{}\" model=\"Miqus "
            "Video\" viewrotation=\"0\">\n<fov_video left=\"8\" top=\"4\" right=\"{}\" "
            "bottom=\"{}\"/>\n<transform x=\"{:.12f}\" y=\"{:.12f}\" z=\"{:.12f}\" ",
            camera.name,
            8 + k.width - 1,
            4 + k.height - 1,
            p.x(),
            p.y(),
            p.z());
        for (int i = 0; i < 9; ++i)
            text += fmt::format("r{}{}=\"{:.15f}\" ", i / 3 + 1, i % 3 + 1, r(i / 3, i % 3));
        text += fmt::format(
            "/>\n<intrinsic focallength=\"9.2\" sensorMinU=\"0.0\" sensorMaxU=\"131071.0\" "
            "sensorMinV=\"0.0\" sensorMaxV=\"131071.0\" focalLengthU=\"{:.12f}\" "
            "focalLengthV=\"{:.12f}\" centerPointU=\"{:.12f}\" centerPointV=\"{:.12f}\" "
            "skew=\"0.000000\" radialDistortion1=\"{:.15f}\" radialDistortion2=\"{:.15f}\" "
            "radialDistortion3=\"{:.15f}\" tangentalDistortion1=\"{:.15f}\" "
            "tangentalDistortion2=\"{:.15f}\"/>\n</camera>\n",
            64 * k.fx,
            64 * k.fy,
            64 * (k.cx + 8) + 31.5,
            64 * (k.cy + 4) + 31.5,
            d[0],
            d[1],
            d[4],
            d[2],
            d[3]);
    }
    return text + "</cameras>\n</calibration>\n";
}

std::string vicon_xcp(const Cameras& cameras) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<Cameras>\n<Camera DEVICEID=\"2101\" "
        "TYPE=\"Vantage\"><KeyFrames/></Camera>\n";
    for (const auto& camera : cameras) {
        const auto& k = camera.intrinsics;
        const Eigen::Quaterniond q(rotation_matrix(camera).transpose());
        const Vector3d p =
            -1000.0 * (rotation_matrix(camera).transpose() * camera.camera_from_site.translation);
        text += fmt::format(
            "<Camera DEVICEID=\"{}\" DISPLAY_TYPE=\"VideoInputDevice:Vue\" "
            "PIXEL_ASPECT_RATIO=\"{:.17g}\" SENSOR_SIZE=\"{} {}\" SKEW=\"0\"><KeyFrames><KeyFrame "
            "FRAME=\"0\" FOCAL_LENGTH=\"{:.17g}\" PRINCIPAL_POINT=\"{:.17g} {:.17g}\" "
            "ORIENTATION=\"{:.17g} {:.17g} {:.17g} {:.17g}\" POSITION=\"{:.17g} {:.17g} {:.17g}\" "
            "VICON_RADIAL2=\"ViconRadial2 {:.17g} {:.17g} {:.17g} {:.17g} 0\" "
            "WORLD_ERROR=\"0.1\"/></KeyFrames></Camera>\n",
            camera.name,
            k.fx / k.fy,
            k.width,
            k.height,
            k.fx,
            k.cx,
            k.cy,
            q.x(),
            q.y(),
            q.z(),
            q.w(),
            p.x(),
            p.y(),
            p.z(),
            k.cx,
            k.cy,
            k.distortion[0],
            k.distortion[1]);
    }
    return text + "</Cameras>\n";
}

std::string colmap_cameras_txt(const Cameras& cameras) {
    std::string text = "# Camera list with one line of data per camera:\n";
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto& k = cameras[i].intrinsics;
        const auto& d = k.distortion;
        text += fmt::format(
            "{} OPENCV {} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n",
            i + 1,
            k.width,
            k.height,
            k.fx,
            k.fy,
            k.cx + 0.5,
            k.cy + 0.5,
            d[0],
            d[1],
            d[2],
            d[3]);
    }
    return text;
}

std::string colmap_images_txt(const Cameras& cameras, double units_per_m) {
    std::string text = "# Image list with two lines of data per image:\n";
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const Eigen::Quaterniond& q = cameras[i].camera_from_site.rotation;
        const Vector3d t = units_per_m * cameras[i].camera_from_site.translation;
        text += fmt::format(
            "{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {} {}/0001.jpg\n"
            "12.5 33.25 -1 44.0 55.0 7\n",
            i + 1,
            q.w(),
            q.x(),
            q.y(),
            q.z(),
            t.x(),
            t.y(),
            t.z(),
            i + 1,
            cameras[i].name);
    }
    return text;
}

std::string colmap_cameras_bin(const Cameras& cameras) {
    std::string bytes;
    append(bytes, static_cast<std::uint64_t>(cameras.size()));
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto& k = cameras[i].intrinsics;
        append(bytes, static_cast<std::uint32_t>(i + 1));
        append(bytes, std::int32_t{4});  // OPENCV
        append(bytes, static_cast<std::uint64_t>(k.width));
        append(bytes, static_cast<std::uint64_t>(k.height));
        for (const double v : {k.fx,
                               k.fy,
                               k.cx + 0.5,
                               k.cy + 0.5,
                               k.distortion[0],
                               k.distortion[1],
                               k.distortion[2],
                               k.distortion[3]})
            append(bytes, v);
    }
    return bytes;
}

std::string colmap_images_bin(const Cameras& cameras) {
    std::string bytes;
    append(bytes, static_cast<std::uint64_t>(cameras.size()));
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const Eigen::Quaterniond& q = cameras[i].camera_from_site.rotation;
        const Vector3d& t = cameras[i].camera_from_site.translation;
        append(bytes, static_cast<std::uint32_t>(i + 1));
        for (const double v : {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) append(bytes, v);
        append(bytes, static_cast<std::uint32_t>(i + 1));
        bytes += cameras[i].name + "/0001.jpg";
        bytes += '\0';
        append(bytes, std::uint64_t{1});
        append(bytes, 12.5);
        append(bytes, 33.25);
        append(bytes, std::int64_t{-1});
    }
    return bytes;
}

}  // namespace atrium::calibrate::test
