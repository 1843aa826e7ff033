#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/board/detect.hpp"
#include "tools/calibrate/recording/shots.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace atrium::calibrate {

/// Reads the pictures of a camera one after the other, without colour.
class PictureReader {
public:
    struct Picture {
        std::uint32_t number = 0;  // of its file, or in the video from 0
        GrayPicture gray;
    };

    /// Reads the pictures whose number is a multiple of `step`.
    PictureReader(const Shots& shots, std::size_t step);
    ~PictureReader();
    PictureReader(PictureReader&&) noexcept;
    PictureReader& operator=(PictureReader&&) noexcept;

    /// The next one; empty at the end. Error kInvalidData names a file that cannot be decoded.
    Expected<std::optional<Picture>> next();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace atrium::calibrate
