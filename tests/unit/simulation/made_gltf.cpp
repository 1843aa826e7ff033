#include "tests/unit/simulation/made_person.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <numbers>
#include <sstream>

// Writes made people as glTF 2 and BVH.
namespace atrium::simulation::made {
namespace {

using Eigen::Vector3d;

std::string base64(const std::string& bytes) {
    constexpr const char* kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word =
                word << 8U | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63U];
    }
    return text;
}

// Collects accessors of one buffer.
class Buffer {
public:
    template <typename Value>
    int add(const std::vector<Value>& values,
            int component_type,
            const std::string& type,
            std::size_t per_item,
            const std::string& extra = "") {
        const std::size_t begin = bytes_.size();
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        const std::string comma = num_ == 0 ? "" : ",";
        views_ << comma << "{\"buffer\":0,\"byteOffset\":" << begin
               << ",\"byteLength\":" << values.size() * sizeof(Value) << "}";
        accessors_ << comma << "{\"bufferView\":" << num_ << ",\"componentType\":" << component_type
                   << ",\"count\":" << values.size() / per_item << ",\"type\":\"" << type << "\""
                   << extra << "}";
        return num_++;
    }
    int floats(const std::vector<float>& values, const std::string& type, std::size_t per_item) {
        return add(values, 5126, type, per_item);
    }
    std::string json() const {
        return "\"accessors\":[" + accessors_.str() + "],\"bufferViews\":[" + views_.str() +
               "],\"buffers\":[{\"byteLength\":" + std::to_string(bytes_.size()) +
               ",\"uri\":\"data:application/octet-stream;base64," + base64(bytes_) + "\"}]";
    }

private:
    std::string bytes_;
    std::ostringstream views_, accessors_;
    int num_ = 0;
};

std::vector<float> flat(const std::vector<Vector3d>& points, double scale) {
    std::vector<float> values;
    for (const Vector3d& p : points) {
        for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(scale * p[k]));
    }
    return values;
}

std::string mesh_json(const Body& body, const PersonOptions& options, Buffer& buffer) {
    std::vector<float> places;
    std::vector<std::uint8_t> joints;
    std::vector<float> weights;
    for (std::size_t v = 0; v < body.positions.size(); ++v) {
        for (int k = 0; k < 2; ++k) places.push_back(static_cast<float>(body.texture_places[v][k]));
        joints.insert(joints.end(), {static_cast<std::uint8_t>(body.joint[v]), 0, 0, 0});
        weights.insert(weights.end(), {1.0f, 0.0f, 0.0f, 0.0f});
    }
    std::vector<std::uint32_t> indices;
    for (const auto& triangle : body.triangles) {
        for (const int index : triangle) indices.push_back(static_cast<std::uint32_t>(index));
    }
    std::ostringstream out;
    out << "{\"primitives\":[{\"attributes\":{\"POSITION\":"
        << buffer.floats(flat(body.positions, options.units_per_m), "VEC3", 3)
        << ",\"NORMAL\":" << buffer.floats(flat(body.normals, 1.0), "VEC3", 3)
        << ",\"TEXCOORD_0\":" << buffer.floats(places, "VEC2", 2);
    if (options.has_skin) {
        out << ",\"JOINTS_0\":" << buffer.add(joints, 5121, "VEC4", 4)
            << ",\"WEIGHTS_0\":" << buffer.floats(weights, "VEC4", 4);
    }
    out << "},\"indices\":" << buffer.add(indices, 5125, "SCALAR", 1) << ",\"material\":0}]}";
    return out.str();
}

std::string nodes_json(const std::vector<Joint>& joints, const PersonOptions& options) {
    std::ostringstream out;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Joint& joint = joints[i];
        Vector3d at = joint.at;
        if (joint.parent >= 0) at -= joints[static_cast<std::size_t>(joint.parent)].at;
        at *= options.units_per_m;
        out << "{\"name\":\"" << joint.name << "\",\"translation\":[" << at.x() << "," << at.y()
            << "," << at.z() << "]";
        std::string children;
        for (std::size_t c = 0; c < joints.size(); ++c) {
            if (joints[c].parent == static_cast<int>(i))
                children += (children.empty() ? "" : ",") + std::to_string(c);
        }
        if (!children.empty()) out << ",\"children\":[" << children << "]";
        out << "},";
    }
    out << "{\"name\":\"body\",\"mesh\":0" << (options.has_skin ? ",\"skin\":0" : "") << "}";
    return out.str();
}

