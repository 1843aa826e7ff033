#include "simulation/loop_cache.hpp"

#include "simulation/mapped_file.hpp"
#include "simulation/model_pictures.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

namespace atrium::simulation {
namespace {

namespace fs = std::filesystem;

// Version 3. Increase it whenever the same options give other pictures: after changes of body,
// paint, room, light, noise or layout.
constexpr std::array<char, 16> kMagic = {
    'a', 't', 'r', 'i', 'u', 'm', ' ', 'l', 'o', 'o', 'p', ' ', '0', '0', '0', '3'};
constexpr const char* kSuffix = ".atriumloop";

// Checksum and key: four lanes of multiply and rotate over 8-byte words. Detects accidents, not
// forgeries.
class Hash {
public:
    void add(std::span<const std::uint8_t> bytes) {
        std::size_t i = 0;
        for (; i + 32 <= bytes.size(); i += 32) {
            std::array<std::uint64_t, 4> words;
            std::memcpy(words.data(), bytes.data() + i, 32);
            for (std::size_t lane = 0; lane < 4; ++lane) step(lanes_[lane], words[lane]);
        }
        for (; i < bytes.size(); ++i) step(lanes_[i % 4], bytes[i] + 1u);
        step(lanes_[0], bytes.size());
    }
    void add(double value) { add_word(std::bit_cast<std::uint64_t>(value)); }
    void add_word(std::uint64_t value) {
        step(lanes_[value % 4], value);
        step(lanes_[0], value);
    }
    void add(const std::string& text) {
        add(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    }
    std::uint64_t value() const {
        std::uint64_t sum = 0;
        for (std::size_t lane = 0; lane < 4; ++lane) step(sum, lanes_[lane] ^ (lanes_[lane] >> 29));
        return sum;
    }

private:
    static void step(std::uint64_t& lane, std::uint64_t word) {
        lane = std::rotl((lane ^ word) * 0x9e3779b97f4a7c15ull, 27) + 0x165667b19e3779f9ull;
    }
    std::array<std::uint64_t, 4> lanes_ = {1, 2, 3, 4};
};

// Returns the content of a file; empty if it cannot be read, which the renderer reports.
std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
}

// Identifies the model: its bytes and those of its motion, and which pictures and materials are
// beside it, with size and time. A texture that is added later thus renders the room again.
void add_model(const RoomOptions& options, Hash& hash) {
    hash.add(options.model.filename().string());
    hash.add(bytes_of(options.model));
    hash.add(options.motion_file.empty() ? std::string() : bytes_of(options.motion_file));
    for (const fs::path& file : companion_files(options.model)) {
        std::error_code failure;
        hash.add(file.filename().string());
        hash.add_word(fs::file_size(file, failure));
        hash.add_word(static_cast<std::uint64_t>(
            fs::last_write_time(file, failure).time_since_epoch().count()));
    }
    for (const double v : {options.model_height_m, options.model_turn_rad}) hash.add(v);
}

std::uint64_t key_of(std::span<const geometry::CalibratedCamera> cameras,
                     const RoomOptions& options) {
    Hash hash;
    hash.add(std::string(kMagic.data(), kMagic.size()));
    // rooms of one person keep the files that older versions wrote
    if (options.num_people > 1) hash.add_word(static_cast<std::uint64_t>(options.num_people));
    hash.add(options.look);
    hash.add(options.motion);
    if (!options.model.empty()) add_model(options, hash);
    for (const double v : {options.loop_s, options.rate_hz, options.noise_lsb, options.heading_rad})
        hash.add(v);
    for (const double v : options.position_m) hash.add(v);
    hash.add_word(options.seed);
    hash.add_word(static_cast<std::uint64_t>(options.num_empty_frames));
    for (const geometry::CalibratedCamera& camera : cameras) {
        const geometry::PinholeCamera& c = camera.intrinsics;
        hash.add_word(static_cast<std::uint64_t>(c.width));
        hash.add_word(static_cast<std::uint64_t>(c.height));
        for (const double v : {c.fx, c.fy, c.cx, c.cy, c.skew}) hash.add(v);
        for (const double v : c.distortion) hash.add(v);
        for (const double v : camera.camera_from_site.rotation.coeffs()) hash.add(v);
        for (const double v : camera.camera_from_site.translation) hash.add(v);
    }
    return hash.value();
}

struct Header {
    std::array<char, 16> magic = kMagic;
    std::uint64_t key = 0;
    std::uint64_t num_picture_bytes = 0;
};
static_assert(sizeof(Header) == 32);

std::size_t picture_bytes(const geometry::CalibratedCamera& camera) {
    return static_cast<std::size_t>(camera.intrinsics.width) *
           static_cast<std::size_t>(camera.intrinsics.height) * 3 / 2;
}

// Layout: header; the empty room, per camera; all cameras, per instant; checksum of the pictures.
// Planes Y, U, V.
std::size_t all_picture_bytes(std::span<const geometry::CalibratedCamera> cameras,
                              const RoomOptions& options) {
    std::size_t per_instant = 0;
    for (const geometry::CalibratedCamera& camera : cameras) per_instant += picture_bytes(camera);
    return per_instant * static_cast<std::size_t>(options.num_empty_frames + options.num_frames());
}

// The bytes of a file, mapped or read.
struct FileBytes {
    std::span<const std::uint8_t> bytes;
    std::shared_ptr<const void> owner;
    std::shared_ptr<const MappedFile> mapping;  // null: the bytes are in memory
};

Expected<FileBytes> bytes_of_cache(const fs::path& file) {
    auto mapped = MappedFile::open(file);
    if (mapped) return FileBytes{(*mapped)->bytes(), *mapped, *mapped};
    if (mapped.error().kind == ErrorKind::kNotFound) return tl::unexpected(mapped.error());
    std::error_code error;
    const auto size = fs::file_size(file, error);
    if (error) return make_error(ErrorKind::kNotFound, file.string() + ": " + error.message());
    auto memory = std::make_shared<std::vector<std::uint8_t>>(size);
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(memory->data()), static_cast<std::streamsize>(size));
    if (!stream) return make_error(ErrorKind::kUnavailable, file.string() + ": cannot be read");
    return FileBytes{*memory, memory, nullptr};
}

// Hands out pictures one after the other.
class PictureReader {
public:
    PictureReader(const FileBytes& file, std::size_t first_byte) : file_(file), at_(first_byte) {}

