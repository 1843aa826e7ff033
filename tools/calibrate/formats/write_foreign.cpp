#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include <functional>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using Lost = std::vector<std::string>;
using geometry::CalibratedCamera;

std::string row(const Eigen::Matrix3d& m, int i) {
    return fmt::format("{}, {}, {}", m(i, 0), m(i, 1), m(i, 2));
}

Eigen::Matrix3d camera_matrix(const geometry::PinholeCamera& k) {
    Eigen::Matrix3d m;
    m << k.fx, k.skew, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0;
    return m;
}

cv::Mat to_cv(const Eigen::Matrix3d& m) {
    cv::Mat result(3, 3, CV_64F);
    for (int i = 0; i < 9; ++i) result.at<double>(i / 3, i % 3) = m(i / 3, i % 3);
    return result;
}

Expected<void> write_opencv(const config::Rig& rig, const fs::path& output) try {
    const std::string suffix = output.extension().string();
    const char* syntax = suffix == ".xml" ? ".xml" : suffix == ".json" ? ".json" : ".yml";
    cv::FileStorage storage(syntax, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    for (const CalibratedCamera& camera : rig.cameras) {
        const geometry::PinholeCamera& k = camera.intrinsics;
        // a key begins with a letter
        const bool needs_letter = std::isalpha(static_cast<unsigned char>(camera.name[0])) == 0;
        std::string key = (needs_letter ? "cam_" : "") + camera.name;
        for (char& c : key)
            if (c == '.' || c == '-') c = '_';
        const cv::Mat distortion(1, 5, CV_64F, const_cast<double*>(k.distortion.data()));
        const ForeignPose pose = foreign_pose(camera.camera_from_site, {});
        const cv::Mat translation =
            (cv::Mat_<double>(3, 1) << pose.vector.x(), pose.vector.y(), pose.vector.z());
        storage << key << "{"
                << "camera_name" << camera.name << "image_width" << k.width << "image_height"
                << k.height << "camera_matrix" << to_cv(camera_matrix(k))
                << "distortion_coefficients" << distortion << "R" << to_cv(pose.rotation) << "T"
                << translation << "}";
    }
    return write_text(output, storage.releaseAndGetString(), true);
} catch (const cv::Exception& failure) {
    return make_error(ErrorKind::kInternal,
                      fmt::format("{}: cannot be written: {}", output.string(), failure.what()));
}

Expected<void> write_toml(const config::Rig& rig, const fs::path& output) {
    std::string text;
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        const CalibratedCamera& camera = rig.cameras[i];
        const geometry::PinholeCamera& k = camera.intrinsics;
        const Eigen::Matrix3d m = camera_matrix(k);
        const Eigen::AngleAxisd turn(camera.camera_from_site.rotation);
        const Eigen::Vector3d r = turn.angle() * turn.axis();
        const Eigen::Vector3d& t = camera.camera_from_site.translation;
        const auto& d = k.distortion;
        text += fmt::format(
            "[cam_{}]\nname = \"{}\"\nport = {}\nsize = [{}, {}]\nmatrix = [[{}], [{}], [{}]]\n"
            "distortions = [{}, {}, {}, {}, {}]\nrotation = [{}, {}, {}]\n"
            "translation = [{}, {}, {}]\nfisheye = false\n\n",
            i,
            camera.name,
            i,
            k.width,
            k.height,
            row(m, 0),
            row(m, 1),
            row(m, 2),
            d[0],
            d[1],
            d[2],
            d[3],
            d[4],
            r.x(),
            r.y(),
            r.z(),
            t.x(),
            t.y(),
            t.z());
    }
    return write_text(output, text + "[metadata]\nadjusted = false\nerror = 0.0\n", true);
}

