#include "core/base/fnv1a.hpp"
#include "core/bus/checks.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "world_server/state_file.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <string_view>

// Header of 28 bytes: magic (8), version (4), length of the rest (8), FNV-1a hash of the rest (8).
// The rest: description, tick, next id, then three lists, each preceded by its length: objects,
// soft objects, added objects. Since version 2 also edited objects and the name of the loaded
// world, since version 3 the hash of the world file. All numbers are little endian, IEEE 754.
namespace atrium::world_server {
namespace {

constexpr std::string_view kMagic = "ATRIUMWS";
constexpr std::uint32_t kVersion = 3;
constexpr std::uint32_t kFirstVersion = 1;  // the last without edited objects and loaded world
constexpr std::size_t kHeaderBytes = 28;
constexpr std::size_t kMaxObjects = bus::kMaxObjects;

class ByteWriter {
public:
    template <typename Integer>
    void integer(Integer value) {
        for (std::size_t i = 0; i < sizeof(Integer); ++i) {
            bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
        }
    }
    void number(float value) { integer(std::bit_cast<std::uint32_t>(value)); }
    void number(double value) { integer(std::bit_cast<std::uint64_t>(value)); }
    template <typename Matrix>
    void numbers(const Matrix& matrix) {
        for (Eigen::Index i = 0; i < matrix.size(); ++i) number(matrix.data()[i]);
    }
    void text(const std::string& value) {
        integer(static_cast<std::uint32_t>(value.size()));
        bytes.insert(bytes.end(), value.begin(), value.end());
    }

    std::vector<std::uint8_t> bytes;
};

// Reads zeros beyond the end and records this as a failure.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    template <typename Integer>
    Integer integer() {
        const auto bytes = take(sizeof(Integer));
        Integer value = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            value |= static_cast<Integer>(static_cast<Integer>(bytes[i]) << (8 * i));
        }
        return value;
    }
    void number(float& value) { value = std::bit_cast<float>(integer<std::uint32_t>()); }
    void number(double& value) { value = std::bit_cast<double>(integer<std::uint64_t>()); }
    template <typename Matrix>
    void numbers(Matrix&& matrix) {
        for (Eigen::Index i = 0; i < matrix.size(); ++i) number(matrix.data()[i]);
    }
    std::string text(std::size_t max) {
        const auto size = integer<std::uint32_t>();
        if (size > max) return fail();
        const auto bytes = take(size);
        return {bytes.begin(), bytes.end()};
    }
    /// Reads the length of a list. Fails if it exceeds `max`, or if the rest is too short for
    /// elements of `element_bytes` or more.
    std::size_t count(std::size_t max, std::size_t element_bytes) {
        const auto count = integer<std::uint32_t>();
        if (count > max || count * element_bytes > bytes_.size()) {
            fail();
            return 0;
        }
        return count;
    }
    bool is_at_end() const { return is_good_ && bytes_.empty(); }
    bool is_good() const { return is_good_; }

private:
    std::span<const std::uint8_t> take(std::size_t size) {
        if (size > bytes_.size()) {
            fail();
            return {};
        }
        const auto taken = bytes_.first(size);
        bytes_ = bytes_.subspan(size);
        return taken;
    }
    std::string fail() {
        is_good_ = false;
        bytes_ = {};
        return {};
    }

    std::span<const std::uint8_t> bytes_;
    bool is_good_ = true;
};

void put(const physics::ObjectMotion& motion, ByteWriter& out) {
    out.integer(motion.id);
    out.integer(static_cast<std::uint32_t>(motion.activation));
    out.number(motion.idle_s);
    out.numbers(motion.position_m);
    out.numbers(motion.rotation);
    out.numbers(motion.linear_velocity);
    out.numbers(motion.angular_velocity);
}
constexpr std::size_t kMotionBytes = 21 * 4;

physics::ObjectMotion get_motion(ByteReader& in) {
    physics::ObjectMotion motion;
    motion.id = in.integer<std::uint32_t>();
    motion.activation = static_cast<std::int32_t>(in.integer<std::uint32_t>());
    in.number(motion.idle_s);
    in.numbers(motion.position_m);
    in.numbers(motion.rotation);
    in.numbers(motion.linear_velocity);
    in.numbers(motion.angular_velocity);
    return motion;
}

void put(const physics::SoftState& motion, ByteWriter& out) {
    out.integer(motion.id);
    out.integer(static_cast<std::uint32_t>(motion.num_torn_ticks));
    out.integer(static_cast<std::uint32_t>(motion.positions.size()));
    for (std::size_t i = 0; i < motion.positions.size(); ++i) {
        out.numbers(motion.positions[i]);
        out.numbers(motion.velocities[i]);
    }
}

physics::SoftState get_soft_state(ByteReader& in) {
    physics::SoftState motion;
    motion.id = in.integer<std::uint32_t>();
    motion.num_torn_ticks = static_cast<std::int32_t>(in.integer<std::uint32_t>());
    const std::size_t num_nodes = in.count(bus::kMaxSoftNodes, 24);
    motion.positions.resize(num_nodes);
    motion.velocities.resize(num_nodes);
    for (std::size_t i = 0; i < num_nodes; ++i) {
        in.numbers(motion.positions[i]);
        in.numbers(motion.velocities[i]);
    }
    return motion;
}

