#include "tests/unit/simulation/made_person.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>

// Writes made people as ASCII FBX 7.4.
namespace atrium::simulation::made {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr long long kTicksPerSecond = 46186158000;
constexpr int kGeometry = 1000;
constexpr int kBody = 2000;
constexpr int kBones = 2001;
constexpr int kAttributes = 2501;
constexpr int kSkin = 3000;
constexpr int kClusters = 3001;
constexpr int kMaterial = 4000;
constexpr int kPicture = 4001;
constexpr int kOpacity = 4002;
constexpr int kStack = 5000;
constexpr int kLayer = 5001;
constexpr int kCurveNodes = 5100;

template <typename Values>
std::string list(const std::string& key, const Values& values) {
    return fmt::format("{}: *{} {{\na: {}\n}}\n", key, values.size(), fmt::join(values, ","));
}

class FbxWriter {
public:
    FbxWriter(const std::filesystem::path& file, const PersonOptions& options)
        : out_(file), options_(options), joints_(joints_of(options)), body_(body_of(joints_)) {
        for (const Joint& joint : joints_) {
            const Vector3d x = turned(joint.end - joint.at).normalized();
            const Vector3d forwards = turned({0, 0, 1});
            const Vector3d helper = std::abs(x.dot(forwards)) < 0.9 ? forwards : turned({0, 1, 0});
            Matrix3d file_from_bone;
            file_from_bone.col(0) = x;
            file_from_bone.col(1) = helper.cross(x).normalized();
            file_from_bone.col(2) = x.cross(file_from_bone.col(1));
            file_from_bone_.push_back(file_from_bone);
        }
    }

    void write() {
        settings();
        out_ << "Objects:  {\n";
        geometry();
        models();
        if (options_.has_skin) skin();
        material();
        if (options_.has_animation) animation();
        out_ << "}\nConnections:  {\n" << connections_ << "}\n";
    }

private:
    Vector3d turned(const Vector3d& p) const {
        return options_.is_z_up ? Vector3d(p.x(), -p.z(), p.y()) : p;
    }
    Vector3d in_file(const Vector3d& p) const { return options_.units_per_m * turned(p); }

    void connect(int child, int parent, const std::string& property = "") {
        connections_ += property.empty()
                            ? fmt::format("C: \"OO\",{},{}\n", child, parent)
                            : fmt::format("C: \"OP\",{},{}, \"{}\"\n", child, parent, property);
    }

    // Of the node that carries the mesh: 3ds Max leaves the axes and units of its scene there.
    Eigen::Affine3d mesh_from_file() const {
        Eigen::Affine3d file_from_mesh = Eigen::Affine3d::Identity();
        if (options_.is_mesh_turned) {
            file_from_mesh =
                Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vector3d::UnitX()) * Eigen::Scaling(2.5);
        }
        return file_from_mesh.inverse();
    }

    void settings() {
        const int up = options_.is_z_up ? 2 : 1;
        out_ << "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: "
                "1003\nFBXVersion: 7400\n}\nGlobalSettings:  {\nVersion: 1000\nProperties70:  {\n";
        const auto integer = [&](const char* name, int value) {
            out_ << fmt::format("P: \"{}\", \"int\", \"Integer\", \"\",{}\n", name, value);
        };
        integer("UpAxis", up);
        integer("UpAxisSign", 1);
        integer("FrontAxis", 3 - up);
        integer("FrontAxisSign", options_.is_z_up ? -1 : 1);
        integer("CoordAxis", 0);
        integer("CoordAxisSign", 1);
        out_ << fmt::format("P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{}\n}}\n}}\n",
                            options_.fbx_unit_scale);
    }

