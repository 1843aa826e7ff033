#include "tests/unit/calibrate/foreign_texts.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace atrium::calibrate::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d rotation(const geometry::CalibratedCamera& camera) {
    return camera.camera_from_site.rotation.toRotationMatrix();
}

std::string list(const Matrix3d& m) {
    std::string text;
    for (int i = 0; i < 9; ++i) text += fmt::format("{}{:.17g}", i ? ", " : "", m(i / 3, i % 3));
    return text;
}
std::string list(const Vector3d& v) {
    return fmt::format("{:.17g}, {:.17g}, {:.17g}", v.x(), v.y(), v.z());
}
std::string without_commas(std::string text) {
    std::erase(text, ',');
    return text;
}

Matrix3d matrix(const geometry::PinholeCamera& k) {
    Matrix3d m;
    m << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
    return m;
}

std::string distortion(const geometry::PinholeCamera& k) {
    const auto& d = k.distortion;
    return fmt::format("{:.17g}, {:.17g}, {:.17g}, {:.17g}, {:.17g}", d[0], d[1], d[2], d[3], d[4]);
}

Vector3d rodrigues(const Matrix3d& m) {
    const Eigen::AngleAxisd turn(m);
    return turn.angle() * turn.axis();
}

// The matrix of FileStorage's YAML.
std::string yaml_matrix(const std::string& indent,
                        const std::string& key,
                        int rows,
                        int cols,
                        const std::string& data) {
    return fmt::format(
        "{0}{1}: !!opencv-matrix\n{0}   rows: {2}\n{0}   cols: {3}\n{0}   dt: d\n{0}   data: [ {4} "
        "]\n",
        indent,
        key,
        rows,
        cols,
        data);
}

}  // namespace

Matrix3d level_rotation(const Vector3d& eye, const Vector3d& target) {
    const Vector3d forwards = (target - eye).normalized();
    const Vector3d right = forwards.cross(Vector3d::UnitZ()).normalized();
    Matrix3d r;
    r << right.transpose(), forwards.cross(right).transpose(), forwards.transpose();
    return r;
}

Cameras random_room(atrium::test::Random& random, int num_cameras) {
    using atrium::test::between;
    Cameras cameras;
    const double arc = between(random, 2.6, 2.0 * std::numbers::pi);
    const double first = between(random, 0.0, 2.0 * std::numbers::pi);
    const double radius_m = between(random, 1.6, 5.0);
    for (int i = 0; i < num_cameras; ++i) {
        const double angle = first + arc * i / num_cameras;
        const Vector3d eye(
            radius_m * std::cos(angle), radius_m * std::sin(angle), between(random, 0.5, 3.0));
        const Vector3d target = Vector3d(0, 0, 1) + atrium::test::random_in_cube(random, 0.25);
        const Matrix3d r = Eigen::AngleAxisd(between(random, -0.05, 0.05), Vector3d::UnitZ()) *
                           level_rotation(eye, target);
        geometry::CalibratedCamera camera;
        camera.name = fmt::format("cam{}", i + 1);
        geometry::PinholeCamera& k = camera.intrinsics;
        k.width = 2 * between(random, 320, 960);
        k.height = 2 * between(random, 240, 540);
        k.fx = between(random, 0.8, 1.4) * k.width;
        k.fy = k.fx * between(random, 0.99, 1.01);
        k.cx = 0.5 * k.width + between(random, -15.0, 15.0);
        k.cy = 0.5 * k.height + between(random, -15.0, 15.0);
        k.distortion = {between(random, -0.2, 0.1),
                        between(random, -0.05, 0.05),
                        between(random, -1e-3, 1e-3),
                        between(random, -1e-3, 1e-3),
                        0.0};
        camera.camera_from_site = {Eigen::Quaterniond(r), -(r * eye)};
        cameras.push_back(camera);
    }
    return cameras;
}

Cameras in_frame(Cameras cameras, const Matrix3d& file_from_site) {
    for (auto& camera : cameras) {
        camera.camera_from_site.rotation =
            Eigen::Quaterniond(rotation(camera) * file_from_site.transpose());
    }
    return cameras;
}

