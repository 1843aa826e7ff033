#include "simulation/person_painter.hpp"

#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "simulation/model_drawing.hpp"
#include "simulation/person_shaders.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cassert>

namespace atrium::simulation {
namespace {

constexpr int kNumColourSamples = 4;

void set_camera(const gl::ShaderProgram& program, const geometry::CalibratedCamera& camera) {
    const geometry::PinholeCamera& c = camera.intrinsics;
    const auto f = [](double v) { return static_cast<float>(v); };
    program.set("camera_from_site",
                Eigen::Matrix4f(camera.camera_from_site.matrix().cast<float>()));
    program.set("focal_and_centre", Eigen::Vector4f(f(c.fx), f(c.fy), f(c.cx), f(c.cy)));
    program.set("skew", f(c.skew));
    const auto& k = c.distortion;
    program.set("radial_tangential", Eigen::Vector4f(f(k[0]), f(k[1]), f(k[2]), f(k[3])));
    program.set("radial_3", f(k[4]));
    program.set("image_size", Eigen::Vector2f(f(c.width), f(c.height)));
}

void set_look(const gl::ShaderProgram& program, const Look& look) {
    program.set("skin", look.skin);
    program.set("hair", look.hair);
    program.set("shirt", look.shirt);
    program.set("back", look.back);
    program.set("emblem_colour", look.emblem_colour);
    program.set("sleeve_left", look.sleeve_left);
    program.set("sleeve_right", look.sleeve_right);
    program.set("trousers", look.trousers);
    program.set("stripe", look.stripe);
    program.set("shoes", look.shoes);
    program.set("hair_style", static_cast<int>(look.hair_style));
    program.set("emblem", static_cast<int>(look.emblem));
    program.set("beard", look.beard ? 1 : 0);
}

void set_light(const gl::ShaderProgram& program, const Eigen::Vector3d& lamp) {
    program.use();
    program.set("lamp", Eigen::Vector3f(lamp.cast<float>()));
    program.set("ambient", static_cast<float>(kAmbient));
    program.set("diffuse", static_cast<float>(kDiffuse));
}

// Averages (2 radius + 1) pixels along each row, written transposed: two passes blur both
// directions.
void blur_transposed(const std::vector<std::uint8_t>& in,
                     int size,
                     int radius,
                     std::vector<std::uint8_t>& out) {
    const int width = 2 * radius + 1;
    for (int y = 0; y < size; ++y) {
        const std::uint8_t* row = in.data() + static_cast<std::ptrdiff_t>(y) * size;
        int sum = 0;
        for (int x = -radius; x < size; ++x) {
            if (x + radius < size) sum += row[x + radius];
            if (x - radius - 1 >= 0) sum -= row[x - radius - 1];
            if (x >= 0)
                out[static_cast<std::size_t>(x) * static_cast<std::size_t>(size) +
                    static_cast<std::size_t>(y)] = static_cast<std::uint8_t>(sum / width);
        }
    }
}

// A person's surface in GL.
class PersonDrawing {
public:
    explicit PersonDrawing(const Person& person) : look_(person.look()) {
        std::vector<Eigen::Vector3f> rest_positions;
        for (const Eigen::Vector3d& p : person.skin().mesh.vertices)
            rest_positions.push_back(p.cast<float>());
        const std::span<const Eigen::Vector3f> rest(rest_positions);
        glBindVertexArray(array_.id());
        gl::upload(rest_, GL_ARRAY_BUFFER, rest, GL_STATIC_DRAW);
        gl::float_attribute(2, 3, sizeof(Eigen::Vector3f), 0);
        gl::upload(positions_, GL_ARRAY_BUFFER, rest, GL_STREAM_DRAW);
        gl::float_attribute(0, 3, sizeof(Eigen::Vector3f), 0);
        gl::upload(normals_, GL_ARRAY_BUFFER, rest, GL_STREAM_DRAW);
        gl::float_attribute(1, 3, sizeof(Eigen::Vector3f), 0);
        const auto& triangles = person.skin().mesh.triangles;
        gl::upload(indices_, GL_ELEMENT_ARRAY_BUFFER, std::span(triangles), GL_STATIC_DRAW);
        num_indices_ = static_cast<int>(3 * triangles.size());
    }

    void set_pose(const PosedSkin& skin) {
        const std::span<const Eigen::Vector3f> positions(skin.positions);
        const std::span<const Eigen::Vector3f> normals(skin.normals);
        gl::upload(positions_, GL_ARRAY_BUFFER, positions, GL_STREAM_DRAW);
        gl::upload(normals_, GL_ARRAY_BUFFER, normals, GL_STREAM_DRAW);
    }

