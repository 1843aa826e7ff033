#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Core>

#include <string_view>

namespace atrium::gl {

/// A linked vertex and fragment shader. Create, use and destroy it while its context is current.
class ShaderProgram {
public:
    /// Compiles and links both stages. Fails with kInternal and the driver's log; `name` identifies
    /// the program in the message.
    static Expected<ShaderProgram> create(std::string_view name,
                                          std::string_view vertex_source,
                                          std::string_view fragment_source);

    ShaderProgram() = default;
    ShaderProgram(ShaderProgram&& other) noexcept;
    ShaderProgram& operator=(ShaderProgram&& other) noexcept;
    ~ShaderProgram();

    unsigned id() const { return id_; }
    void use() const;

    /// Returns the location of a uniform; -1 if it is unused. Setting an unused one does nothing.
    int uniform(const char* uniform_name) const;

    // Set a uniform. The program must be in use.
    void set(const char* uniform_name, int value) const;
    void set(const char* uniform_name, float value) const;
    void set(const char* uniform_name, const Eigen::Vector2f& value) const;
    void set(const char* uniform_name, const Eigen::Vector3f& value) const;
    void set(const char* uniform_name, const Eigen::Vector4f& value) const;
    void set(const char* uniform_name, const Eigen::Matrix3f& value) const;
    void set(const char* uniform_name, const Eigen::Matrix4f& value) const;

private:
    explicit ShaderProgram(unsigned id) : id_(id) {}

    unsigned id_ = 0;
};

}  // namespace atrium::gl