std::string animation_json(const PersonOptions& options, Buffer& buffer) {
    const float half = std::sqrt(0.5f);
    const int times =
        buffer.add(std::vector<float>{0.0f, 1.0f}, 5126, "SCALAR", 1, ",\"min\":[0],\"max\":[1]");
    const int raise = buffer.floats({0, 0, 0, 1, 0, 0, half, half}, "VEC4", 4);
    const int lie = buffer.floats({half, 0, 0, half, half, 0, 0, half}, "VEC4", 4);
    std::ostringstream out;
    out << ",\"animations\":[{\"name\":\"raise\",\"samplers\":[{\"input\":" << times
        << ",\"output\":" << raise << "},{\"input\":" << times << ",\"output\":" << lie
        << "}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":" << kLeftArm
        << ",\"path\":\"rotation\"}}";
    if (options.is_lying) out << ",{\"sampler\":1,\"target\":{\"node\":0,\"path\":\"rotation\"}}";
    out << "]}]";
    return out.str();
}

std::string material_json(const PersonOptions& options) {
    std::ostringstream out;
    out << "\"materials\":[{\"name\":\"cloth\",\"pbrMetallicRoughness\":{\"baseColorFactor\":["
        << options.colour.x() << "," << options.colour.y() << "," << options.colour.z() << ",1]";
    if (!options.picture.empty()) out << ",\"baseColorTexture\":{\"index\":0}";
    out << "}}]";
    if (!options.picture.empty())
        out << ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"" << options.picture
            << "\"}]";
    return out.str();
}

}  // namespace

void write_gltf(const std::filesystem::path& file, const PersonOptions& options) {
    const std::vector<Joint> joints = joints_of(options);
    Buffer buffer;
    const std::string mesh = mesh_json(body_of(joints), options, buffer);
    std::ostringstream out;
    out << "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,"
        << joints.size() << "]}],\"nodes\":[" << nodes_json(joints, options) << "],\"meshes\":["
        << mesh << "]," << material_json(options);
    if (options.has_skin) {
        std::vector<float> inverses;
        std::string list;
        for (std::size_t i = 0; i < joints.size(); ++i) {
            const Vector3d at = -options.units_per_m * joints[i].at;
            const auto x = static_cast<float>(at.x());
            const auto y = static_cast<float>(at.y());
            const auto z = static_cast<float>(at.z());
            inverses.insert(inverses.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1});
            list += (i == 0 ? "" : ",") + std::to_string(i);
        }
        out << ",\"skins\":[{\"joints\":[" << list
            << "],\"inverseBindMatrices\":" << buffer.floats(inverses, "MAT4", 16) << "}]";
    }
    if (options.has_animation) out << animation_json(options, buffer);
    out << "," << buffer.json() << "}";
    std::ofstream(file) << out.str();
}

namespace {

void write_joint(std::ostream& out,
                 const std::vector<Joint>& joints,
                 std::size_t index,
                 std::vector<std::size_t>& order) {
    const Joint& joint = joints[index];
    order.push_back(index);
    Vector3d offset = Vector3d::Zero();  // as CMU's files: the root's height is in the motion
    if (joint.parent >= 0)
        offset = 100 * (joint.at - joints[static_cast<std::size_t>(joint.parent)].at);
    out << (joint.parent < 0 ? "ROOT " : "JOINT ") << joint.name << "\n{\nOFFSET "
        << offset.transpose() << "\nCHANNELS "
        << (joint.parent < 0 ? "6 Xposition Yposition Zposition " : "3 ")
        << "Zrotation Yrotation Xrotation\n";
    bool has_child = false;
    for (std::size_t c = 0; c < joints.size(); ++c) {
        if (joints[c].parent != static_cast<int>(index)) continue;
        write_joint(out, joints, c, order);
        has_child = true;
    }
    if (!has_child)
        out << "End Site\n{\nOFFSET " << (100 * (joint.end - joint.at)).transpose() << "\n}\n";
    out << "}\n";
}

}  // namespace

void write_bvh(const std::filesystem::path& file, const PersonOptions& options) {
    constexpr int kNumFrames = 31;
    const std::vector<Joint> joints = joints_of(options);
    std::ofstream out(file);
    std::vector<std::size_t> order;
    out << "HIERARCHY\n";
    write_joint(out, joints, 0, order);
    out << "MOTION\nFrames: " << kNumFrames << "\nFrame Time: 0.033333\n";
    for (int frame = 0; frame < kNumFrames; ++frame) {
        for (const std::size_t joint : order) {
            if (joint == 0) out << "0 95 0 ";
            out << (joint == kLeftArm ? 90.0 * frame / (kNumFrames - 1) : 0.0) << " 0 0 ";
        }
        out << "\n";
    }
}

}  // namespace atrium::simulation::made