    // Draws the person with `program`, which must be in use with its camera set.
    void draw(const gl::ShaderProgram& program) const {
        set_look(program, look_);
        glBindVertexArray(array_.id());
        // the skin is closed, its back faces are never visible; rows run downwards, which makes
        // front faces clockwise
        glEnable(GL_CULL_FACE);
        glFrontFace(GL_CW);
        glDrawElements(GL_TRIANGLES, num_indices_, GL_UNSIGNED_INT, nullptr);
        glDisable(GL_CULL_FACE);
    }

private:
    Look look_;
    gl::VertexArray array_ = gl::make_vertex_array();
    gl::Buffer positions_ = gl::make_buffer();
    gl::Buffer normals_ = gl::make_buffer();
    gl::Buffer rest_ = gl::make_buffer();
    gl::Buffer indices_ = gl::make_buffer();
    int num_indices_ = 0;
};

}  // namespace

struct PersonPainter::Impl {
    explicit Impl(gl::OffscreenContext owned_context) : context(std::move(owned_context)) {}

    gl::OffscreenContext context;  // first member: outlives the GL objects below
    gl::ShaderProgram paint, flat;
    std::vector<PersonDrawing> people;
    std::vector<ModelDrawing> models;  // instead of people
    gl::VertexArray table_array;
    gl::Buffer table;
    gl::FramebufferName sampled;  // multisampled
    unsigned sampled_colour = 0;
    unsigned sampled_depth = 0;
    gl::Framebuffer resolved;
    int num_table_corners = 0;
    geometry::CalibratedCamera lamp_camera;
    std::vector<std::uint8_t> rgba, shadow, shadow_scratch;

    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl() {
        if (!context.make_current()) return;
        glDeleteRenderbuffers(1, &sampled_colour);
        glDeleteRenderbuffers(1, &sampled_depth);
    }

    // Another painter may have been used on this thread.
    void use() {
        [[maybe_unused]] const auto current = context.make_current();
        assert(current);
    }

    Expected<void> make_targets(int width, int height) {
        auto target = gl::make_framebuffer(width, height);
        if (!target) return tl::unexpected(target.error());
        resolved = std::move(*target);
        GLuint name = 0;
        glGenFramebuffers(1, &name);
        sampled = gl::FramebufferName(name);
        glBindFramebuffer(GL_FRAMEBUFFER, name);
        const auto attach = [&](unsigned& buffer, GLenum format, GLenum attachment) {
            glGenRenderbuffers(1, &buffer);
            glBindRenderbuffer(GL_RENDERBUFFER, buffer);
            glRenderbufferStorageMultisample(
                GL_RENDERBUFFER, kNumColourSamples, format, width, height);
            glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
        };
        attach(sampled_colour, GL_RGBA8, GL_COLOR_ATTACHMENT0);
        attach(sampled_depth, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
        if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
            return make_error(ErrorKind::kInternal,
                              "OpenGL: cannot make a multisampled framebuffer");
        }
        return {};
    }

    void make_table(const Room& room) {
        table = gl::make_buffer();
        const std::vector<Eigen::Vector3f> corners = table_triangles(room);
        num_table_corners = static_cast<int>(corners.size());
        if (corners.empty()) return;
        table_array = gl::make_vertex_array();
        glBindVertexArray(table_array.id());
        gl::upload(
            table, GL_ARRAY_BUFFER, std::span<const Eigen::Vector3f>(corners), GL_STATIC_DRAW);
        gl::float_attribute(0, 3, sizeof(Eigen::Vector3f), 0);
    }

    // Draws the occluder of the people: depth only, no coverage.
    void draw_table(const geometry::CalibratedCamera& camera) {
        if (num_table_corners == 0) return;
        flat.use();
        set_camera(flat, camera);
        flat.set("value", Eigen::Vector4f(0.0f, 0.0f, 0.0f, 0.0f));
        glBindVertexArray(table_array.id());
        glDrawArrays(GL_TRIANGLES, 0, num_table_corners);
    }

    void draw_people(const gl::ShaderProgram& program, const geometry::CalibratedCamera& camera) {
        program.use();
        set_camera(program, camera);
        for (const PersonDrawing& person : people) person.draw(program);
        for (const ModelDrawing& model : models) model.draw(program);
    }

