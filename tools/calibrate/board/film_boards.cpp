#include "tools/calibrate/board/film_boards.hpp"

#include "tools/calibrate/board/filmed_camera.hpp"
#include "tools/calibrate/board/picture_reader.hpp"
#include "tools/calibrate/names/name_parts.hpp"
#include "tools/calibrate/names/rig_name.hpp"
#include "tools/calibrate/recording/instants.hpp"
#include "tools/calibrate/recording/matching.hpp"
#include "tools/calibrate/recording/shots.hpp"
#include "tools/calibrate/recording/words.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMostCamerasFilmed = 64;
constexpr std::size_t kSamples = 6;  // pictures of a camera that are kept

// Names of cameras: the parts of their labels that differ, "cam0" of "take/cam0/frames".
std::map<std::string, Shots> named(const std::vector<Shots>& shots) {
    std::vector<std::vector<std::string>> parts;
    for (const Shots& one : shots) parts.push_back(parts_of(one.label));
    const auto are_alike = [&](bool at_end) {
        return std::ranges::all_of(parts, [&](const auto& names) {
            const auto& all = parts.front();
            return names.size() > 1 &&
                   (at_end ? names.back() == all.back() : names.front() == all.front());
        });
    };
    while (parts.size() > 1 && are_alike(true))
        for (auto& names : parts) names.pop_back();
    while (parts.size() > 1 && are_alike(false))
        for (auto& names : parts) names.erase(names.begin());
    std::map<std::string, Shots> cameras;
    for (std::size_t i = 0; i < shots.size(); ++i) {
        std::string joined;
        for (const std::string& part : parts[i]) joined += (joined.empty() ? "" : "_") + part;
        std::string name = rig_name(joined);
        if (name.empty()) name = fmt::format("cam{}", i);
        while (cameras.contains(name)) name += "_";
        cameras[name] = shots[i];
    }
    return cameras;
}

Expected<std::map<std::string, Shots>> find_cameras(const std::filesystem::path& folder,
                                                    const std::vector<std::string>& cameras) {
    auto all = find_shots(folder);
    if (!all) return tl::unexpected(all.error());
    std::erase_if(*all, [](const Shots& shots) { return shots.is_mask || shots.is_background; });
    if (!cameras.empty()) {
        auto matches = match_shots(cameras, *all);
        if (!matches) return tl::unexpected(matches.error());
        if (matches->by_camera.empty())
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format(
                    "{}: has no pictures of the cameras {}", folder.string(), listed(cameras)));
        return std::move(matches->by_camera);
    }
    std::erase_if(*all, [](const Shots& shots) { return shots.is_alone; });
    if (all->empty() || all->size() > kMostCamerasFilmed)
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: has {} videos or folders of pictures; must have 1 to {}, one per "
                        "camera, such as cam1.mp4 or cam1/0001.png",
                        folder.string(),
                        all->size(),
                        kMostCamerasFilmed));
    return named(*all);
}

// A camera while its pictures are read.
struct Filmed {
    std::size_t num_expected = 0;
    std::mutex mutex;  // of `reader` and `is_done`
    std::optional<PictureReader> reader;
    bool is_done = false;
    FilmedCamera film;  // of the results
};

class Filming {
public:
    Filming(const std::vector<Board>& boards, const FilmOptions& options, Executor& executor)
        : boards_(boards), options_(options), executor_(executor), detector_(boards) {}

