#pragma once

#include <tl/expected.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace atrium {

/// Why something from the outside world (file, network, device, display) could not be had.
enum class ErrorKind : std::uint8_t {
    kConfiguration,  // a file, key or option that the user can correct
    kNotFound,       // a file, device or recording that is not there
    kInvalidData,    // bytes that are not what they claim to be
    kUnavailable,    // a port, display or peer that cannot be had now
    kInternal,       // anything else
};

struct Error {
    ErrorKind kind = ErrorKind::kInternal;
    std::string message;  // one line, names the thing and what would be right
};

template <typename T>
using Expected = tl::expected<T, Error>;

inline tl::unexpected<Error> make_error(ErrorKind kind, std::string message) {
    return tl::unexpected<Error>(Error{kind, std::move(message)});
}

}  // namespace atrium
