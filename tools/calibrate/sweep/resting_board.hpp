#pragma once

#include "tools/calibrate/board/filmed_camera.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Waits for a board that lies still: the same cameras see it at the same place for some instants
/// in a row.
class RestingBoard {
public:
    explicit RestingBoard(std::vector<NominalCamera> cameras);

    /// Takes what was found in the pictures of an instant, by camera; nullopt without a picture.
    void add(std::uint32_t instant, const std::vector<std::optional<Detection>>& seen);

    bool is_complete() const;

    /// "floor: cam1, cam2 see the board at rest: 12 of 20 instants".
    std::string progress() const;

    /// What the instants showed in which the board rested so far.
    std::vector<FilmedCamera> films() const;

private:
    struct Instant {
        std::uint32_t number = 0;
        std::vector<std::optional<Detection>> seen;
    };
    std::vector<NominalCamera> cameras_;
    std::deque<Instant> resting_;
};

}  // namespace atrium::calibrate
