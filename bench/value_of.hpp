#pragma once

#include "core/base/expected.hpp"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace atrium::bench {

/// Ends the program with 1 and the error's message on stderr if there is an error.
inline void require(const Expected<void>& result) {
    if (result) return;
    std::fprintf(stderr, "%s\n", result.error().message.c_str());
    std::exit(1);
}

/// Like `require`; returns the value.
template <typename T>
T value_of(Expected<T> result) {
    if (!result) require(tl::unexpected(std::move(result.error())));
    return std::move(*result);
}

}  // namespace atrium::bench
