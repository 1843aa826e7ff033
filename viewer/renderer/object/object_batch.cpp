#include "viewer/renderer/object/object_batch.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>

namespace atrium::renderer {
namespace {

constexpr unsigned kFirstAttribute = 3;  // after those of the vertices

auto key(const auto& entry) {
    return std::tie(entry.level, entry.mesh, entry.object->look.texture);
}

bool is_striped(const ObjectLook& look) {
    return look.model == nullptr && look.shape == ShapeKind::kSphere && look.texture.empty();
}

}  // namespace

ObjectBatch::ObjectBatch() : buffer_(gl::make_buffer()) {}

void ObjectBatch::add(const ObjectDrawing& object, double radius_px) {
    const ObjectMesh& mesh = *object.scaled.mesh;
    entries_.push_back({&mesh, ObjectMesh::level_of(radius_px), &object});
}

// Sorts the entries, so equal ones are adjacent, and fills the instances.
void ObjectBatch::prepare() {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
        return key(a) < key(b);
    });
    instances_.clear();
    for (const Entry& entry : entries_)
        instances_.push_back(
            {entry.object->world_from_mesh(), entry.object->look.colour.cast<float>()});
    gl::upload(buffer_, GL_ARRAY_BUFFER, std::span<const Instance>(instances_), GL_STREAM_DRAW);
}

std::size_t ObjectBatch::end_of_alike(std::size_t first) const {
    std::size_t end = first + 1;
    while (end < entries_.size() && key(entries_[end]) == key(entries_[first])) ++end;
    return end;
}

void ObjectBatch::forget() {
    glBindVertexArray(0);
    entries_.clear();
}

void ObjectBatch::draw(const ObjectShaders& shaders, const Textures& textures) {
    if (entries_.empty()) return;
    prepare();
    for (std::size_t first = 0; first < entries_.size();) {
        const std::size_t end = end_of_alike(first);
        const ObjectLook& look = entries_[first].object->look;
        using renderer::shaders::Surface;
        const Surface surface = textures.bind(look.texture, 0)      ? Surface::kTextured
                                : entries_[first].mesh->has_colours ? Surface::kPainted
                                : is_striped(look)                  ? Surface::kStriped
                                                                    : Surface::kPlain;
        shaders.of(surface).use();
        draw_alike(first, end);
        first = end;
    }
    forget();
}

void ObjectBatch::draw_with_bound() {
    if (entries_.empty()) return;
    prepare();
    for (std::size_t first = 0; first < entries_.size();) {
        const std::size_t end = end_of_alike(first);
        draw_alike(first, end);
        first = end;
    }
    forget();
}

void ObjectBatch::draw_alike(std::size_t first, std::size_t end) const {
    const Entry& entry = entries_[first];
    const ObjectMesh::Level& level = entry.mesh->levels[entry.level];
    glBindVertexArray(entry.mesh->layout.id());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
    // four columns of the matrix, then the colour
    for (unsigned i = 0; i < 5; ++i) {
        const std::size_t offset = first * sizeof(Instance) + i * 4 * sizeof(float);
        gl::float_attribute(kFirstAttribute + i, i < 4 ? 4 : 3, sizeof(Instance), offset);
        glVertexAttribDivisor(kFirstAttribute + i, 1);
    }
    glDrawElementsInstanced(GL_TRIANGLES,
                            level.num_indices,
                            GL_UNSIGNED_INT,
                            reinterpret_cast<const void*>(level.first * sizeof(std::uint32_t)),
                            static_cast<GLsizei>(end - first));
}

}  // namespace atrium::renderer