std::string opencv_yaml(const Cameras& cameras, double units_per_m) {
    std::string text = "%YAML:1.0\n---\n";
    for (const auto& camera : cameras) {
        const auto& k = camera.intrinsics;
        text += fmt::format(
            "{}:\n   image_width: {}\n   image_height: {}\n", camera.name, k.width, k.height);
        text += yaml_matrix("   ", "camera_matrix", 3, 3, list(matrix(k)));
        text += yaml_matrix("   ", "distortion_coefficients", 1, 5, distortion(k));
        text += yaml_matrix("   ", "R", 3, 3, list(rotation(camera)));
        const Vector3d t = units_per_m * camera.camera_from_site.translation;
        text += yaml_matrix("   ", "T", 3, 1, list(t));
    }
    return text;
}

std::string opencv_xml(const Cameras& cameras) {
    std::string text = "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
    const auto xml = [](const char* key, int rows, int cols, const std::string& data) {
        return fmt::format(
            "<{0} type_id=\"opencv-matrix\"><rows>{1}</rows><cols>{2}</cols><dt>d</dt>"
            "<data>{3}</data></{0}>\n",
            key,
            rows,
            cols,
            without_commas(data));
    };
    for (const auto& camera : cameras) {
        const auto& k = camera.intrinsics;
        text += fmt::format(
            "<{0}>\n<image_width>{1}</image_width>\n<image_height>{2}"
            "</image_height>\n",
            camera.name,
            k.width,
            k.height);
        text += xml("Camera_Matrix", 3, 3, list(matrix(k))) +
                xml("Distortion_Coefficients", 5, 1, distortion(k)) +
                xml("rvec", 3, 1, list(rodrigues(rotation(camera)))) +
                xml("tvec", 3, 1, list(camera.camera_from_site.translation));
        text += fmt::format("</{}>\n", camera.name);
    }
    return text + "</opencv_storage>\n";
}

std::string opencv_json(const Cameras& cameras) {
    std::string text = "{\"cameras\": [";
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto& camera = cameras[i];
        const auto& k = camera.intrinsics;
        text += fmt::format(
            "{}{{\"name\": \"{}\", \"imgSize\": [{}, {}], \"resolution\": [{}, {}], \"K\": "
            "[[{:.17g}, "
            "0, {:.17g}], [0, {:.17g}, {:.17g}], [0, 0, 1]], \"distCoef\": [{}], \"R\": [{}], "
            "\"t\": [[{:.17g}], [{:.17g}], [{:.17g}]]}}",
            i ? ", " : "",
            camera.name,
            k.width,
            k.height,
            k.width,
            k.height,
            k.fx,
            k.cx,
            k.fy,
            k.cy,
            distortion(k),
            list(rotation(camera)),
            camera.camera_from_site.translation.x(),
            camera.camera_from_site.translation.y(),
            camera.camera_from_site.translation.z());
    }
    return text + "]}";
}

std::string easymocap_intri(const Cameras& cameras) {
    std::string text = "%YAML:1.0\n---\nnames:\n";
    for (const auto& camera : cameras) text += fmt::format("  - \"{}\"\n", camera.name);
    for (const auto& camera : cameras) {
        text += yaml_matrix("", "K_" + camera.name, 3, 3, list(matrix(camera.intrinsics)));
        text += yaml_matrix("", "dist_" + camera.name, 1, 5, distortion(camera.intrinsics));
    }
    return text;
}

std::string easymocap_extri(const Cameras& cameras) {
    std::string text = "%YAML:1.0\n---\n";
    for (const auto& camera : cameras) {
        text += yaml_matrix("", "R_" + camera.name, 3, 1, list(rodrigues(rotation(camera))));
        text += yaml_matrix("", "Rot_" + camera.name, 3, 3, list(rotation(camera)));
        text +=
            yaml_matrix("", "T_" + camera.name, 3, 1, list(camera.camera_from_site.translation));
    }
    return text;
}

