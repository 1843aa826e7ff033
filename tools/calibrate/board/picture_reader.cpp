#include "tools/calibrate/board/picture_reader.hpp"

#include "site_node/capture/video_rotation.hpp"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <map>

namespace atrium::calibrate {

struct PictureReader::State {
    Shots shots;
    std::size_t step = 1;
    std::map<std::size_t, std::filesystem::path>::const_iterator next_file;
    cv::VideoCapture video;
    std::uint32_t next_number = 0;

    Expected<std::optional<Picture>> next_of_files() {
        while (next_file != shots.pictures.end() && next_file->first % step != 0) ++next_file;
        if (next_file == shots.pictures.end()) return std::nullopt;
        const auto& [number, file] = *next_file++;
        Picture picture{static_cast<std::uint32_t>(number), load_gray(file.string())};
        if (picture.gray.pixels.empty())
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}: cannot be decoded: the file is damaged, or no "
                                          "picture; copy it again, or take it away",
                                          file.string()));
        return picture;
    }

    Expected<std::optional<Picture>> next_of_video() try {
        if (next_number == 0 && !video.open(shots.path.string(), cv::CAP_FFMPEG))
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}: cannot be decoded; convert it, for example with "
                                          "`ffmpeg -i IN OUT.mp4`",
                                          shots.path.string()));
        for (; video.grab(); ++next_number) {
            if (next_number % step != 0) continue;
            cv::Mat colour, gray;
            if (!video.retrieve(colour) || colour.empty()) continue;
            capture::correct_rotation(video, colour);
            if (colour.channels() == 3)
                cv::cvtColor(colour, gray, cv::COLOR_BGR2GRAY);
            else
                gray = colour.clone();
            Picture picture{next_number++, {gray.cols, gray.rows, {}}};
            picture.gray.pixels.assign(gray.data, gray.data + gray.total());
            return picture;
        }
        return std::nullopt;
    } catch (const cv::Exception&) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: cannot be decoded at picture {}; convert it, for "
                                      "example with `ffmpeg -i IN OUT.mp4`",
                                      shots.path.string(),
                                      next_number));
    }
};

PictureReader::PictureReader(const Shots& shots, std::size_t step)
    : state_(std::make_unique<State>()) {
    state_->shots = shots;
    state_->step = step;
    state_->next_file = state_->shots.pictures.begin();
}

PictureReader::~PictureReader() = default;
PictureReader::PictureReader(PictureReader&&) noexcept = default;
PictureReader& PictureReader::operator=(PictureReader&&) noexcept = default;

Expected<std::optional<PictureReader::Picture>> PictureReader::next() {
    return state_->shots.is_video ? state_->next_of_video() : state_->next_of_files();
}

}  // namespace atrium::calibrate
