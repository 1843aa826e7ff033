#pragma once

#include "tools/calibrate/board/filmed_camera.hpp"
#include "tools/calibrate/sweep/camera_links.hpp"
#include "tools/calibrate/sweep/covered_fields.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// What each camera must have seen of the boards before nothing more is needed.
struct BoardNeeds {
    std::size_t num_places = 25;
    std::size_t num_tilted = 8;   // places at which the board leans
    std::size_t num_shared = 10;  // places at which another camera saw it, too
    double coverage = 0.4;        // of its picture, by corners

    /// The same shares of another number of places; fewer of them cover less, more not more.
    static BoardNeeds of_places(std::size_t num) {
        constexpr BoardNeeds kUsual;
        const double share = static_cast<double>(num) / static_cast<double>(kUsual.num_places);
        return {num, (num + 2) / 3, (2 * num + 4) / 5, kUsual.coverage * std::min(1.0, share)};
    }
};

/// What a camera has seen of boards at the instants that are kept.
struct BoardCameraTally {
    explicit BoardCameraTally(const NominalCamera& camera) : covered(camera.width, camera.height) {}

    CoveredFields covered;
    std::size_t num_places = 0, num_tilted = 0, num_shared = 0;
    std::vector<SeenCorner> corners;  // in the last picture
};

/// Counts to whom boards were shown, and says what is still missing. An instant is kept if the
/// board is at a new place for a camera that still needs one, or for a pair of cameras that nothing
/// links yet. More of the same is not kept, so that the solution stays fast.
class BoardTally {
public:
    BoardTally(std::vector<Board> boards,
               std::vector<NominalCamera> cameras,
               const BoardNeeds& needs = {});

    /// Takes what was found in the pictures of an instant, by camera; nullopt without a picture.
    /// `instant` and `time_s` grow.
    void add(std::uint32_t instant,
             double time_s,
             const std::vector<std::optional<Detection>>& seen);

    bool is_complete() const;

    const std::vector<BoardCameraTally>& cameras() const { return tallies_; }
    const std::string& name(std::size_t camera) const { return cameras_[camera].name; }

    /// "12 of 25 places, show it lower left"; empty if this camera has enough.
    std::string need_of(std::size_t camera) const;

    /// "boards: 1 of 2 cameras; cam0: 12 of 25 places, show it lower left; enough: cam1". At most
    /// `most_characters` long; 0: all.
    std::string progress(std::size_t most_characters = 0) const;

    /// Cameras without pictures, since the last call; repeated every 20 s at most.
    std::vector<std::string> take_warnings();

    /// Gives a picture of a camera now and then, for what it shows if no board is found.
    void sample(std::size_t camera, GrayPicture picture);

    /// The kept corners, and what all pictures showed, with the newest samples.
    const std::vector<FilmedCamera>& films() const { return films_; }

private:
    bool has_moved(std::size_t camera) const;
    bool has_enough(std::size_t camera) const;
    bool adds(std::size_t camera, bool is_shared) const;
    void keep(std::uint32_t instant, const std::vector<std::optional<Detection>>& seen);

    std::vector<Board> boards_;
    std::vector<NominalCamera> cameras_;
    BoardNeeds needs_;
    std::vector<BoardCameraTally> tallies_;
    std::vector<FilmedCamera> films_;
    std::vector<std::vector<SeenCorner>> placed_;  // per camera: at its last new place
    std::vector<std::optional<double>> last_picture_s_, warned_s_;
    CameraLinks links_;
    std::vector<std::string> warnings_;
};

}  // namespace atrium::calibrate