Expected<void> write_qualisys(const config::Rig& rig, const fs::path& output) {
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<calibration type=\"regular\" "
        "source=\"Atrium\">\n <cameras>\n";
    for (const CalibratedCamera& camera : rig.cameras) {
        const geometry::PinholeCamera& k = camera.intrinsics;
        const ForeignPose pose =
            foreign_pose(camera.camera_from_site, {Reading::Pose::kRotationAndPosition, true});
        const Eigen::Matrix3d& r = pose.rotation;
        const auto units = [](double pixel) { return 64.0 * pixel + 31.5; };
        const auto& d = k.distortion;
        text += fmt::format(
            "  <camera active=\"1\" calibrated=\"true\" serial=\"{}\" model=\"Miqus Video\" "
            "viewrotation=\"0\">\n"
            "   <fov_video left=\"0\" top=\"0\" right=\"{}\" bottom=\"{}\"/>\n"
            "   <transform x=\"{}\" y=\"{}\" z=\"{}\" r11=\"{}\" r12=\"{}\" r13=\"{}\" r21=\"{}\" "
            "r22=\"{}\" r23=\"{}\" r31=\"{}\" r32=\"{}\" r33=\"{}\"/>\n",
            camera.name,
            k.width - 1,
            k.height - 1,
            1000 * pose.vector.x(),
            1000 * pose.vector.y(),
            1000 * pose.vector.z(),
            r(0, 0),
            r(0, 1),
            r(0, 2),
            r(1, 0),
            r(1, 1),
            r(1, 2),
            r(2, 0),
            r(2, 1),
            r(2, 2));
        text += fmt::format(
            "   <intrinsic sensorMinU=\"0\" sensorMaxU=\"{}\" sensorMinV=\"0\" sensorMaxV=\"{}\" "
            "focalLengthU=\"{}\" focalLengthV=\"{}\" centerPointU=\"{}\" centerPointV=\"{}\" "
            "skew=\"{}\" radialDistortion1=\"{}\" radialDistortion2=\"{}\" "
            "radialDistortion3=\"{}\" "
            "tangentalDistortion1=\"{}\" tangentalDistortion2=\"{}\"/>\n  </camera>\n",
            64 * k.width - 1,
            64 * k.height - 1,
            64 * k.fx,
            64 * k.fy,
            units(k.cx),
            units(k.cy),
            64 * k.skew,
            d[0],
            d[1],
            d[4],
            d[2],
            d[3]);
    }
    return write_text(output, text + " </cameras>\n</calibration>\n", true);
}

Expected<void> write_vicon(const config::Rig& rig, const fs::path& output) {
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Cameras VERSION=\"1.0\">\n";
    for (const CalibratedCamera& camera : rig.cameras) {
        const geometry::PinholeCamera& k = camera.intrinsics;
        const Eigen::Quaterniond q = camera.camera_from_site.rotation.conjugate();
        const Eigen::Vector3d p = 1000.0 * camera.centre_site();
        text += fmt::format(
            " <Camera DEVICEID=\"{}\" DISPLAY_TYPE=\"VideoCamera\" PIXEL_ASPECT_RATIO=\"{}\" "
            "SENSOR_SIZE=\"{} {}\" SKEW=\"{}\">\n  <KeyFrames>\n   <KeyFrame FRAME=\"0\" "
            "FOCAL_LENGTH=\"{}\" PRINCIPAL_POINT=\"{} {}\" ORIENTATION=\"{} {} {} {}\" "
            "POSITION=\"{} {} {}\" VICON_RADIAL2=\"ViconRadial2 {} {} {} {} {}\"/>\n"
            "  </KeyFrames>\n </Camera>\n",
            camera.name,
            k.fx / k.fy,
            k.width,
            k.height,
            k.skew,
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
            k.distortion[1],
            k.distortion[4]);
    }
    return write_text(output, text + "</Cameras>\n", true);
}

Expected<void> write_colmap(const config::Rig& rig, const fs::path& folder) {
    std::string cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
    std::string images =
        "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, "
        "POINT3D_ID)\n";
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        const CalibratedCamera& camera = rig.cameras[i];
        const geometry::PinholeCamera& k = camera.intrinsics;
        const auto& d = k.distortion;
        const bool has_k3 = d[4] != 0.0;
        cameras += fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}{}\n",
                               i + 1,
                               has_k3 ? "FULL_OPENCV" : "OPENCV",
                               k.width,
                               k.height,
                               k.fx,
                               k.fy,
                               k.cx + 0.5,
                               k.cy + 0.5,
                               d[0],
                               d[1],
                               d[2],
                               d[3],
                               has_k3 ? fmt::format(" {} 0 0 0", d[4]) : "");
        const Eigen::Quaterniond& q = camera.camera_from_site.rotation;
        const Eigen::Vector3d& t = camera.camera_from_site.translation;
        images += fmt::format("{} {} {} {} {} {} {} {} {} {}.png\n\n",
                              i + 1,
                              q.w(),
                              q.x(),
                              q.y(),
                              q.z(),
                              t.x(),
                              t.y(),
                              t.z(),
                              i + 1,
                              camera.name);
    }
    for (const auto& [name, text] : {std::pair{"cameras.txt", cameras},
                                     {"images.txt", images},
                                     {"points3D.txt", std::string("# no points\n")}}) {
        if (auto written = write_text(folder / name, text, true); !written) return written;
    }
    return {};
}

