#include "simulation/model_pictures.hpp"

#include "simulation/tga.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>

namespace atrium::simulation {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxTexturePx = 4096;
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{256} << 20U;
constexpr std::size_t kMaxCompanions = 4096;
constexpr std::array kPictureSuffixes{
    ".png", ".jpg", ".jpeg", ".tga", ".bmp", ".tif", ".tiff", ".webp"};

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
    });
    return text;
}

bool is_file(const fs::path& file) {
    std::error_code failure;
    return fs::is_regular_file(file, failure);
}

// Folders are matched in any case: "Textures" as well as "textures".
std::vector<fs::path> picture_folders(const fs::path& model) {
    const fs::path own = model.has_parent_path() ? model.parent_path() : fs::path(".");
    const std::string packed = lower(model.stem().string() + ".fbm");
    std::vector<fs::path> folders{own};
    for (const fs::path& around : {own, own / ".."}) {
        std::error_code failure;
        std::vector<fs::path> found;
        for (fs::directory_iterator it(around, failure), end; !failure && it != end;
             it.increment(failure)) {
            const std::string name = lower(it->path().filename().string());
            const bool is_searched = name == "textures" || name == "texture" || name == "tex" ||
                                     name == "maps" || name == "images" || name == packed;
            std::error_code unknown;
            if (is_searched && it->is_directory(unknown)) found.push_back(it->path());
        }
        std::sort(found.begin(), found.end());
        folders.insert(folders.end(), found.begin(), found.end());
    }
    return folders;
}

template <typename Matches>
std::optional<fs::path> find_in(const std::vector<fs::path>& folders, const Matches& matches) {
    for (const fs::path& folder : folders) {
        std::error_code failure;
        std::optional<fs::path> first;  // whatever the order of the folder
        for (fs::directory_iterator it(folder, failure), end; !failure && it != end;
             it.increment(failure)) {
            if (!matches(it->path()) || !is_file(it->path())) continue;
            if (!first || it->path() < *first) first = it->path();
        }
        if (first) return first;
    }
    return std::nullopt;
}

// `picture` has one to four channels of 8 bits.
ModelTexture to_texture(cv::Mat picture) {
    ModelTexture texture;
    if (picture.empty()) return texture;
    const int longest = std::max(picture.cols, picture.rows);
    if (longest > kMaxTexturePx) {
        const double share = static_cast<double>(kMaxTexturePx) / longest;
        cv::resize(picture, picture, {}, share, share, cv::INTER_AREA);
    }
    constexpr std::array kToRgba{0,
                                 static_cast<int>(cv::COLOR_GRAY2RGBA),
                                 0,
                                 static_cast<int>(cv::COLOR_BGR2RGBA),
                                 static_cast<int>(cv::COLOR_BGRA2RGBA)};
    const auto channels = static_cast<std::size_t>(picture.channels());
    if (channels >= kToRgba.size() || channels == 0 || channels == 2) return texture;
    cv::Mat rgba;
    cv::cvtColor(picture, rgba, kToRgba[channels]);
    texture.width = rgba.cols;
    texture.height = rgba.rows;
    texture.rgba.assign(rgba.data, rgba.data + rgba.total() * 4);
    return texture;
}

}  // namespace

std::optional<fs::path> find_picture(const std::string& path, const fs::path& model) {
    std::string clean = path;
    if (clean.starts_with("file://")) clean.erase(0, 7);
    std::replace(clean.begin(), clean.end(), '\\', '/');
    if (clean.empty()) return std::nullopt;
    for (const fs::path& place : {fs::path(clean), model.parent_path() / clean}) {
        if (is_file(place)) return place;
    }
    const fs::path name = fs::path(clean).filename();
    const std::vector<fs::path> folders = picture_folders(model);
    const std::string wanted = lower(name.string());
    if (auto found = find_in(folders, [&](const fs::path& file) {
            return lower(file.filename().string()) == wanted;
        })) {
        return found;
    }
    const std::string stem = lower(name.stem().string());
    return find_in(folders, [&](const fs::path& file) {
        const std::string suffix = lower(file.extension().string());
        return lower(file.stem().string()) == stem &&
               std::find(kPictureSuffixes.begin(), kPictureSuffixes.end(), suffix) !=
                   kPictureSuffixes.end();
    });
}

ModelTexture decode_picture(std::span<const std::uint8_t> bytes) {
    if (bytes.empty()) return {};
    cv::Mat picture;
    try {
        const cv::Mat file(1,
                           static_cast<int>(bytes.size()),
                           CV_8UC1,
                           const_cast<std::uint8_t*>(bytes.data()));  // only read
        picture = cv::imdecode(file, cv::IMREAD_UNCHANGED);
        if (picture.depth() == CV_16U) picture.convertTo(picture, CV_8U, 1.0 / 257);
        if (!picture.empty() && picture.depth() == CV_8U) return to_texture(picture);
        if (const std::optional<TgaPicture> tga = read_tga(bytes)) {
            const cv::Mat bgra(tga->height,
                               tga->width,
                               CV_8UC4,
                               const_cast<std::uint8_t*>(tga->bgra.data()));  // only read
            return to_texture(bgra);
        }
    } catch (const cv::Exception&) {
        return {};  // damaged
    }
    return {};
}

ModelTexture read_picture(const fs::path& file) {
    std::error_code failure;
    const std::uintmax_t size = fs::file_size(file, failure);
    if (failure || size > kMaxFileBytes) return {};
    std::ifstream stream(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
    return decode_picture({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

std::vector<fs::path> companion_files(const fs::path& model) {
    std::vector<fs::path> files;
    for (const fs::path& folder : picture_folders(model)) {
        std::error_code failure;
        for (fs::directory_iterator it(folder, failure), end;
             !failure && it != end && files.size() < kMaxCompanions;
             it.increment(failure)) {
            const std::string suffix = lower(it->path().extension().string());
            const bool is_companion =
                suffix == ".mtl" || suffix == ".bin" ||
                std::find(kPictureSuffixes.begin(), kPictureSuffixes.end(), suffix) !=
                    kPictureSuffixes.end();
            if (is_companion && is_file(it->path())) files.push_back(it->path());
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace atrium::simulation