void put(const bus::SceneObject& object, ByteWriter& out) {
    out.integer(object.object);
    out.text(object.name);
    out.integer(static_cast<std::uint8_t>(object.shape));
    out.numbers(object.size_m);
    for (const double value : {object.mass_kg, object.friction, object.restitution}) {
        out.number(value);
    }
    out.numbers(object.colour);
    out.text(object.model);
    out.number(object.model_scale);
    out.text(object.texture);
    out.numbers(object.world_from_object.rotation.coeffs());
    out.numbers(object.world_from_object.translation);
}
constexpr std::size_t kAddedBytes = 4 + 4 + 1 + 24 + 24 + 24 + 4 + 8 + 4 + 56;  // without strings

bus::SceneObject get_object(ByteReader& in) {
    bus::SceneObject object;
    object.object = in.integer<std::uint32_t>();
    object.name = in.text(bus::kMaxNameLength);
    object.shape = static_cast<bus::Shape>(in.integer<std::uint8_t>());
    in.numbers(object.size_m);
    for (double* value : {&object.mass_kg, &object.friction, &object.restitution}) {
        in.number(*value);
    }
    in.numbers(object.colour);
    object.model = in.text(bus::kMaxModelFileLength);
    in.number(object.model_scale);
    object.texture = in.text(bus::kMaxModelFileLength);
    in.numbers(object.world_from_object.rotation.coeffs());
    in.numbers(object.world_from_object.translation);
    return object;
}

tl::unexpected<Error> wrong(std::string why) {
    return make_error(ErrorKind::kInvalidData, "world state: " + std::move(why));
}

Expected<void> check(const SavedWorld& world) {
    std::uint32_t last_id = 0;
    for (const auto& motion : world.state.objects) {
        if (motion.id <= last_id) return wrong("object ids are not ascending");
        if (!physics::is_valid(motion)) {
            return wrong(fmt::format("object {}: a number is out of range", motion.id));
        }
        last_id = motion.id;
    }
    for (const auto& motion : world.state.soft) {
        if (!physics::is_valid(motion)) {
            return wrong(fmt::format("soft object {}: a number is out of range", motion.id));
        }
    }
    for (const auto* objects : {&world.added, &world.edited}) {
        for (const auto& object : *objects) {
            if (const auto valid = bus::check(object); !valid) return wrong(valid.error().message);
        }
    }
    if (!world.loaded.empty() && !bus::is_valid_name(world.loaded))
        return wrong("the name of its world is not valid");
    return {};
}

}  // namespace

std::vector<std::uint8_t> encode(const SavedWorld& world) {
    ByteWriter body;
    body.integer(world.description);
    body.integer(world.state.tick);
    body.integer(world.next_id);
    const auto put_list = [&](const auto& elements) {
        body.integer(static_cast<std::uint32_t>(elements.size()));
        for (const auto& element : elements) put(element, body);
    };
    put_list(world.state.objects);
    put_list(world.state.soft);
    put_list(world.added);
    put_list(world.edited);
    body.text(world.loaded);
    body.integer(world.world_file);

    ByteWriter out;
    out.bytes.assign(kMagic.begin(), kMagic.end());
    out.integer(kVersion);
    out.integer(static_cast<std::uint64_t>(body.bytes.size()));
    out.integer(fnv1a<std::uint8_t>(body.bytes));
    out.bytes.insert(out.bytes.end(), body.bytes.begin(), body.bytes.end());
    return std::move(out.bytes);
}

Expected<SavedWorld> decode(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < kHeaderBytes ||
        std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) {
        return wrong("not a state file");
    }
    ByteReader header(bytes.subspan(kMagic.size(), kHeaderBytes - kMagic.size()));
    const auto version = header.integer<std::uint32_t>();
    if (version < kFirstVersion || version > kVersion) {
        return wrong(fmt::format("has version {}, this program supports {}", version, kVersion));
    }
    const auto size = header.integer<std::uint64_t>();
    const auto body = bytes.subspan(kHeaderBytes);
    if (size != body.size()) {
        return wrong(fmt::format("has {} bytes, expected {}", body.size(), size));
    }
    if (header.integer<std::uint64_t>() != fnv1a<std::uint8_t>(body)) {
        return wrong("checksum mismatch, the file is damaged");
    }

    ByteReader in(body);
    SavedWorld world;
    world.description = in.integer<std::uint64_t>();
    world.state.tick = in.integer<std::uint64_t>();
    world.next_id = in.integer<std::uint32_t>();
    for (std::size_t n = in.count(kMaxObjects, kMotionBytes); n > 0 && in.is_good(); --n) {
        world.state.objects.push_back(get_motion(in));
    }
    for (std::size_t n = in.count(kMaxObjects, 12); n > 0 && in.is_good(); --n) {
        world.state.soft.push_back(get_soft_state(in));
    }
    for (std::size_t n = in.count(kMaxObjects, kAddedBytes); n > 0 && in.is_good(); --n) {
        world.added.push_back(get_object(in));
    }
    const bool has_edited = version > kFirstVersion;
    for (std::size_t n = has_edited ? in.count(kMaxObjects, kAddedBytes) : 0; n > 0 && in.is_good();
         --n) {
        world.edited.push_back(get_object(in));
    }
    if (has_edited) world.loaded = in.text(bus::kMaxNameLength);
    if (version >= 3) world.world_file = in.integer<std::uint64_t>();
    if (!in.is_at_end()) return wrong("its parts do not match its length");
    if (const auto valid = check(world); !valid) return tl::unexpected(valid.error());
    return world;
}

}  // namespace atrium::world_server