std::string anipose_toml(const Cameras& cameras, double units_per_m) {
    std::string text;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto& k = cameras[i].intrinsics;
        const Vector3d t = units_per_m * cameras[i].camera_from_site.translation;
        text += fmt::format(
            "[cam_{}]\nname = \"{}\"\nsize = [ {}, {},]\nmatrix = [ [ {:.17g}, 0.0, {:.17g},], [ "
            "0.0, {:.17g}, {:.17g},], [ 0.0, 0.0, 1.0,],]\ndistortions = [ {},]\nrotation = [ "
            "{},]\ntranslation = [ {},]\n\n",
            i,
            cameras[i].name,
            k.width,
            k.height,
            k.fx,
            k.cx,
            k.fy,
            k.cy,
            distortion(k),
            list(rodrigues(rotation(cameras[i]))),
            list(t));
    }
    return text + "[metadata]\nadjusted = true\nerror = 0.5\n";
}

std::string caliscope_toml(const Cameras& cameras) {
    std::string text = "fps_sync_stream_processing = 30\n[charuco]\ncolumns = 4\n";
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto& k = cameras[i].intrinsics;
        text += fmt::format(
            "[cam_{}]\nport = {}\nsize = [{}, {}]\nrotation_count = 0\nerror = 0.4\nmatrix = "
            "[[{:.17g}, 0.0, {:.17g}], [0.0, {:.17g}, {:.17g}], [0.0, 0.0, 1.0]]\ndistortions = "
            "[{}]\nignore = false\nrotation = [{}]\ntranslation = [{}]\n",
            i,
            i,
            k.width,
            k.height,
            k.fx,
            k.cx,
            k.fy,
            k.cy,
            distortion(k),
            list(rodrigues(rotation(cameras[i]))),
            list(cameras[i].camera_from_site.translation));
    }
    return text;
}

std::string kalibr_yaml(const Cameras& cameras) {
    std::string text;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto& k = cameras[i].intrinsics;
        text += fmt::format("cam{}:\n", i);
        if (i > 0) {
            const Matrix3d step = rotation(cameras[i]) * rotation(cameras[i - 1]).transpose();
            const Vector3d t = cameras[i].camera_from_site.translation -
                               step * cameras[i - 1].camera_from_site.translation;
            text += "  T_cn_cnm1:\n";
            for (int row = 0; row < 3; ++row)
                text += fmt::format("  - [{}, {:.17g}]\n", list(Vector3d(step.row(row))), t[row]);
            text += "  - [0.0, 0.0, 0.0, 1.0]\n";
        }
        const auto& d = k.distortion;
        text += fmt::format(
            "  cam_overlaps: []\n  camera_model: pinhole\n  distortion_coeffs: [{:.17g}, {:.17g}, "
            "{:.17g},\n    {:.17g}]\n  distortion_model: radtan\n  intrinsics: [{:.17g}, {:.17g}, "
            "{:.17g}, {:.17g}]\n  resolution: [{}, {}]\n  rostopic: /{}/image_raw\n",
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
            cameras[i].name);
    }
    return text;
}

Folder::Folder() {
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = fmt::format("{}.{}", test->test_suite_name(), test->name());
    for (char& c : name)
        if (c == '/') c = '_';
    path_ = std::filesystem::path(testing::TempDir()) /
            fmt::format("atrium_calibrate_{}", getpid()) / name;
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
}

Folder::~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path Folder::write(const std::string& name, const std::string& text) const {
    const auto file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
}

double difference(std::span<const geometry::CalibratedCamera> a,
                  std::span<const geometry::CalibratedCamera> b) {
    if (a.size() != b.size()) return 1e9;
    double worst = 0.0;
    const auto compare = [&](double x, double y) { worst = std::max(worst, std::abs(x - y)); };
    for (std::size_t i = 0; i < a.size(); ++i) {
        const auto& k = a[i].intrinsics;
        const auto& l = b[i].intrinsics;
        for (const auto& [x, y] : {std::pair{k.fx, l.fx},
                                   {k.fy, l.fy},
                                   {k.cx, l.cx},
                                   {k.cy, l.cy},
                                   {k.skew, l.skew},
                                   {1.0 * k.width, 1.0 * l.width},
                                   {1.0 * k.height, 1.0 * l.height}})
            compare(x, y);
        for (std::size_t c = 0; c < 5; ++c) compare(k.distortion[c], l.distortion[c]);
        worst = std::max(worst, (rotation(a[i]) - rotation(b[i])).cwiseAbs().maxCoeff());
        worst = std::max(
            worst, (a[i].camera_from_site.translation - b[i].camera_from_site.translation).norm());
    }
    return worst;
}

}  // namespace atrium::calibrate::test