    void begin(unsigned framebuffer,
               const geometry::PinholeCamera& camera,
               const image::PixelRect& region) {
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        glViewport(0, 0, camera.width, camera.height);
        glScissor(region.x, region.y, region.width, region.height);
        glEnable(GL_SCISSOR_TEST);
        glEnable(GL_DEPTH_TEST);
        glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    }
};

PersonPainter::PersonPainter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PersonPainter::PersonPainter(PersonPainter&&) noexcept = default;
PersonPainter& PersonPainter::operator=(PersonPainter&&) noexcept = default;
PersonPainter::~PersonPainter() = default;

// Prepares everything except the people or models.
Expected<std::unique_ptr<PersonPainter::Impl>> PersonPainter::prepare(const char* fragment_shader,
                                                                      const Room& room,
                                                                      int max_width,
                                                                      int max_height) {
    auto context = gl::OffscreenContext::create(8, 8);
    if (!context) return tl::unexpected(context.error());
    auto impl = std::make_unique<Impl>(std::move(*context));
    auto paint = gl::ShaderProgram::create("person", kPersonVertexShader, fragment_shader);
    if (!paint) return tl::unexpected(paint.error());
    auto flat = gl::ShaderProgram::create("flat", kPersonVertexShader, kFlatFragmentShader);
    if (!flat) return tl::unexpected(flat.error());
    impl->paint = std::move(*paint);
    impl->flat = std::move(*flat);
    impl->lamp_camera = room.shadow_camera;
    const geometry::PinholeCamera& lamp = room.shadow_camera.intrinsics;
    if (auto made =
            impl->make_targets(std::max(max_width, lamp.width), std::max(max_height, lamp.height));
        !made) {
        return tl::unexpected(made.error());
    }
    impl->make_table(room);
    set_light(impl->paint, room.lamp);
    const auto num_shadow_pixels =
        static_cast<std::size_t>(lamp.width) * static_cast<std::size_t>(lamp.height);
    impl->shadow.resize(num_shadow_pixels);
    impl->shadow_scratch.resize(num_shadow_pixels);
    return impl;
}

Expected<PersonPainter> PersonPainter::create(std::span<const Person> people,
                                              const Room& room,
                                              int max_width,
                                              int max_height) {
    auto impl = prepare(kPersonFragmentShader, room, max_width, max_height);
    if (!impl) return tl::unexpected(impl.error());
    for (const Person& person : people) (*impl)->people.emplace_back(person);
    return PersonPainter(std::move(*impl));
}

Expected<PersonPainter> PersonPainter::create(std::span<const Model> models,
                                              const Room& room,
                                              int max_width,
                                              int max_height) {
    auto impl = prepare(kModelFragmentShader, room, max_width, max_height);
    if (!impl) return tl::unexpected(impl.error());
    for (const Model& model : models) (*impl)->models.emplace_back(model.surface());
    return PersonPainter(std::move(*impl));
}

void PersonPainter::set_pose(std::size_t index, const PosedSkin& skin) {
    impl_->use();
    if (impl_->models.empty())
        impl_->people[index].set_pose(skin);
    else
        impl_->models[index].set_pose(skin);
}

std::span<const std::uint8_t> PersonPainter::draw(const geometry::CalibratedCamera& camera,
                                                  const image::PixelRect& region) {
    const std::size_t num_bytes =
        static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height) * 4;
    if (impl_->rgba.size() < num_bytes) impl_->rgba.resize(num_bytes);
    impl_->use();
    impl_->begin(impl_->sampled.id(), camera.intrinsics, region);
    impl_->draw_table(camera);
    impl_->draw_people(impl_->paint, camera);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->sampled.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, impl_->resolved.name.id());
    const int right = region.x + region.width;
    const int bottom = region.y + region.height;
    glBlitFramebuffer(region.x,
                      region.y,
                      right,
                      bottom,
                      region.x,
                      region.y,
                      right,
                      bottom,
                      GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, impl_->resolved.name.id());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(region.x,
                 region.y,
                 region.width,
                 region.height,
                 GL_RGBA,
                 GL_UNSIGNED_BYTE,
                 impl_->rgba.data());
    return std::span<const std::uint8_t>(impl_->rgba).first(num_bytes);
}

std::span<const std::uint8_t> PersonPainter::draw_shadow() {
    const geometry::PinholeCamera& lamp = impl_->lamp_camera.intrinsics;
    assert(lamp.width == lamp.height);
    impl_->use();
    impl_->begin(impl_->resolved.name.id(), lamp, {0, 0, lamp.width, lamp.height});
    impl_->draw_table(impl_->lamp_camera);
    impl_->flat.use();
    impl_->flat.set("value", Eigen::Vector4f(1.0f, 1.0f, 1.0f, 1.0f));
    impl_->draw_people(impl_->flat, impl_->lamp_camera);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, lamp.width, lamp.height, GL_RED, GL_UNSIGNED_BYTE, impl_->shadow.data());
    constexpr int kPenumbraPx = 3;
    for (int pass = 0; pass < 2; ++pass) {
        blur_transposed(impl_->shadow, lamp.width, kPenumbraPx, impl_->shadow_scratch);
        blur_transposed(impl_->shadow_scratch, lamp.width, kPenumbraPx, impl_->shadow);
    }
    return impl_->shadow;
}

}  // namespace atrium::simulation
