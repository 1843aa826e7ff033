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

/// All pictures are kYuv420; `view_of` gives access.
using Picture = image::RawImage;
image::YuvView view_of(const Picture& picture);

/// All pictures of one loop of a simulated room. Played repeatedly, it looks live.
struct SimulatedLoop {
    std::vector<std::vector<Picture>> empty_room;  // [camera][shot], differing only in noise
    /// [instant][camera]; instant i shows `options.frame_time_s(i)`.
    std::vector<std::vector<Picture>> frames;
    /// The file that holds all pictures; null: they are in memory.
    std::shared_ptr<const MappedFile> file;
};

/// If a process waits to change the loop's file, copies the pictures into memory and releases the
/// file. Returns true if it did. Call it at least every few seconds while the loop is in use; it
/// costs one system call.
bool copy_to_memory_if_wanted(SimulatedLoop& loop);

/// Called with the number of pictures done and the total; with zeros once if another process
/// renders the same loop, for which `load_or_render_loop` waits.
using LoopProgress = std::function<void(std::size_t num_done, std::size_t num_pictures)>;

/// Renders every picture, which takes some milliseconds each. Error kUnavailable once `stop` is
/// requested.
Expected<SimulatedLoop> render_loop(const std::vector<geometry::CalibratedCamera>& cameras,
                                    const RoomOptions& options,
                                    const LoopProgress& progress = {},
                                    std::stop_token stop = {});

struct CachedLoop {
    SimulatedLoop loop;
    bool from_cache = false;
    std::filesystem::path written;       // the cache's file, if this call wrote it
    std::optional<Error> cache_problem;  // why the loop could not be cached; the loop is valid
};

/// Like `render_loop`, but caches the pictures in a file of `cache_directory`, which it creates if
/// needed. Cameras, options and format version identify the file; a truncated, damaged or foreign
/// file is rendered again. Files are written atomically. At most `kMaxCachedLoops` are kept; the
/// oldest is removed first.
Expected<CachedLoop> load_or_render_loop(const std::vector<geometry::CalibratedCamera>& cameras,
                                         const RoomOptions& options,
                                         const std::filesystem::path& cache_directory,
                                         const LoopProgress& progress = {},
                                         std::stop_token stop = {});

constexpr std::size_t kMaxCachedLoops = 6;

/// Returns the file in which `load_or_render_loop` keeps the loop.
std::filesystem::path cache_file(std::span<const geometry::CalibratedCamera> cameras,
                                 const RoomOptions& options,
                                 const std::filesystem::path& cache_directory);

}  // namespace atrium::simulation
