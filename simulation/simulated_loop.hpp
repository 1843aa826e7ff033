#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/raw_image.hpp"
#include "simulation/person.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

namespace atrium::simulation {

class MappedFile;

/// All pictures are kYuv420: `view_of` shows them.
using Picture = image::RawImage;
image::YuvView view_of(const Picture& picture);

/// All pictures of one loop of a simulated room; played again and again it is a live room.
struct SimulatedLoop {
    std::vector<std::vector<Picture>> empty_room;  // [camera][shot], differing in noise alone
    std::vector<std::vector<Picture>>
        frames;  // [instant][camera]; instant i shows `options.frame_time_s(i)`
    /// The file in which all the pictures are; null: they are in memory.
    std::shared_ptr<const MappedFile> file;
};

/// Copies the pictures of a loop whose file somebody wants to change into memory, and lets the file
/// go; true if it did. To be called at least every few seconds while a loop is kept, which costs a
/// system call.
bool keep_in_memory_if_wanted(SimulatedLoop& loop);

/// Called with the number of pictures done and of all.
using LoopProgress = std::function<void(std::size_t num_done, std::size_t num_pictures)>;

/// Renders every picture. Takes some milliseconds each; error kUnavailable once `stop` is
/// requested.
Expected<SimulatedLoop> render_loop(const std::vector<geometry::CalibratedCamera>& cameras,
                                    const RoomOptions& options,
                                    const LoopProgress& progress = {},
                                    std::stop_token stop = {});

struct CachedLoop {
    SimulatedLoop loop;
    bool from_cache = false;
    std::optional<Error>
        cache_problem;  // why the rendered loop could not be kept; the loop itself is good
};

/// As `render_loop`, but keeps the pictures in a file of `cache_directory` (made if absent) and
/// takes them from there the next time. The file is found by cameras, options and format version;
/// one that is cut short, damaged or not ours is rendered anew. A file appears whole or not at all,
/// and no more than `kMaxCachedLoops` are kept, the oldest going first.
Expected<CachedLoop> load_or_render_loop(const std::vector<geometry::CalibratedCamera>& cameras,
                                         const RoomOptions& options,
                                         const std::filesystem::path& cache_directory,
                                         const LoopProgress& progress = {},
                                         std::stop_token stop = {});

constexpr std::size_t kMaxCachedLoops = 6;

/// Where `load_or_render_loop` keeps the loop.
std::filesystem::path cache_file(std::span<const geometry::CalibratedCamera> cameras,
                                 const RoomOptions& options,
                                 const std::filesystem::path& cache_directory);

}  // namespace atrium::simulation