    Picture next(const geometry::CalibratedCamera& camera) {
        Picture picture;
        picture.width = camera.intrinsics.width;
        picture.height = camera.intrinsics.height;
        const auto width = static_cast<std::size_t>(picture.width);
        const auto height = static_cast<std::size_t>(picture.height);
        picture.planes[0] = next_plane(width, height);
        picture.planes[1] = next_plane(width / 2, height / 2);
        picture.planes[2] = next_plane(width / 2, height / 2);
        picture.owner = file_.owner;
        return picture;
    }

    std::uint64_t hash() const { return hash_.value(); }

private:
    image::RawImage::RawPlane next_plane(std::size_t width, std::size_t height) {
        const auto bytes = file_.bytes.subspan(at_, width * height);
        hash_.add(bytes);
        at_ += bytes.size();
        return {bytes.data(), width};
    }

    const FileBytes& file_;
    std::size_t at_;
    Hash hash_;
};

void write_picture(std::ostream& stream, const Picture& picture, Hash& hash) {
    const image::YuvView view = view_of(picture);
    for (const image::PlaneView* plane : {&view.y, &view.u, &view.v}) {
        // neither rendered planes nor those of a file have padding
        const std::span bytes(
            plane->data,
            static_cast<std::size_t>(plane->width) * static_cast<std::size_t>(plane->height));
        stream.write(reinterpret_cast<const char*>(bytes.data()),
                     static_cast<std::streamsize>(bytes.size()));
        hash.add(bytes);
    }
}

void remove_oldest(const fs::path& directory) {
    std::vector<std::pair<fs::file_time_type, fs::path>> files;
    std::error_code error;
    for (fs::directory_iterator it(directory, error), end; !error && it != end;
         it.increment(error)) {
        if (it->path().extension() != kSuffix) continue;
        const fs::file_time_type time = it->last_write_time(error);
        if (!error) files.emplace_back(time, it->path());
    }
    std::sort(files.begin(), files.end());
    for (std::size_t i = 0; i + kMaxCachedLoops < files.size(); ++i)
        fs::remove(files[i].second, error);
}

}  // namespace

