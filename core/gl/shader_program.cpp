#include "core/gl/shader_program.hpp"

#include <glad/gl.h>

#include <string>
#include <utility>

namespace atrium::gl {
namespace {

std::string compile_log(GLuint shader) {
    GLint length = 0;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(length > 0 ? length : 1), '\0');
    GLsizei written = 0;
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &written, log.data());
    log.resize(static_cast<std::size_t>(written));
    return log;
}

std::string link_log(GLuint program) {
    GLint length = 0;
    glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(length > 0 ? length : 1), '\0');
    GLsizei written = 0;
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), &written, log.data());
    log.resize(static_cast<std::size_t>(written));
    return log;
}

// Compiles one stage and attaches it; the program then owns it.
Expected<void> attach(GLuint program,
                      GLenum stage,
                      std::string_view name,
                      std::string_view source) {
    const GLuint shader = glCreateShader(stage);
    const char* text = source.data();
    const auto length = static_cast<GLint>(source.size());
    glShaderSource(shader, 1, &text, &length);
    glCompileShader(shader);
    GLint ok = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok != GL_TRUE) {
        const std::string log = compile_log(shader);
        glDeleteShader(shader);
        return make_error(ErrorKind::kInternal,
                          "shader " + std::string(name) +
                              (stage == GL_VERTEX_SHADER ? " (vertex): " : " (fragment): ") + log);
    }
    glAttachShader(program, shader);
    glDeleteShader(shader);
    return {};
}

}  // namespace

Expected<ShaderProgram> ShaderProgram::create(std::string_view name,
                                              std::string_view vertex_source,
                                              std::string_view fragment_source) {
    ShaderProgram program(glCreateProgram());
    if (auto ok = attach(program.id_, GL_VERTEX_SHADER, name, vertex_source); !ok) {
        return tl::unexpected(ok.error());
    }
    if (auto ok = attach(program.id_, GL_FRAGMENT_SHADER, name, fragment_source); !ok) {
        return tl::unexpected(ok.error());
    }
    glLinkProgram(program.id_);
    GLint linked = GL_FALSE;
    glGetProgramiv(program.id_, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        return make_error(ErrorKind::kInternal,
                          "shader " + std::string(name) + " (link): " + link_log(program.id_));
    }
    return program;
}

ShaderProgram::ShaderProgram(ShaderProgram&& other) noexcept : id_(std::exchange(other.id_, 0)) {}

ShaderProgram& ShaderProgram::operator=(ShaderProgram&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
}

ShaderProgram::~ShaderProgram() {
    if (id_ != 0) glDeleteProgram(id_);
}

void ShaderProgram::use() const { glUseProgram(id_); }

int ShaderProgram::uniform(const char* uniform_name) const {
    return glGetUniformLocation(id_, uniform_name);
}

void ShaderProgram::set(const char* uniform_name, int value) const {
    glUniform1i(uniform(uniform_name), value);
}
void ShaderProgram::set(const char* uniform_name, float value) const {
    glUniform1f(uniform(uniform_name), value);
}
void ShaderProgram::set(const char* uniform_name, const Eigen::Vector2f& value) const {
    glUniform2fv(uniform(uniform_name), 1, value.data());
}
void ShaderProgram::set(const char* uniform_name, const Eigen::Vector3f& value) const {
    glUniform3fv(uniform(uniform_name), 1, value.data());
}
void ShaderProgram::set(const char* uniform_name, const Eigen::Vector4f& value) const {
    glUniform4fv(uniform(uniform_name), 1, value.data());
}
void ShaderProgram::set(const char* uniform_name, const Eigen::Matrix3f& value) const {
    glUniformMatrix3fv(uniform(uniform_name), 1, GL_FALSE, value.data());
}
void ShaderProgram::set(const char* uniform_name, const Eigen::Matrix4f& value) const {
    glUniformMatrix4fv(uniform(uniform_name), 1, GL_FALSE, value.data());
}

}  // namespace atrium::gl
