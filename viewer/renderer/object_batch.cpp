#include "viewer/renderer/object_batch.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>

namespace atrium::renderer {
namespace {

constexpr unsigned kFirstAttribute = 3;  // after those of the corners
constexpr unsigned kNumAttributes = 5;   // four columns, colour and sectors

}  // namespace

ObjectBatch::ObjectBatch() : buffer_(gl::make_buffer()) {}

void ObjectBatch::add(const ObjectDrawing& object, double radius_px) {
    const ObjectMesh& mesh = *object.scaled.mesh;
    entries_.push_back({&mesh, ObjectMesh::level_of(radius_px), &object});
}

void ObjectBatch::draw(const gl::ShaderProgram& shader, const Textures* textures) {
    if (entries_.empty()) return;
    static_assert(sizeof(Instance) == kNumAttributes * 4 * sizeof(float));
    const auto key = [](const Entry& entry) {
        return std::tie(entry.level, entry.mesh, entry.object->look.texture);
    };
    std::sort(entries_.begin(), entries_.end(), [&](const Entry& a, const Entry& b) {
        return key(a) < key(b);
    });
    instances_.clear();
    for (const Entry& entry : entries_) {
        const ObjectLook& look = entry.object->look;
        const bool is_striped =
            look.model == nullptr && look.shape == ShapeKind::kSphere && look.texture.empty();
        Eigen::Vector4f colour_and_sectors;
        colour_and_sectors << look.colour.cast<float>(), is_striped ? 3.0f : 0.0f;
        instances_.push_back({entry.object->world_from_mesh(), colour_and_sectors});
    }
    gl::upload(buffer_, GL_ARRAY_BUFFER, std::span<const Instance>(instances_), GL_STREAM_DRAW);
    for (std::size_t first = 0; first < entries_.size();) {
        std::size_t end = first + 1;
        while (end < entries_.size() && key(entries_[end]) == key(entries_[first])) ++end;
        if (textures != nullptr) textures->use(entries_[first].object->look.texture, shader, 0);
        draw_alike(first, end - first);
        first = end;
    }
    glBindVertexArray(0);
    entries_.clear();
}

void ObjectBatch::draw_alike(std::size_t first, std::size_t num) const {
    const Entry& entry = entries_[first];
    const ObjectMesh::Level& level = entry.mesh->levels[entry.level];
    glBindVertexArray(entry.mesh->layout.id());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
    for (unsigned i = 0; i < kNumAttributes; ++i) {
        const std::size_t offset = first * sizeof(Instance) + i * 4 * sizeof(float);
        gl::float_attribute(kFirstAttribute + i, 4, sizeof(Instance), offset);
        glVertexAttribDivisor(kFirstAttribute + i, 1);
    }
    glDrawElementsInstanced(GL_TRIANGLES,
                            level.num_indices,
                            GL_UNSIGNED_INT,
                            reinterpret_cast<const void*>(level.first * sizeof(std::uint32_t)),
                            static_cast<GLsizei>(num));
}

}  // namespace atrium::renderer