fs::path cache_file(std::span<const geometry::CalibratedCamera> cameras,
                    const RoomOptions& options,
                    const fs::path& cache_directory) {
    std::array<char, 17> hex{};
    std::snprintf(hex.data(),
                  hex.size(),
                  "%016llx",
                  static_cast<unsigned long long>(key_of(cameras, options)));
    return cache_directory / (std::string(hex.data()) + kSuffix);
}

Expected<SimulatedLoop> read_cached_loop(const fs::path& file,
                                         std::span<const geometry::CalibratedCamera> cameras,
                                         const RoomOptions& options) {
    const std::size_t num_bytes = all_picture_bytes(cameras, options);
    const auto damaged = [&] {
        return make_error(ErrorKind::kInvalidData, file.string() + ": not a loop of this room");
    };
    const auto content = bytes_of_cache(file);
    if (!content) return tl::unexpected(content.error());
    const std::span<const std::uint8_t> bytes = content->bytes;
    std::uint64_t checksum = 0;
    if (bytes.size() != sizeof(Header) + num_bytes + sizeof(checksum)) return damaged();
    Header header;
    std::memcpy(&header, bytes.data(), sizeof(header));
    if (header.magic != kMagic || header.key != key_of(cameras, options) ||
        header.num_picture_bytes != num_bytes) {
        return damaged();
    }
    PictureReader reader(*content, sizeof(header));
    SimulatedLoop loop;
    loop.file = content->mapping;
    loop.empty_room.resize(cameras.size());
    for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
        for (int shot = 0; shot < options.num_empty_frames; ++shot)
            loop.empty_room[camera].push_back(reader.next(cameras[camera]));
    }
    loop.frames.resize(static_cast<std::size_t>(options.num_frames()));
    for (auto& instant : loop.frames) {
        for (const geometry::CalibratedCamera& camera : cameras)
            instant.push_back(reader.next(camera));
    }
    std::memcpy(&checksum, bytes.data() + sizeof(header) + num_bytes, sizeof(checksum));
    if (checksum != reader.hash()) return damaged();
    return loop;
}

Expected<void> write_cached_loop(const fs::path& file,
                                 std::span<const geometry::CalibratedCamera> cameras,
                                 const RoomOptions& options,
                                 const SimulatedLoop& loop) {
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error)
        return make_error(ErrorKind::kUnavailable,
                          file.parent_path().string() + ": " + error.message());
    // two sites may write the same loop at once: each writes its own file, and the last rename wins
    const fs::path partial = file.string() + "." + std::to_string(::getpid()) + "." +
                             std::to_string(reinterpret_cast<std::uintptr_t>(&loop)) + ".partial";
    std::ofstream stream(partial, std::ios::binary | std::ios::trunc);
    Header header;
    header.key = key_of(cameras, options);
    header.num_picture_bytes = all_picture_bytes(cameras, options);
    stream.write(reinterpret_cast<const char*>(&header), sizeof(header));
    Hash hash;
    for (const auto& shots : loop.empty_room) {
        for (const Picture& picture : shots) write_picture(stream, picture, hash);
    }
    for (const auto& instant : loop.frames) {
        for (const Picture& picture : instant) write_picture(stream, picture, hash);
    }
    const std::uint64_t checksum = hash.value();
    stream.write(reinterpret_cast<const char*>(&checksum), sizeof(checksum));
    stream.close();
    if (stream) fs::rename(partial, file, error);
    if (!stream || error) {
        std::error_code ignored;
        fs::remove(partial, ignored);
        return make_error(ErrorKind::kUnavailable, file.string() + ": cannot be written");
    }
    remove_oldest(file.parent_path());
    return {};
}

}  // namespace atrium::simulation
