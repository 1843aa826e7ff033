// cameras.txt: ID MODEL WIDTH HEIGHT PARAMS...; images.txt: two lines per image, ID QW QX QY QZ TX
// TY TZ CAMERA_ID NAME, and its points, which are skipped.
#include "tools/calibrate/formats/colmap_model.hpp"
#include "tools/calibrate/formats/data_tree.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace atrium::calibrate {
namespace {

tl::unexpected<Error> wrong_line(const std::filesystem::path& file,
                                 std::size_t line,
                                 const std::string& what) {
    return make_error(ErrorKind::kInvalidData, fmt::format("{}:{}: {}", file.string(), line, what));
}

bool is_comment(const std::string& line) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    return first != std::string::npos && line[first] == '#';
}

bool is_blank(const std::string& line) {
    return line.find_first_not_of(" \t\r") == std::string::npos;
}

Expected<void> read_cameras(const std::filesystem::path& file, ColmapModel& model) {
    std::ifstream stream(file);
    std::size_t number = 0;
    for (std::string line; std::getline(stream, line);) {
        ++number;
        if (is_comment(line) || is_blank(line)) continue;
        std::istringstream words(line);
        std::int64_t id = 0;
        ColmapCamera camera;
        if (!(words >> id >> camera.model >> camera.width >> camera.height))
            return wrong_line(file, number, "expected: CAMERA_ID MODEL WIDTH HEIGHT PARAMS");
        for (double value = 0.0; words >> value && camera.parameters.size() < 32;)
            camera.parameters.push_back(value);
        if (const std::string word = decimal_comma(line); !word.empty())
            return wrong_line(file, number, comma_is_no_point(word));
        words.clear();
        if (std::string word; camera.parameters.size() < 32 && words >> word) {
            return wrong_line(file,
                              number,
                              fmt::format("'{}' is not a number; copy or export the model again",
                                          word.substr(0, 40)));
        }
        model.cameras[id] = std::move(camera);
        if (model.cameras.size() > kMaxColmapImages)
            return wrong_line(file, number, "too many cameras");
    }
    return {};
}

}  // namespace

Expected<void> read_colmap_text(const std::filesystem::path& cameras,
                                const std::filesystem::path& images,
                                ColmapModel& model) {
    if (auto read = read_cameras(cameras, model); !read) return read;
    std::ifstream stream(images);
    std::size_t number = 0;
    for (std::string line; std::getline(stream, line);) {
        ++number;
        if (is_comment(line) || is_blank(line)) continue;
        std::istringstream words(line);
        std::int64_t id = 0;
        ColmapImage image;
        Eigen::Quaterniond& q = image.rotation;
        Eigen::Vector3d& t = image.translation;
        if (!(words >> id >> q.w() >> q.x() >> q.y() >> q.z() >> t.x() >> t.y() >> t.z() >>
              image.camera >> std::ws) ||
            !std::getline(words, image.name)) {
            const std::string word = decimal_comma(line);
            if (!word.empty()) return wrong_line(images, number, comma_is_no_point(word));
            return wrong_line(
                images, number, "expected: IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
        }
        while (!image.name.empty() && (image.name.back() == '\r' || image.name.back() == ' '))
            image.name.pop_back();
        model.images.push_back(std::move(image));
        if (model.images.size() > kMaxColmapImages)
            return wrong_line(images, number, "too many images for the cameras of a room");
        std::getline(stream, line);  // the points, also if there are none
        ++number;
    }
    return {};
}

}  // namespace atrium::calibrate
