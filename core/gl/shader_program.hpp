#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Core>

#include <string_view>

namespace atrium::gl {

/// A linked vertex and fragment shader. Made, used and destroyed while its context is current.
class ShaderProgram {
public:
    /// Error kInternal with the driver's text, opened by `name`, if a stage does not compile or
    /// link.
    static Expected<ShaderProgram> create(std::string_view name,
                                          std::string_view vertex_source,
                                          std::string_view fragment_source);

    ShaderProgram() = default;
    ShaderProgram(ShaderProgram&& other) noexcept;
    ShaderProgram& operator=(ShaderProgram&& other) noexcept;
    ~ShaderProgram();

    unsigned id() const { return id_; }
    void use() const;

    /// -1 for a uniform that the driver found unused; setting -1 does nothing.
    int uniform(const char* uniform_name) const;

    // The program must be in use.
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