    void geometry() {
        std::vector<double> positions, normals, places;
        std::vector<int> indices;
        for (std::size_t v = 0; v < body_.positions.size(); ++v) {
            const Vector3d p = mesh_from_file() * in_file(body_.positions[v]);
            const Vector3d n = (mesh_from_file().linear() * turned(body_.normals[v])).normalized();
            positions.insert(positions.end(), p.begin(), p.end());
            normals.insert(normals.end(), n.begin(), n.end());
            places.push_back(body_.texture_places[v].x());
            places.push_back(1 - body_.texture_places[v].y());
        }
        for (const auto& t : body_.triangles)
            indices.insert(indices.end(), {t[0], t[1], -t[2] - 1});
        out_ << fmt::format("Geometry: {}, \"Geometry::body\", \"Mesh\" {{\n", kGeometry)
             << list("Vertices", positions) << list("PolygonVertexIndex", indices)
             << "LayerElementNormal: 0 {\nMappingInformationType: "
                "\"ByVertice\"\nReferenceInformationType: \"Direct\"\n"
             << list("Normals", normals)
             << "}\nLayerElementUV: 0 {\nName: \"\"\nMappingInformationType: "
                "\"ByVertice\"\nReferenceInformationType: \"Direct\"\n"
             << list("UV", places)
             << "}\nLayerElementMaterial: 0 {\nMappingInformationType: "
                "\"AllSame\"\nReferenceInformationType: \"IndexToDirect\"\n"
             << list("Materials", std::vector<int>{0}) << "}\nLayer: 0 {\n";
        for (const char* type : {"Normal", "UV", "Material"})
            out_ << "LayerElement:  {\nType: \"LayerElement" << type << "\"\nTypedIndex: 0\n}\n";
        out_ << "}\n}\n";
        connect(kGeometry, kBody);
    }

