#include "tools/calibrate/sweep/watch_boards.hpp"

#include "site_node/source/open_source.hpp"
#include "tools/calibrate/board/detect.hpp"
#include "tools/calibrate/sweep/board_tally.hpp"
#include "tools/calibrate/sweep/resting_board.hpp"
#include "tools/calibrate/sweep/watch.hpp"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <optional>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr double kExplainEvery_s = 10.0;

// Of a mosaic, the mean of each sample's surroundings, in which each colour has the same weight
// everywhere: else the detector would see the pattern of the filters.
GrayPicture gray_of(const image::YuvView& picture) {
    const image::PlaneView& y = picture.y;
    const cv::Mat samples(y.height,
                          y.width,
                          CV_8U,
                          const_cast<std::uint8_t*>(y.data),
                          static_cast<std::size_t>(y.stride_bytes));
    GrayPicture gray{y.width, y.height, {}};
    gray.pixels.resize(static_cast<std::size_t>(y.width) * static_cast<std::size_t>(y.height));
    cv::Mat out(y.height, y.width, CV_8U, gray.pixels.data());
    if (picture.mosaic == image::Mosaic::kNone) {
        samples.copyTo(out);
    } else {
        const cv::Mat weights = (cv::Mat_<float>(3, 1) << 0.25F, 0.5F, 0.25F);
        cv::sepFilter2D(samples, out, CV_8U, weights, weights);
    }
    return gray;
}

// Finds the boards in the pictures of all cameras.
class BoardObserver : public Observer {
public:
    BoardObserver(const std::vector<Board>& boards, const config::Rig& rig)
        : Observer(nominal_cameras(rig)),
          detector_(boards),
          buffers_(cameras().size()),
          grays_(cameras().size()),
          seen_(cameras().size()) {}

    void look(std::size_t c, const image::RawImage& image) override {
        seen_[c].reset();
        if (image.empty()) return;
        grays_[c] = gray_of(image::working_view(image, buffers_[c]));
        try {
            seen_[c] = detector_.detect(grays_[c]);
        } catch (const cv::Exception&) {
            seen_[c].emplace();  // what OpenCV cannot look into shows no board
        }
    }

protected:
    const std::vector<std::optional<Detection>>& seen() const { return seen_; }
    /// The picture that was looked at last.
    const GrayPicture& gray(std::size_t c) const { return grays_[c]; }

    preview::View view_of(std::size_t c, const capture::Metaframe& instant) const {
        preview::View view;
        view.name = cameras()[c].name;
        view.image = instant.frames[c].image;
        if (seen_[c])
            for (const SeenCorner& corner : seen_[c]->corners) view.marks_px.push_back(corner.px);
        return view;
    }

private:
    BoardDetector detector_;
    std::vector<image::YuvImage> buffers_;
    std::vector<GrayPicture> grays_;
    std::vector<std::optional<Detection>> seen_;
};

class ShownBoards final : public BoardObserver {
public:
    ShownBoards(const std::vector<Board>& boards, const config::Rig& rig, const BoardNeeds& needs)
        : BoardObserver(boards, rig), boards_(boards), tally_(boards, cameras(), needs) {}

    void count(const capture::Metaframe& instant) override {
        const double time_s = 1e-9 * static_cast<double>(instant.capture_time.ns);
        tally_.add(static_cast<std::uint32_t>(instant.frame_id), time_s, seen());
        if (!explain_at_s_) explain_at_s_ = time_s + kExplainEvery_s;
        if (time_s < *explain_at_s_) return;
        explain_at_s_ = time_s + kExplainEvery_s;
        for (std::size_t c = 0; c < cameras().size(); ++c)
            if (seen()[c]) tally_.sample(c, gray(c));
        if (std::string wrong = explain_film(tally_.films(), boards_, 0); !wrong.empty())
            warnings_.push_back(std::move(wrong));
    }
    bool is_complete() const override { return tally_.is_complete(); }
    std::string progress(std::size_t most_characters) const override {
        return tally_.progress(most_characters);
    }
    std::vector<std::string> take_warnings() override {
        std::vector<std::string> warnings = tally_.take_warnings();
        warnings.insert(warnings.end(), warnings_.begin(), warnings_.end());
        warnings_.clear();
        return warnings;
    }
    std::vector<preview::View> views(const capture::Metaframe& instant) const override {
        std::vector<preview::View> views;
        for (std::size_t c = 0; c < cameras().size(); ++c) {
            preview::View& view = views.emplace_back(view_of(c, instant));
            const std::string need = tally_.need_of(c);
            view.caption = fmt::format("{}  {}", view.name, need.empty() ? "enough" : need);
            if (!view.image.empty()) view.outlines_px = tally_.cameras()[c].covered.outlines_px();
        }
        return views;
    }

