#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/image/raw_image.hpp"
#include "core/image/sparse_mask.hpp"
#include "site_node/segmentation/areas.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation_worker/alpha_mask.hpp"
#include "site_node/segmentation_worker/bgr_picture.hpp"
#include "site_node/segmentation_worker/shared_pictures.hpp"
#include "site_node/segmentation_worker/worker_socket.hpp"
#include "site_node/segmentation_worker/worker_tally.hpp"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::segmentation_worker {

struct WorkerOptions {
    std::filesystem::path socket;                 // at which a worker listens; empty: none is used
    double deadline_ms = 20.0;                    // from the offer of a picture to its alpha
    std::chrono::milliseconds retry_after{1000};  // without a worker, until the next attempt
};

/// Errors: kConfiguration.
Expected<void> check(const WorkerOptions& options);

/// Asks a worker, a process of somebody else, for the people in the pictures of one camera.
///
/// At most one picture is with the worker: while it works on one, newer ones are not offered, so
/// that it always gets the newest. A worker that is late, gone or wrong costs its pictures only,
/// and the time limit at most: one that hangs costs it once. A worker that breaks the protocol is
/// cut off; the client connects again by itself.
///
/// Not thread-safe; cameras are independent. Creates no threads. Allocates only while memory grows.
class WorkerClient {
public:
    struct Camera {
        std::string name;
        int width = 0;  // [px], even
        int height = 0;
        segmentation::SegmentationAreas areas;
    };

    /// Does not connect yet. `tally` is shared by the cameras of a program. Errors: kUnavailable
    /// without memory.
    static Expected<std::unique_ptr<WorkerClient>> create(
        const WorkerOptions& options,
        const Camera& camera,
        const segmentation::SegmentationOptions& segmentation,
        std::shared_ptr<WorkerTally> tally);

    /// Connects if it is time to. Returns whether a worker takes pictures.
    bool is_ready();
    /// Whether there is a worker, ready or not.
    bool is_connected() const { return socket_.has_value(); }

    /// Returns whether the worker takes the next picture now: then `offer` it. Else counts the
    /// picture, which has no alpha.
    bool wants_picture();

    /// Gives the worker the picture, of which `working` is the complete working view. `model`: the
    /// learned room, in the size and mosaic of the picture.
    void offer(const image::RawImage& raw,
               const image::YuvView& working,
               Timestamp capture_time,
               const segmentation::BackgroundModel& model,
               const GiveWay& give_way);

    /// Waits for the answer to the picture, if it was offered, until its time limit.
    void await();

    /// Does that, and counts the picture. Returns true with the mask of its alpha in `out`; false,
    /// with `out` as it was, if there is none.
    bool take(const GiveWay& give_way, image::SparseMask& out);

    /// Keeps the mask that was used for this picture: the worker gets it with the next one.
    void keep_last(const image::Mask& mask);

    /// After so many offered pictures the worker gets the background anew.
    static constexpr std::uint64_t kBackgroundEvery = 300;

private:
    using Clock = std::chrono::steady_clock;
    enum class News { kNothing, kAlpha, kNone, kInvalid, kGone, kLate };

    WorkerClient(const WorkerOptions& options,
                 const Camera& camera,
                 const segmentation::SegmentationOptions& segmentation,
                 std::shared_ptr<WorkerTally> tally,
                 SharedPictures shared);
    void connect();
    News receive();
    News lose(const Error& reason);
    bool count(News news);
    void show_background(const segmentation::BackgroundModel& model, const GiveWay& give_way);

    WorkerOptions options_;
    std::string name_;
    segmentation::SegmentationOptions segmentation_;
    std::shared_ptr<WorkerTally> tally_;
    SharedPictures shared_;
    image::Mask areas_;  // empty: the whole picture
    std::optional<WorkerSocket> socket_;
    Clock::time_point next_attempt_{};
    std::string last_reason_;  // that was logged
    bool is_ready_ = false;
    std::uint64_t number_ = 0;            // of the last picture that was offered
    std::optional<std::uint64_t> asked_;  // the picture that the worker has
    Clock::time_point asked_at_{};
    bool is_offered_ = false;      // and not taken yet
    std::optional<News> answer_;   // to what was offered
    std::uint64_t num_shown_ = 0;  // pictures with this background, of this connection
    std::uint32_t background_number_ = 0;
    image::Mask last_mask_;
    bool is_last_mask_due_ = false;  // the worker does not have it yet
    BgrPicture bgr_;
    segmentation::CleanScratch clean_;
};

/// Connects the clients at the start of a program, and waits until their workers are ready, at most
/// `patience`. Logs what is missing. Ends at once with a stop.
void connect_at_start(const std::vector<WorkerClient*>& clients,
                      std::chrono::milliseconds patience,
                      const std::stop_token& stop);

}  // namespace atrium::segmentation_worker