    void model(int id,
               const std::string& name,
               const char* kind,
               const Vector3d& at,
               const Vector3d& turn,
               double scale = 1.0) {
        out_ << fmt::format(
                    "Model: {}, \"Model::{}\", \"{}\" {{\nProperties70:  {{\n", id, name, kind)
             << fmt::format("P: \"RotationActive\", \"bool\", \"\", \"\",1\n")
             << fmt::format("P: \"PreRotation\", \"Vector3D\", \"Vector\", \"\",{},{},{}\n",
                            turn.x(),
                            turn.y(),
                            turn.z())
             << fmt::format("P: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",{},{},{}\n",
                            scale,
                            scale,
                            scale)
             << fmt::format(
                    "P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",{},{},{}\n}}\n}}\n",
                    at.x(),
                    at.y(),
                    at.z());
    }

    void models() {
        const bool is_turned = options_.is_mesh_turned;
        model(kBody,
              "body",
              "Mesh",
              Vector3d::Zero(),
              {is_turned ? -90.0 : 0.0, 0.0, 0.0},
              is_turned ? 2.5 : 1.0);
        connect(kBody, 0);
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            const int id = kBones + static_cast<int>(i);
            Matrix3d parent = Matrix3d::Identity();
            Vector3d at = in_file(joints_[i].at);
            if (joints_[i].parent >= 0) {
                const auto up = static_cast<std::size_t>(joints_[i].parent);
                parent = file_from_bone_[up];
                at -= in_file(joints_[up].at);
            }
            const Matrix3d local = parent.transpose() * file_from_bone_[i];
            const Vector3d zyx = local.eulerAngles(2, 1, 0) * 180 / std::numbers::pi;
            model(id, joints_[i].name, "LimbNode", parent.transpose() * at, zyx.reverse());
            connect(id, joints_[i].parent < 0 ? 0 : kBones + joints_[i].parent);
            const int attribute = kAttributes + static_cast<int>(i);
            out_ << fmt::format(
                "NodeAttribute: {}, \"NodeAttribute::{}\", \"LimbNode\" {{\nTypeFlags: "
                "\"Skeleton\"\n}}\n",
                attribute,
                joints_[i].name);
            connect(attribute, id);
        }
    }

    void skin() {
        out_ << fmt::format("Deformer: {}, \"Deformer::\", \"Skin\" {{\nVersion: 101\n}}\n", kSkin);
        connect(kSkin, kGeometry);
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            std::vector<std::size_t> indices;
            for (std::size_t v = 0; v < body_.joint.size(); ++v) {
                if (body_.joint[v] == i) indices.push_back(v);
            }
            Eigen::Matrix4d link = Eigen::Matrix4d::Identity();
            link.topLeftCorner<3, 3>() = file_from_bone_[i];
            link.topRightCorner<3, 1>() = in_file(joints_[i].at);
            const Eigen::Matrix4d inverse = link.inverse() * mesh_from_file().inverse().matrix();
            const auto numbers = [](const Eigen::Matrix4d& m) {
                return std::vector<double>(m.data(), m.data() + 16);  // by columns
            };
            const int id = kClusters + static_cast<int>(i);
            out_ << fmt::format("Deformer: {}, \"SubDeformer::\", \"Cluster\" {{\nVersion: 100\n",
                                id)
                 << list("Indexes", indices)
                 << list("Weights", std::vector<double>(indices.size(), 1.0))
                 << list("Transform", numbers(inverse)) << list("TransformLink", numbers(link))
                 << "}\n";
            connect(id, kSkin);
            connect(kBones + static_cast<int>(i), id);
        }
    }

    void texture(int id, const std::string& path, const char* property) {
        if (path.empty()) return;
        out_ << fmt::format(
            "Texture: {}, \"Texture::map\", \"\" {{\nType: \"TextureVideoClip\"\nVersion: 202\n"
            "FileName: \"{}\"\nRelativeFilename: \"{}\"\n}}\n",
            id,
            path,
            path);
        connect(id, kMaterial, property);
    }

    void material() {
        out_ << fmt::format(
            "Material: {}, \"Material::cloth\", \"\" {{\nVersion: 102\nShadingModel: "
            "\"phong\"\nProperties70:  {{\nP: \"DiffuseColor\", \"Color\", \"\", "
            "\"A\",{},{},{}\n}}\n}}\n",
            kMaterial,
            options_.colour.x(),
            options_.colour.y(),
            options_.colour.z());
        connect(kMaterial, kBody);
        texture(kPicture, options_.picture, "DiffuseColor");
        texture(kOpacity, options_.opacity_picture, "TransparentColor");
    }

    // Rotates a bone by that many degrees about the file's direction that `axis` becomes.
    void curve(int id, std::size_t joint, const Vector3d& axis, double from_deg, double to_deg) {
        const Vector3d own = file_from_bone_[joint].transpose() * turned(axis);
        int largest = 0;
        own.cwiseAbs().maxCoeff(&largest);
        const double sign = own[largest] < 0 ? -1 : 1;
        out_ << fmt::format(
            "AnimationCurveNode: {}, \"AnimCurveNode::R\", \"\" {{\nProperties70:  {{\nP: "
            "\"d|X\", \"Number\", \"\", \"A\",0\nP: \"d|Y\", \"Number\", \"\", \"A\",0\nP: "
            "\"d|Z\", \"Number\", \"\", \"A\",0\n}}\n}}\n",
            id);
        connect(id, kLayer);
        connect(id, kBones + static_cast<int>(joint), "Lcl Rotation");
        for (int k = 0; k < 3; ++k) {
            const double from = k == largest ? sign * from_deg : 0.0;
            const double to = k == largest ? sign * to_deg : 0.0;
            out_ << fmt::format(
                        "AnimationCurve: {}, \"AnimCurve::\", \"\" {{\nDefault: 0\nKeyVer: 4008\n",
                        id + 1 + k)
                 << list("KeyTime", std::vector<long long>{0, kTicksPerSecond / 2, kTicksPerSecond})
                 << list("KeyValueFloat", std::vector<double>{from, 0.5 * (from + to), to})
                 << "}\n";
            connect(id + 1 + k, id, fmt::format("d|{}", "XYZ"[k]));
        }
    }

    void animation() {
        out_ << fmt::format(
            "AnimationStack: {}, \"AnimStack::Take 001\", \"\" {{\nProperties70:  {{\nP: "
            "\"LocalStop\", \"KTime\", \"Time\", \"\",{}\n}}\n}}\nAnimationLayer: {}, "
            "\"AnimLayer::Base\", \"\" {{\n}}\n",
            kStack,
            kTicksPerSecond,
            kLayer);
        connect(kLayer, kStack);
        curve(kCurveNodes, kLeftArm, {0, 0, 1}, 0, 90);
        if (options_.is_lying) curve(kCurveNodes + 10, 0, {1, 0, 0}, -90, -90);
    }

    std::ofstream out_;
    const PersonOptions& options_;
    std::vector<Joint> joints_;
    Body body_;
    std::vector<Matrix3d> file_from_bone_;
    std::string connections_;
};

}  // namespace

void write_fbx(const std::filesystem::path& file, const PersonOptions& options) {
    FbxWriter(file, options).write();
}

}  // namespace atrium::simulation::made
