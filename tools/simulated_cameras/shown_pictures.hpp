#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "core/image/raw_image.hpp"
#include "simulation/changing_light.hpp"
#include "simulation/rendered_room.hpp"
#include "simulation/room_config.hpp"
#include "simulation/simulated_loop.hpp"
#include "simulation/wrong_cameras.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

namespace atrium::simulated_cameras {

/// Pictures of all cameras of a rig as sensor bytes: some of the empty room, then a repeating
/// motion. With a `rendered` room there are none: its pictures are rendered when they are due.
/// `wrong` says which of the rendered cameras each camera of the rig shows.
struct ShownPictures {
    config::Rig rig;
    image::PixelFormat format = image::PixelFormat::kBayerRG;
    std::vector<std::vector<std::vector<std::uint8_t>>> empty;   // [rendered][shot]
    std::vector<std::vector<std::vector<std::uint8_t>>> motion;  // [rendered][instant]

    std::shared_ptr<const simulation::RenderedRoom> rendered;  // null: a person or a recording
    simulation::WrongCameras wrong{};
    simulation::ChangingLight light{};  // of a person's room

    std::size_t num_instants() const {
        return rendered == nullptr ? motion.front().size() : kRenderedInstants;
    }
    static constexpr std::size_t kRenderedInstants = 1'000'000;  // then it starts again
};

/// Renders a simulated room, or loads it from its cache, at the rate of `rig`. A room for
/// calibration is rendered later. Errors as in `simulation::load_or_render_loop`, and of
/// `WrongCameras`.
Expected<ShownPictures> show_room(const config::Rig& rig,
                                  const simulation::RoomConfig& config,
                                  image::PixelFormat format,
                                  const simulation::LoopProgress& progress,
                                  std::stop_token stop);

/// Reads a whole recording (docs/conventions.md), with at most `kMaxShownBytes` of pictures.
/// Without background pictures there is no empty room, and the motion starts at once.
Expected<ShownPictures> show_recording(const std::filesystem::path& folder,
                                       image::PixelFormat format,
                                       std::stop_token stop);

constexpr std::size_t kMaxShownBytes = std::size_t{6} << 30;

/// Chooses the picture of each trigger, the same for every camera: the empty room for `empty_time`
/// from the first trigger on, then the motion at `rate_hz`. Thread-safe.
class ShowSchedule {
public:
    ShowSchedule(std::size_t num_empty,
                 std::size_t num_instants,
                 double rate_hz,
                 std::chrono::microseconds empty_time);

    struct Choice {
        bool is_empty_room = false;
        std::size_t index = 0;  // of the shot or of the instant
        double time_s = 0.0;    // since the first trigger
    };
    /// `time_us` is the time of the trigger, in microseconds of a common clock.
    Choice at(std::int64_t time_us);

    /// Shows the empty room for `empty_time` from `time_us` on; then the motion restarts.
    void empty_room(std::int64_t time_us);

private:
    const std::size_t num_empty_;
    const std::size_t num_instants_;
    const double rate_hz_;
    const std::chrono::microseconds empty_time_;
    std::mutex mutex_;
    std::optional<std::int64_t> begin_us_, empty_from_us_;
};

/// What one camera shows: in `memory` if it had to be rendered now.
std::span<const std::uint8_t> picture_of(const ShownPictures& shown,
                                         std::size_t camera,
                                         const ShowSchedule::Choice& choice,
                                         std::vector<std::uint8_t>& memory);

/// Numbers the triggers of all cameras. Thread-safe.
///
/// Free-running cameras are triggered at multiples of their period; the trigger number is that of
/// the period, whichever camera asks and however late. Software triggers reach the cameras one
/// after the other, without a common number: triggers of different cameras within half a period
/// show the same instant. Their number is the trigger time of the camera in ms.
class TriggerNumbers {
public:
    explicit TriggerNumbers(std::size_t num_cameras) : last_(num_cameras) {}

    struct Trigger {
        std::uint32_t number = 0;
        std::int64_t time_us = 0;  // of the shown instant, equal for all cameras of this trigger
    };
    static Trigger free_running(std::int64_t now_us, std::int64_t period_us);
    Trigger software(std::size_t camera, std::int64_t now_us, std::int64_t period_us);

private:
    std::mutex mutex_;
    std::vector<std::uint32_t> last_;  // number of the last trigger of each camera
    Trigger current_;
};

}  // namespace atrium::simulated_cameras
