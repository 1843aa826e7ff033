#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "core/image/raw_image.hpp"
#include "simulation/simulated_loop.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

namespace atrium::simulated_cameras {

/// What all cameras of a rig see, as bytes that their sensors deliver: some pictures of the empty
/// room, then a motion that repeats.
struct ShownPictures {
    config::Rig rig;
    image::PixelFormat format = image::PixelFormat::kBayerRG;
    std::vector<std::vector<std::vector<std::uint8_t>>> empty;   // [camera][shot]
    std::vector<std::vector<std::vector<std::uint8_t>>> motion;  // [camera][instant]

    std::size_t num_instants() const { return motion.front().size(); }
};

/// Renders a simulated room, or takes it from `cache` (empty: nothing is kept). `room.rate_hz` is
/// the rate of the motion. Errors as `simulation::load_or_render_loop`.
Expected<ShownPictures> show_room(const config::Rig& rig,
                                  const simulation::RoomOptions& room,
                                  image::PixelFormat format,
                                  const std::filesystem::path& cache,
                                  const simulation::LoopProgress& progress,
                                  std::stop_token stop);

/// Reads all of a recording (docs/conventions.md), at most `kMaxShownBytes` of pictures. Without
/// background the empty room stays empty, and the motion starts at once.
Expected<ShownPictures> show_recording(const std::filesystem::path& folder,
                                       image::PixelFormat format,
                                       std::stop_token stop);

constexpr std::size_t kMaxShownBytes = std::size_t{6} << 30;

/// Says which picture belongs to a trigger, the same for every camera whoever asks first: the empty
/// room for `empty_time` from the first trigger on, then the motion at `rate_hz`. Thread-safe.
class Programme {
public:
    Programme(std::size_t num_empty,
              std::size_t num_instants,
              double rate_hz,
              std::chrono::microseconds empty_time);

    struct Choice {
        bool is_empty_room = false;
        std::size_t index = 0;  // of the shot or of the instant
    };
    /// `time_us` is the instant of the trigger, in microseconds of any common clock.
    Choice at(std::int64_t time_us);

    /// Everybody leaves the room for `empty_time` from `time_us` on; then the motion starts anew.
    void empty_room(std::int64_t time_us);

private:
    const std::size_t num_empty_;
    const std::size_t num_instants_;
    const double rate_hz_;
    const std::chrono::microseconds empty_time_;
    std::mutex mutex_;
    std::optional<std::int64_t> empty_from_us_;
};

/// Numbers the triggers of all cameras. Thread-safe.
///
/// A free-running camera is triggered at each multiple of its period, so its number is that of the
/// period, whichever camera asks and however late. Software triggers reach the cameras one after
/// another, and nobody tells whose are one: those of different cameras within half a period show
/// the same, and the number is the time at which this camera was triggered, in ms.
class TriggerNumbers {
public:
    explicit TriggerNumbers(std::size_t num_cameras) : last_(num_cameras) {}

    struct Trigger {
        std::uint32_t number = 0;
        std::int64_t time_us = 0;  // of what is shown, the same for all cameras of this trigger
    };
    static Trigger free_running(std::int64_t now_us, std::int64_t period_us);
    Trigger software(std::size_t camera, std::int64_t now_us, std::int64_t period_us);

private:
    std::mutex mutex_;
    std::vector<std::uint32_t> last_;  // number of the last trigger of each camera
    Trigger current_;
};

}  // namespace atrium::simulated_cameras
