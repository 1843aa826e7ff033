#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/board/views.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace atrium::calibrate {

/// Boards that two cameras must agree on.
inline constexpr std::size_t kLeastAgreeing = 4;

/// How one camera stands to another, by the boards that both saw.
struct CameraPair {
    std::size_t a = 0, b = 0;
    geometry::RigidTransform b_from_a;
    std::size_t num_shared = 0;    // boards that both saw at an instant
    std::size_t num_agreeing = 0;  // of at most 40 of these that were tried
    std::size_t num_tried = 0;
    /// Another place of b, turned against `b_from_a`, that `num_rival` of these agree with.
    geometry::RigidTransform rival_b_from_a;
    std::size_t num_rival = 0;

    bool is_usable() const {
        return num_agreeing >= kLeastAgreeing && 2 * num_agreeing >= num_tried;
    }
    bool is_ambiguous() const { return is_usable() && 10 * num_rival >= 7 * num_agreeing; }
};

/// All pairs of cameras that saw a board together. `views` have places. A view may explain itself
/// by two places; the pair takes the relative pose that most instants agree with in either. `only`:
/// pairs of this camera.
std::vector<CameraPair> pairs_of(const Bundle& bundle,
                                 const std::vector<BoardView>& views,
                                 std::optional<std::size_t> only = std::nullopt);

/// Places the cameras along the pairs that most boards agree on, from the camera that has most, and
/// then each board where its views agree best. Boards that one camera alone saw are placed, too.
/// `rival`: index of a pair whose other place is taken instead. Cameras without a usable pair stay
/// unplaced. Returns the indices of the pairs that were used.
std::vector<std::size_t> place_rig(Bundle& bundle,
                                   const std::vector<BoardView>& views,
                                   const std::vector<CameraPair>& pairs,
                                   std::optional<std::size_t> rival = std::nullopt);

/// How many instants later than the others' the pictures of a camera are, at most five, if that
/// makes it agree with another one: where no pair is usable. 0 if nothing does.
int find_lateness(const Bundle& bundle,
                  const std::vector<BoardView>& views,
                  std::size_t camera,
                  const std::vector<std::uint32_t>& instants);

}  // namespace atrium::calibrate
