// cameras.bin and images.bin, little-endian, with 64-bit counts.
#include "tools/calibrate/formats/colmap_model.hpp"
#include "tools/calibrate/formats/data_tree.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <string_view>

namespace atrium::calibrate {
namespace {

static_assert(std::endian::native == std::endian::little);

// Reads values one after the other; `failed` once the bytes end too early.
class Bytes {
public:
    explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

    template <typename T>
    T read() {
        T value{};
        if (bytes_.size() < sizeof(T)) {
            failed_ = true;
        } else {
            std::memcpy(&value, bytes_.data(), sizeof(T));
            bytes_.remove_prefix(sizeof(T));
        }
        return value;
    }
    std::string read_name() {
        const std::size_t end = bytes_.substr(0, 4096).find('\0');
        if (end == std::string_view::npos) {
            failed_ = true;
            return "";
        }
        std::string name(bytes_.substr(0, end));
        bytes_.remove_prefix(end + 1);
        return name;
    }
    void skip(std::uint64_t count, std::size_t size) {
        if (count > bytes_.size() / size) {
            failed_ = true;
        } else {
            bytes_.remove_prefix(static_cast<std::size_t>(count) * size);
        }
    }
    bool failed() const { return failed_; }

private:
    std::string_view bytes_;
    bool failed_ = false;
};

struct Model {
    const char* name;
    std::size_t num_parameters;
};
// In the order of COLMAP's numbers.
constexpr std::array<Model, 11> kModels{{{"SIMPLE_PINHOLE", 3},
                                         {"PINHOLE", 4},
                                         {"SIMPLE_RADIAL", 4},
                                         {"RADIAL", 5},
                                         {"OPENCV", 8},
                                         {"OPENCV_FISHEYE", 8},
                                         {"FULL_OPENCV", 12},
                                         {"FOV", 5},
                                         {"SIMPLE_RADIAL_FISHEYE", 4},
                                         {"RADIAL_FISHEYE", 5},
                                         {"THIN_PRISM_FISHEYE", 12}}};

tl::unexpected<Error> cut_off(const std::filesystem::path& file) {
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format("{}: cut off, or not a binary model of COLMAP; copy it again, or convert it "
                    "with `colmap model_converter --output_type TXT`",
                    file.string()));
}

Expected<void> read_cameras_bin(const std::filesystem::path& file, ColmapModel& model) {
    const auto text = read_bytes(file, kMaxColmapBytes);
    if (!text) return tl::unexpected(text.error());
    Bytes bytes(*text);
    const auto count = bytes.read<std::uint64_t>();
    if (count > kMaxColmapImages) return cut_off(file);
    for (std::uint64_t i = 0; i < count && !bytes.failed(); ++i) {
        const auto id = bytes.read<std::uint32_t>();
        const auto kind = bytes.read<std::int32_t>();
        ColmapCamera camera;
        camera.width = static_cast<double>(bytes.read<std::uint64_t>());
        camera.height = static_cast<double>(bytes.read<std::uint64_t>());
        if (kind < 0 || static_cast<std::size_t>(kind) >= kModels.size()) {
            if (bytes.failed()) break;
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("{}: camera model number {} is not supported; run COLMAP with "
                            "--ImageReader.camera_model OPENCV",
                            file.string(),
                            kind));
        }
        const Model& known = kModels[static_cast<std::size_t>(kind)];
        camera.model = known.name;
        for (std::size_t k = 0; k < known.num_parameters; ++k)
            camera.parameters.push_back(bytes.read<double>());
        model.cameras[id] = std::move(camera);
    }
    if (bytes.failed()) return cut_off(file);
    return {};
}

}  // namespace

Expected<void> read_colmap_binary(const std::filesystem::path& cameras,
                                  const std::filesystem::path& images,
                                  ColmapModel& model) {
    if (auto read = read_cameras_bin(cameras, model); !read) return read;
    const auto text = read_bytes(images, kMaxColmapBytes);
    if (!text) return tl::unexpected(text.error());
    Bytes bytes(*text);
    const auto count = bytes.read<std::uint64_t>();
    if (count > kMaxColmapImages) return cut_off(images);
    for (std::uint64_t i = 0; i < count && !bytes.failed(); ++i) {
        ColmapImage image;
        bytes.read<std::uint32_t>();  // its number
        image.rotation.w() = bytes.read<double>();
        image.rotation.x() = bytes.read<double>();
        image.rotation.y() = bytes.read<double>();
        image.rotation.z() = bytes.read<double>();
        for (int c = 0; c < 3; ++c) image.translation[c] = bytes.read<double>();
        image.camera = bytes.read<std::uint32_t>();
        image.name = bytes.read_name();
        bytes.skip(bytes.read<std::uint64_t>(), 24);  // its points
        model.images.push_back(std::move(image));
    }
    if (bytes.failed()) return cut_off(images);
    return {};
}

}  // namespace atrium::calibrate