    Expected<BoardFilm> run(const std::filesystem::path& folder) {
        auto found = find_cameras(folder, options_.cameras);
        if (!found) return tl::unexpected(found.error());
        if (const auto done = open(*found); !done) return tl::unexpected(done.error());
        executor_.parallel_for(executor_.num_workers(), work_);
        if (failure_) return tl::unexpected(*failure_);
        std::vector<FilmedCamera> films;
        for (auto& filmed : cameras_) films.push_back(std::move(filmed->film));
        if (const std::string wrong = explain_film(films, boards_, options_.least_views);
            !wrong.empty())
            return make_error(ErrorKind::kInvalidData, wrong);
        film_.points = points_of(std::move(films));
        return std::move(film_);
    }

private:
    Expected<void> open(std::map<std::string, Shots>& found) {
        count_by_one(found, numbering_of(found));
        std::size_t last = 0, first = SIZE_MAX;
        for (const auto& [name, shots] : found) {
            auto filmed = std::make_unique<Filmed>();
            const auto look = look_at(shots);
            if (!look) return tl::unexpected(look.error());
            if (const std::string doubt = doubt_of_truncation(shots, *look); !doubt.empty())
                film_.checks.push_back(doubt);
            BoardCamera& camera = filmed->film.camera;
            camera.name = name;
            camera.width = look->width;
            camera.height = look->height;
            filmed->num_expected = look->num_frames;
            if (look->rate_hz > 0.0) film_.rate_hz = look->rate_hz;
            if (shots.is_video) {
                first = 0;
                last = std::max(last, std::max<std::size_t>(1, look->num_frames) - 1);
            } else {
                first = std::min(first, shots.pictures.begin()->first);
                last = std::max(last, shots.pictures.rbegin()->first);
            }
            cameras_.push_back(std::move(filmed));
        }
        film_.step = (last - first) / options_.most_instants + 1;
        film_.rate_hz /= static_cast<double>(film_.step);
        for (auto& filmed : cameras_) {
            filmed->reader.emplace(found.at(filmed->film.camera.name), film_.step);
            filmed->num_expected = (filmed->num_expected + film_.step - 1) / film_.step;
            num_all_ += filmed->num_expected;
        }
        return {};
    }

    // One worker: takes the next picture of a camera that nobody else reads.
    void work(std::size_t worker) {
        for (std::size_t turn = worker;; ++turn) {
            std::optional<PictureReader::Picture> picture;
            Filmed* filmed = nullptr;
            std::size_t num_done = 0;
            for (std::size_t k = 0; k < cameras_.size() && !picture; ++k) {
                filmed = cameras_[(turn + k) % cameras_.size()].get();
                const std::lock_guard lock(filmed->mutex);
                if (filmed->is_done || has_failed()) {
                    ++num_done;
                    continue;
                }
                auto read = filmed->reader->next();
                if (!read) fail(read.error());
                if (!read || !*read) {
                    filmed->is_done = true;
                    filmed->reader.reset();
                    continue;
                }
                picture = std::move(**read);
            }
            if (!picture && num_done == cameras_.size()) return;
            if (picture) take(*filmed, *picture);
        }
    }

    void take(Filmed& filmed, PictureReader::Picture& picture) try {
        const GrayPicture& gray = picture.gray;
        const BoardCamera& camera = filmed.film.camera;
        if (gray.width != camera.width || gray.height != camera.height) {
            fail({ErrorKind::kInvalidData,
                  fmt::format("camera '{}': picture {} has {}x{} px, those before {}x{} px: a "
                              "calibration is of one size; record again without changing it, or "
                              "take the others away",
                              camera.name,
                              picture.number,
                              gray.width,
                              gray.height,
                              camera.width,
                              camera.height)});
            return;
        }
        const Detection detection = detector_.detect(gray);
        const std::lock_guard lock(mutex_);
        const std::size_t every = filmed.num_expected / kSamples + 1;
        const bool is_sample =
            camera.num_pictures % every == 0 && filmed.film.samples.size() <= kSamples;
        filmed.film.count(detection);
        filmed.film.keep(static_cast<std::uint32_t>(picture.number / film_.step), detection);
        if (is_sample) filmed.film.samples.push_back(std::move(picture.gray));
        ++num_done_;
        if (options_.progress) options_.progress(num_done_, std::max(num_done_, num_all_));
    } catch (const cv::Exception& error) {
        fail({ErrorKind::kInvalidData,
              fmt::format("camera '{}', picture {}: OpenCV cannot look for boards in it: {}",
                          filmed.film.camera.name,
                          picture.number,
                          error.what())});
    }

    bool has_failed() {
        const std::lock_guard lock(mutex_);
        return failure_.has_value();
    }
    void fail(Error error) {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = std::move(error);
    }

    const std::vector<Board>& boards_;
    const FilmOptions& options_;
    Executor& executor_;
    BoardDetector detector_;
    std::vector<std::unique_ptr<Filmed>> cameras_;
    BoardFilm film_;
    std::mutex mutex_;  // of the results
    std::optional<Error> failure_;
    std::size_t num_done_ = 0, num_all_ = 0;
    struct Worker {
        Filming* filming;
        void operator()(std::size_t task, std::size_t /*worker*/) const { filming->work(task); }
    } work_{this};
};

}  // namespace

Expected<BoardFilm> film_boards(const std::filesystem::path& folder,
                                const std::vector<Board>& boards,
                                const FilmOptions& options,
                                Executor& executor) {
    return Filming(boards, options, executor).run(folder);
}

}  // namespace atrium::calibrate
