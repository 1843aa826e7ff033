#pragma once

#include <tl/expected.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace atrium {

/// Classifies failures of the outside world: files, network, devices, display.
enum class ErrorKind : std::uint8_t {
    kConfiguration,  // the user can correct a file, key or option
    kNotFound,       // a file, device or recording is missing
    kInvalidData,    // received or read bytes are malformed
    kUnavailable,    // a port, display, peer or device is not available now
    kInternal,       // anything else
};

struct Error {
    ErrorKind kind = ErrorKind::kInternal;
    std::string message;  // one line: names the object and the remedy
};

template <typename T>
using Expected = tl::expected<T, Error>;

inline tl::unexpected<Error> make_error(ErrorKind kind, std::string message) {
    return tl::unexpected<Error>(Error{kind, std::move(message)});
}

}  // namespace atrium