Expected<void> write_kalibr(const config::Rig& rig, const fs::path& output) {
    std::string text;
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        const CalibratedCamera& camera = rig.cameras[i];
        const geometry::PinholeCamera& k = camera.intrinsics;
        text += fmt::format("cam{}:\n", i);
        if (i > 0) {
            const Eigen::Matrix4d step =
                (camera.camera_from_site * rig.cameras[i - 1].camera_from_site.inverse()).matrix();
            text += "  T_cn_cnm1:\n";
            for (int r = 0; r < 4; ++r)
                text += fmt::format(
                    "  - [{}, {}, {}, {}]\n", step(r, 0), step(r, 1), step(r, 2), step(r, 3));
        }
        const auto& d = k.distortion;
        text += fmt::format(
            "  camera_model: pinhole\n  distortion_coeffs: [{}, {}, {}, {}]\n  distortion_model: "
            "radtan\n  intrinsics: [{}, {}, {}, {}]\n  resolution: [{}, {}]\n  rostopic: "
            "/{}/image_raw\n",
            d[0],
            d[1],
            d[2],
            d[3],
            k.fx,
            k.fy,
            k.cx,
            k.cy,
            k.width,
            k.height,
            camera.name);
    }
    return write_text(output, text, true);
}

// Names the cameras for which `is_lost` is true.
void note(const config::Rig& rig,
          const std::string& what,
          const std::function<bool(const geometry::PinholeCamera&)>& is_lost,
          Lost& lost) {
    std::string names;
    for (const CalibratedCamera& camera : rig.cameras)
        if (is_lost(camera.intrinsics)) names += (names.empty() ? "" : ", ") + camera.name;
    if (!names.empty()) lost.push_back(fmt::format("{} of {}", what, names));
}

Lost losses(const config::Rig& rig, Format format) {
    Lost lost{"rate_hz and bounds, which no calibration of another program has"};
    const auto has_skew = [](const geometry::PinholeCamera& k) { return k.skew != 0.0; };
    const auto has_k3 = [](const geometry::PinholeCamera& k) { return k.distortion[4] != 0.0; };
    const auto has_tangential = [](const geometry::PinholeCamera& k) {
        return k.distortion[2] != 0.0 || k.distortion[3] != 0.0;
    };
    if (format == Format::kColmap || format == Format::kKalibr)
        note(rig, "the skew", has_skew, lost);
    if (format == Format::kOpenCv)
        note(rig, "OpenCV's functions ignore the skew, which the file holds,", has_skew, lost);
    if (format == Format::kKalibr) {
        note(rig, "the distortion k3", has_k3, lost);
        lost.push_back("the site's frame: Kalibr's is that of the first camera");
        lost.push_back("the names of the cameras, but for rostopic");
    }
    if (format == Format::kVicon) note(rig, "the distortion p1, p2", has_tangential, lost);
    if (format == Format::kColmap) lost.push_back("that lengths are metres: COLMAP's have no unit");
    return lost;
}

}  // namespace

Expected<std::vector<std::string>> write_foreign(const config::Rig& rig,
                                                 Format format,
                                                 const fs::path& output) {
    const auto write = [&]() -> Expected<void> {
        switch (format) {
            case Format::kOpenCv:
                return write_opencv(rig, output);
            case Format::kQualisys:
                return write_qualisys(rig, output);
            case Format::kVicon:
                return write_vicon(rig, output);
            case Format::kColmap:
                return write_colmap(rig, output);
            case Format::kToml:
                return write_toml(rig, output);
            case Format::kKalibr:
                break;
        }
        return write_kalibr(rig, output);
    };
    if (auto written = write(); !written) return tl::unexpected(written.error());
    return losses(rig, format);
}

}  // namespace atrium::calibrate