    /// With a sample of each camera that saw no board.
    std::vector<FilmedCamera> films() {
        for (std::size_t c = 0; c < cameras().size(); ++c)
            if (seen()[c] && seen()[c]->corners.empty()) tally_.sample(c, gray(c));
        return tally_.films();
    }

private:
    const std::vector<Board>& boards_;
    BoardTally tally_;
    std::optional<double> explain_at_s_;
    std::vector<std::string> warnings_;
};

class LyingBoards final : public BoardObserver {
public:
    LyingBoards(const std::vector<Board>& boards, const config::Rig& rig)
        : BoardObserver(boards, rig), resting_(cameras()) {}

    void count(const capture::Metaframe& instant) override {
        resting_.add(static_cast<std::uint32_t>(instant.frame_id), seen());
    }
    bool is_complete() const override { return resting_.is_complete(); }
    std::string progress(std::size_t) const override { return resting_.progress(); }
    std::vector<std::string> take_warnings() override { return {}; }
    std::vector<preview::View> views(const capture::Metaframe& instant) const override {
        std::vector<preview::View> views;
        for (std::size_t c = 0; c < cameras().size(); ++c) {
            preview::View& view = views.emplace_back(view_of(c, instant));
            view.caption =
                fmt::format("{}  {}", view.name, view.marks_px.empty() ? "no board" : "a board");
        }
        return views;
    }

    std::vector<FilmedCamera> films() {
        std::vector<FilmedCamera> films = resting_.films();
        for (std::size_t c = 0; c < films.size(); ++c)
            if (seen()[c] && seen()[c]->corners.empty()) films[c].samples.push_back(gray(c));
        return films;
    }

private:
    RestingBoard resting_;
};

template <typename Watched>
Expected<BoardFilm> film_of(capture::FrameSource& source,
                            const SourceOptions& options,
                            const std::vector<Board>& boards,
                            std::size_t least_views,
                            Watched observer,
                            std::stop_token stop) {
    if (auto watched = watch(source, options, observer, std::move(stop)); !watched)
        return tl::unexpected(watched.error());
    std::vector<FilmedCamera> films = observer.films();
    if (const std::string wrong = explain_film(films, boards, least_views); !wrong.empty())
        return make_error(ErrorKind::kInvalidData, wrong);
    BoardFilm film;
    film.rate_hz = source.rig().rate_hz;
    film.points = points_of(std::move(films));
    return film;
}

}  // namespace

Expected<BoardFilm> watch_boards(const SourceOptions& options,
                                 const std::vector<Board>& boards,
                                 const BoardNeeds& needs,
                                 std::stop_token stop) {
    const auto source = site_node::open_uncalibrated_source(options.capture, options.room, stop);
    if (!source) return tl::unexpected(source.error());
    fmt::print(stderr,
               "boards: {} cameras; show each the board near and far, up to the edges of its "
               "picture, and tilted to all sides, and two cameras at once; Ctrl-C ends it and "
               "solves\n",
               (*source)->rig().cameras.size());
    return film_of(**source,
                   options,
                   boards,
                   1,
                   ShownBoards(boards, (*source)->rig(), needs),
                   std::move(stop));
}

Expected<BoardFilm> watch_resting_board(const SourceOptions& options,
                                        const std::vector<Board>& boards,
                                        const config::Rig& rig,
                                        std::stop_token stop) {
    const auto source = site_node::open_uncalibrated_source(options.capture, options.room, stop);
    if (!source) return tl::unexpected(source.error());
    fmt::print(stderr,
               "floor: {} cameras; lay the board where they see it, its face up, and step away\n",
               (*source)->rig().cameras.size());
    auto film = film_of(
        **source, options, boards, 0, LyingBoards(boards, (*source)->rig()), std::move(stop));
    if (!film) return film;
    std::erase_if(film->points, [&](const BoardCamera& camera) {
        return std::ranges::find(rig.cameras, camera.name, &geometry::CalibratedCamera::name) ==
               rig.cameras.end();
    });
    return film;
}

}  // namespace atrium::calibrate
